// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/adapters/itk_chan_vese.hpp"

#include <itkAtanRegularizedHeavisideStepFunction.h>
#include <itkImage.h>
#include <itkScalarChanAndVeseDenseLevelSetImageFilter.h>

#include <algorithm>

#include "model/mathematics.hpp"

namespace heartgen::adapters {
namespace {

using Image = itk::Image<float, 3>;
using Data = itk::ScalarChanAndVeseLevelSetFunctionData<Image, Image>;
using SharedData = itk::ConstrainedRegionBasedLevelSetFunctionSharedData<Image, Image, Data>;
using Function = itk::ScalarChanAndVeseLevelSetFunction<Image, Image, SharedData>;
using Filter = itk::ScalarChanAndVeseDenseLevelSetImageFilter<Image, Image, Image, Function, SharedData>;
using Heaviside = itk::AtanRegularizedHeavisideStepFunction<float, float>;

Image::Pointer itk_image(const Volume<float>& volume) {
  auto image = Image::New();
  Image::SizeType size;
  for (unsigned axis = 0; axis < 3; ++axis) size[axis] = static_cast<itk::SizeValueType>(volume.grid.size[axis]);
  image->SetRegions(Image::RegionType(size));
  image->Allocate();
  std::copy(volume.voxels.begin(), volume.voxels.end(), image->GetBufferPointer());
  return image;
}

Volume<float> ball(const Grid& grid) {
  Volume<float> result(grid);
  const auto from_middle = [&](std::int64_t i, std::size_t axis) {
    return static_cast<double>(i) - static_cast<double>(grid.size[axis]) / 2;
  };
  const double radius = static_cast<double>(std::min({grid.size[0], grid.size[1], grid.size[2]})) / 3;
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i)
        result(i, j, k) =
            static_cast<float>(math::hypot(from_middle(i, 0), from_middle(j, 1), from_middle(k, 2)) - radius);
  return result;
}

}  // namespace

Volume<float> itk_dense_chan_vese(const Volume<float>& image, int iterations) {
  auto heaviside = Heaviside::New();
  heaviside->SetEpsilon(1);
  auto filter = Filter::New();
  filter->SetFunctionCount(1);
  filter->SetFeatureImage(itk_image(image));
  filter->SetLevelSet(0, itk_image(ball(image.grid)));
  filter->SetNumberOfIterations(static_cast<unsigned>(iterations));
  filter->SetMaximumRMSError(0);
  filter->SetUseImageSpacing(false);
  filter->SetInPlace(false);
  const auto function = filter->GetDifferenceFunction(0);
  function->SetDomainFunction(heaviside);
  function->SetCurvatureWeight(1);
  function->SetAreaWeight(0);
  function->SetReinitializationSmoothingWeight(0);
  function->SetVolumeMatchingWeight(0);
  function->SetVolume(0);
  function->SetLambda1(1);
  function->SetLambda2(1);
  filter->Update();
  Volume<float> result(image.grid);
  const float* found = filter->GetOutput()->GetBufferPointer();
  std::copy(found, found + result.voxels.size(), result.voxels.begin());
  return result;
}

}  // namespace heartgen::adapters
