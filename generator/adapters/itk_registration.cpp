// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/adapters/itk_registration.hpp"

#include <fmt/format.h>
#include <itkDiffeomorphicDemonsRegistrationFilter.h>
#include <itkLinearInterpolateImageFunction.h>
#include <itkMultiThreaderBase.h>
#include <itkResampleImageFilter.h>
#include <itkSmoothingRecursiveGaussianImageFilter.h>

#include <algorithm>
#include <stdexcept>

#include "model/contract.hpp"

namespace heartgen::adapters {
namespace {

using Scalar = itk::Image<float, 3>;
using Displacement = itk::Image<itk::Vector<float, 3>, 3>;

template <class Filter>
void limit_threads(Filter& filter, int threads) {
  if (threads > 0) filter->SetNumberOfWorkUnits(static_cast<itk::ThreadIdType>(threads));
}

Scalar::Pointer itk_image(const Volume<float>& volume) {
  auto image = Scalar::New();
  Scalar::SizeType size;
  Scalar::SpacingType spacing;
  Scalar::PointType origin;
  for (unsigned axis = 0; axis < 3; ++axis) {
    size[axis] = static_cast<itk::SizeValueType>(volume.grid.size[axis]);
    spacing[axis] = volume.grid.spacing_mm[static_cast<int>(axis)];
    origin[axis] = volume.grid.origin_mm[static_cast<int>(axis)];
  }
  image->SetRegions(Scalar::RegionType(size));
  image->SetSpacing(spacing);
  image->SetOrigin(origin);
  image->Allocate();
  std::copy(volume.voxels.begin(), volume.voxels.end(), image->GetBufferPointer());
  return image;
}

/// The image smoothed and resampled on a grid that is `factor` times coarser and covers the same box.
Scalar::Pointer coarsened(const Scalar::Pointer& image, int factor, int threads) {
  if (factor == 1) return image;
  auto smooth = itk::SmoothingRecursiveGaussianImageFilter<Scalar, Scalar>::New();
  smooth->SetInput(image);
  smooth->SetSigma(0.5 * factor * image->GetSpacing()[0]);
  limit_threads(smooth, threads);
  auto size = image->GetLargestPossibleRegion().GetSize();
  auto spacing = image->GetSpacing();
  auto origin = image->GetOrigin();
  for (unsigned axis = 0; axis < 3; ++axis) {
    origin[axis] += 0.5 * (factor - 1) * spacing[axis];
    spacing[axis] *= factor;
    size[axis] = (size[axis] + static_cast<itk::SizeValueType>(factor) - 1) / static_cast<itk::SizeValueType>(factor);
  }
  auto resample = itk::ResampleImageFilter<Scalar, Scalar>::New();
  resample->SetInput(smooth->GetOutput());
  resample->SetSize(size);
  resample->SetOutputSpacing(spacing);
  resample->SetOutputOrigin(origin);
  resample->SetDefaultPixelValue(image->GetPixel({{0, 0, 0}}));
  limit_threads(resample, threads);
  resample->Update();
  Scalar::Pointer result = resample->GetOutput();
  result->DisconnectPipeline();
  return result;
}

Displacement::Pointer refined(const Displacement::Pointer& field, const Scalar::Pointer& reference, int threads) {
  auto resample = itk::ResampleImageFilter<Displacement, Displacement>::New();
  resample->SetInput(field);
  resample->SetReferenceImage(reference);
  resample->UseReferenceImageOn();
  limit_threads(resample, threads);
  resample->Update();
  Displacement::Pointer result = resample->GetOutput();
  result->DisconnectPipeline();
  return result;
}

Displacement::Pointer run_level(const Scalar::Pointer& fixed, const Scalar::Pointer& moving,
                                const Displacement::Pointer& start, int iterations, const DemonsSettings& settings) {
  using Demons = itk::DiffeomorphicDemonsRegistrationFilter<Scalar, Scalar, Displacement>;
  auto demons = Demons::New();
  demons->SetFixedImage(fixed);
  demons->SetMovingImage(moving);
  demons->SetNumberOfIterations(static_cast<itk::IdentifierType>(iterations));
  demons->SetMaximumRMSError(0);
  demons->SetMaximumUpdateStepLength(settings.maximum_step_voxels);
  demons->SetUseGradientType(itk::ESMDemonsRegistrationFunctionEnums::Gradient::Symmetric);
  demons->SetMaximumKernelWidth(100);
  demons->SetSmoothDisplacementField(settings.sigma_mm > 0);
  if (settings.sigma_mm > 0) demons->SetStandardDeviations(settings.sigma_mm / fixed->GetSpacing()[0]);
  demons->SetSmoothUpdateField(false);
  limit_threads(demons, settings.threads);
  if (start) demons->SetInitialDisplacementField(refined(start, fixed, settings.threads));
  demons->Update();
  Displacement::Pointer result = demons->GetOutput();
  result->DisconnectPipeline();
  return result;
}

}  // namespace

Volume<Vec3> diffeomorphic_demons(const Volume<float>& fixed, const Volume<float>& moving,
                                  const DemonsSettings& settings) {
  HEARTGEN_EXPECTS(fixed.grid == moving.grid);
  Volume<Vec3> result(fixed.grid);
  try {
    const auto fixed_image = itk_image(fixed), moving_image = itk_image(moving);
    Displacement::Pointer field;
    const int levels = static_cast<int>(settings.iterations.size());
    for (int level = 0; level < levels; ++level) {
      const int factor = 1 << (levels - 1 - level);
      field =
          run_level(coarsened(fixed_image, factor, settings.threads), coarsened(moving_image, factor, settings.threads),
                    field, settings.iterations[static_cast<std::size_t>(level)], settings);
    }
    if (!field) return result;
    const auto* data = field->GetBufferPointer();
    for (std::size_t v = 0; v < result.voxels.size(); ++v) result.voxels[v] = {data[v][0], data[v][1], data[v][2]};
  } catch (const itk::ExceptionObject& error) {
    throw std::runtime_error(fmt::format("demons registration failed: {}", error.GetDescription()));
  }
  return result;
}

}  // namespace heartgen::adapters
