// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/adapters/dicom_io.hpp"

#include <fmt/format.h>
#include <gdcmTrace.h>
#include <itkGDCMImageIO.h>
#include <itkGDCMSeriesFileNames.h>
#include <itkImageSeriesReader.h>
#include <itkMultiThreaderBase.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <set>
#include <sstream>
#include <vector>

#include "generator/adapters/behind_wall.hpp"
#include "generator/adapters/dicom_files.hpp"
#include "generator/adapters/image_checks.hpp"
#include "generator/adapters/itk_volume.hpp"
#include "model/error.hpp"
#include "model/input_file.hpp"
#include "model/quantile.hpp"

namespace heartgen::adapters {
namespace {

namespace fs = std::filesystem;

/// Where a slice lies: the centre of its first pixel, and its rows' and columns' directions.
struct SlicePlace {
  Vec3 first_mm, along_row, along_column;
  Vec3 pixel_mm;  // z: 0
  std::array<std::string, 5> times{};
};

/// What tells phases apart, the surest first: trigger time, temporal position, acquisition and content time, number.
constexpr std::array time_tags = {"0018|1060", "0020|0100", "0008|0032", "0008|0033", "0020|0013"};

std::vector<double> numbers_in(std::string text) {
  std::replace(text.begin(), text.end(), '\\', ' ');
  std::istringstream stream(text);
  std::vector<double> numbers;
  for (double number = 0; stream >> number;) numbers.push_back(number);
  return numbers;
}

SlicePlace place_of(const std::string& file, const std::string& folder) {
  const auto io = itk::GDCMImageIO::New();
  io->SetFileName(file);
  io->ReadImageInformation();
  std::string position, orientation;
  io->GetValueFromTag("0020|0032", position);
  io->GetValueFromTag("0020|0037", orientation);
  const auto p = numbers_in(position), o = numbers_in(orientation);
  if (p.size() != 3 || o.size() != 6)
    throw UserError("has a slice without ImagePositionPatient or ImageOrientationPatient", folder,
                    "export the series again, as the scanner made it");
  const Vec3 pixels{io->GetSpacing(0), io->GetSpacing(1), 0};
  SlicePlace place{{p[0], p[1], p[2]}, {o[0], o[1], o[2]}, {o[3], o[4], o[5]}, pixels};
  for (std::size_t t = 0; t < time_tags.size(); ++t) io->GetValueFromTag(time_tags[t], place.times[t]);
  return place;
}

/// How far the slices lie along the first one's normal, in rising order, and how far off that line at most.
struct Stack {
  std::vector<double> height_mm;
  double shift_mm = 0;
};

Stack stack_of(const std::vector<SlicePlace>& slices, const std::string& folder) {
  constexpr double same_direction = 1e-3;
  const SlicePlace& start = slices.front();
  const Vec3 normal = normalized(cross(start.along_row, start.along_column));
  Stack stack;
  for (const auto& slice : slices) {
    if (norm(slice.along_row - start.along_row) + norm(slice.along_column - start.along_column) > same_direction)
      throw UserError("has slices of different orientations", folder, "put the wanted ones in a folder of their own");
    if (norm(slice.pixel_mm - start.pixel_mm) > same_direction * norm(start.pixel_mm))
      throw UserError(fmt::format("has slices with pixels of {:g} x {:g} and of {:g} x {:g} mm", start.pixel_mm.x,
                                  start.pixel_mm.y, slice.pixel_mm.x, slice.pixel_mm.y),
                      folder, "put the wanted ones in a folder of their own");
    const Vec3 way = slice.first_mm - start.first_mm;
    stack.height_mm.push_back(dot(way, normal));
    stack.shift_mm = std::max(stack.shift_mm, norm(way - stack.height_mm.back() * normal));
  }
  std::sort(stack.height_mm.begin(), stack.height_mm.end());
  return stack;
}

/// Slices of a series by where they lie, rising; one list for each height.
std::vector<std::vector<std::size_t>> piles_of(const std::vector<SlicePlace>& slices) {
  constexpr double same_mm = 1e-3;
  const Vec3 normal = normalized(cross(slices.front().along_row, slices.front().along_column));
  std::vector<std::pair<double, std::size_t>> heights;
  for (std::size_t s = 0; s < slices.size(); ++s) heights.emplace_back(dot(slices[s].first_mm, normal), s);
  std::sort(heights.begin(), heights.end());
  std::vector<std::vector<std::size_t>> piles;
  for (std::size_t h = 0; h < heights.size(); ++h) {
    if (h == 0 || heights[h].first - heights[h - 1].first >= same_mm) piles.emplace_back();
    piles.back().push_back(heights[h].second);
  }
  return piles;
}

double number_in(const std::string& text) {
  const auto numbers = numbers_in(text);
  return numbers.empty() ? 0 : numbers.front();
}

/// Whether a time tag orders every pile, alike on all heights unless it only counts.
bool orders(const std::vector<SlicePlace>& slices, const std::vector<std::vector<std::size_t>>& piles,
            std::size_t tag) {
  const bool counts = tag + 1 == time_tags.size();
  std::set<double> of_all;
  for (const auto& pile : piles) {
    std::set<double> of_pile;
    for (const auto s : pile)
      if (!slices[s].times[tag].empty()) of_pile.insert(number_in(slices[s].times[tag]));
    if (of_pile.size() != pile.size()) return false;
    of_all.merge(of_pile);
  }
  return counts || of_all.size() == piles.front().size();
}

/// The slices of one phase, rising; all, as they are, where each lies alone. Piles of different heights, and slices
/// that no time tells apart, are left for check_stack.
std::vector<std::size_t> slices_of_phase(const std::vector<SlicePlace>& slices, int phase, const std::string& folder) {
  std::vector<std::size_t> all(slices.size());
  std::iota(all.begin(), all.end(), 0);
  auto piles = piles_of(slices);
  const std::size_t phases = piles.front().size();
  const bool are_even = std::all_of(piles.begin(), piles.end(), [&](const auto& p) { return p.size() == phases; });
  std::size_t tag = 0;
  while (are_even && tag < time_tags.size() && !orders(slices, piles, tag)) ++tag;
  if (!are_even || tag == time_tags.size()) {
    check_phase(phase, 1, folder);
    return all;
  }
  check_phase(phase, static_cast<int>(phases), folder);
  if (phases == 1) return all;
  std::vector<std::size_t> chosen;
  for (auto& pile : piles) {
    std::sort(pile.begin(), pile.end(), [&](std::size_t a, std::size_t b) {
      return number_in(slices[a].times[tag]) < number_in(slices[b].times[tag]);
    });
    chosen.push_back(pile[static_cast<std::size_t>(phase) - 1]);
  }
  return chosen;
}

/// The library trusts the first two slices: what it would stack wrongly is refused.
void check_stack(const Stack& stack, const std::string& folder) {
  constexpr double same_mm = 1e-3, share = 0.1;
  std::vector<double> step;
  for (std::size_t k = 1; k < stack.height_mm.size(); ++k) step.push_back(stack.height_mm[k] - stack.height_mm[k - 1]);
  if (step.empty()) return;
  if (const auto twice = std::count_if(step.begin(), step.end(), [&](double s) { return s < same_mm; }); twice > 0)
    throw UserError(fmt::format("{} of its {} slices lie where another one lies", twice, stack.height_mm.size()),
                    folder, "put one phase, or one reconstruction, in a folder of its own");
  std::vector<double> sorted = step;
  const double usual = upper_median(sorted);
  for (std::size_t k = 0; k < step.size(); ++k)
    if (std::abs(step[k] - usual) > share * usual)
      throw UserError(
          fmt::format("slices are missing or unevenly spaced: {:.2f} mm between slices {} and {}, {:.2f} mm "
                      "elsewhere",
                      step[k], k + 1, k + 2, usual),
          folder, "export the whole series again");
  if (stack.shift_mm > share * usual)
    throw UserError(fmt::format("its slices are shifted against each other by up to {:.1f} mm, as with a tilted gantry",
                                stack.shift_mm),
                    folder, "resample it to a regular grid first; dcm2niix does");
}

/// The library leaves out what it cannot read. What lies in the folder like a slice is one.
void refuse_dropped_slices(const std::vector<DicomFile>& found, const std::vector<std::string>& in_series,
                           const std::string& folder) {
  const auto is_in_series = [&](const DicomFile& file) {
    return std::any_of(in_series.begin(), in_series.end(),
                       [&](const auto& name) { return fs::path(name).filename() == file.path.filename(); });
  };
  std::set<std::string> classes;
  for (const auto& file : found)
    if (is_in_series(file)) classes.insert(file.sop_class);
  for (const auto& file : found)
    if (!is_in_series(file) && (file.rows > 0 || !file.is_dicom || classes.contains(file.sop_class)))
      throw UserError("is no slice that can be read, and the series would lack it", file.path.string(),
                      fmt::format("export it again, or take it out of {}", folder));
}

/// In a process of its own.
Volume<float> read_series(const std::vector<DicomFile>& found, const std::string& folder, int phase) {
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(1);
  gdcm::Trace::DebugOff();
  gdcm::Trace::WarningOff();
  gdcm::Trace::ErrorOff();  // what it would print is looked at below, or thrown
  const auto names = itk::GDCMSeriesFileNames::New();
  names->SetUseSeriesDetails(true);
  names->SetDirectory(folder);
  const auto series = names->GetSeriesUIDs();
  if (series.empty())
    throw UserError("holds no DICOM series", folder, "name a folder with one, or an image: .nii.gz, .nrrd, .mha");
  if (series.size() > 1)
    throw UserError(fmt::format("holds {} DICOM series", series.size()), folder,
                    "put the wanted one in a folder of its own");
  const auto files = names->GetFileNames(series.front());
  refuse_dropped_slices(found, files, folder);
  std::vector<SlicePlace> slices;
  slices.reserve(files.size());
  for (const auto& file : files) slices.push_back(place_of(file, folder));
  std::vector<std::string> chosen_files;
  std::vector<SlicePlace> chosen;
  for (const auto s : slices_of_phase(slices, phase, folder)) {
    chosen_files.push_back(files[s]);
    chosen.push_back(slices[s]);
  }
  check_stack(stack_of(chosen, folder), folder);
  const auto reader = itk::ImageSeriesReader<Image<float>>::New();
  reader->SetImageIO(itk::GDCMImageIO::New());
  reader->SetFileNames(chosen_files);
  reader->Update();
  return plain_volume(*reader->GetOutput());
}

}  // namespace

Volume<float> read_dicom_series(const std::string& folder, bool allow_2d, int phase) {
  const auto found = dicom_files(folder);
  double file_bytes = 0, voxels = 0;
  Index3 largest{1, 1, 0};
  for (const auto& file : found) {
    file_bytes += static_cast<double>(file.bytes);
    voxels += static_cast<double>(file.rows * file.columns * file.frames);
    largest = {std::max(largest[0], file.columns), std::max(largest[1], file.rows), largest[2] + file.frames};
  }
  check_size(largest, folder, true);
  constexpr double copies = 3;  // the library's as floats, and two ways out
  const auto volume =
      read_behind_wall<Volume<float>>(folder, allowance_for(file_bytes, copies * sizeof(float) * voxels), [&] {
        try {
          return read_series(found, folder, phase);
        } catch (const itk::ExceptionObject& error) {
          throw UserError(fmt::format("cannot be read: {}", one_line(error.GetDescription())), folder,
                          "is it complete and undamaged?");
        }
      });
  check_size(volume.grid.size, folder, allow_2d);
  return volume;
}

}  // namespace heartgen::adapters
