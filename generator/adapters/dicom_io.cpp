#include "generator/adapters/dicom_io.hpp"

#include <fmt/format.h>
#include <gdcmTrace.h>
#include <itkGDCMImageIO.h>
#include <itkGDCMSeriesFileNames.h>
#include <itkImageSeriesReader.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <vector>

#include "generator/adapters/itk_volume.hpp"
#include "model/error.hpp"
#include "model/input_file.hpp"
#include "model/quantile.hpp"

namespace heart::adapters {
namespace {

namespace fs = std::filesystem;

/// Where a slice lies: the centre of its first pixel, and its rows' and columns' directions.
struct SlicePlace {
  Vec3 first_mm, along_row, along_column;
  Vec3 pixel_mm;  // z: 0
};

std::vector<double> numbers_in(std::string text) {
  std::replace(text.begin(), text.end(), '\\', ' ');
  std::istringstream stream(text);
  std::vector<double> numbers;
  for (double number = 0; stream >> number;) numbers.push_back(number);
  return numbers;
}

std::string whole_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Whether the file says that its pixels are not compressed: transfer syntaxes 1.2.840.10008.1.2, .1.2.1 and .1.2.2.
bool has_plain_pixels(const std::string& file) {
  const std::string tag{"\x02\x00\x10\x00UI", 6};
  const auto at = file.find(tag);
  if (at == std::string::npos || at + tag.size() + 2 > file.size()) return false;
  const auto length = static_cast<unsigned char>(file[at + tag.size()]);
  std::string syntax = file.substr(at + tag.size() + 2, length);
  std::erase(syntax, '\0');
  return syntax == "1.2.840.10008.1.2" || syntax == "1.2.840.10008.1.2.1" || syntax == "1.2.840.10008.1.2.2";
}

/// Whether that many bytes follow an element of pixel data; its length stands 4 or 8 bytes behind its tag.
bool holds_pixels(const std::string& file, std::size_t bytes) {
  for (const std::string& tag : {std::string("\xe0\x7f\x10\x00", 4), std::string("\x7f\xe0\x00\x10", 4)})
    for (auto at = file.find(tag); at != std::string::npos; at = file.find(tag, at + 1))
      if (at + 8 + bytes <= file.size()) return true;
  return false;
}

/// The library fills what a cut-off slice lacks with zeros. Compressed pixels are left to their decoder.
void refuse_missing_pixels(itk::GDCMImageIO& io, const std::string& path) {
  std::string bits;
  io.GetValueFromTag("0028|0100", bits);
  const auto width = numbers_in(bits);
  const std::string file = whole_file(path);
  if (width.size() != 1 || !has_plain_pixels(file)) return;
  const auto bytes = io.GetDimensions(0) * io.GetDimensions(1) * static_cast<std::size_t>(width[0]) / 8;
  if (!holds_pixels(file, bytes)) throw UserError("is truncated", path, "export the series again");
}

SlicePlace place_of(const std::string& file, const std::string& folder) {
  const auto io = itk::GDCMImageIO::New();
  io->SetFileName(file);
  io->ReadImageInformation();
  refuse_missing_pixels(*io, file);
  std::string position, orientation;
  io->GetValueFromTag("0020|0032", position);
  io->GetValueFromTag("0020|0037", orientation);
  const auto p = numbers_in(position), o = numbers_in(orientation);
  if (p.size() != 3 || o.size() != 6)
    throw UserError("has a slice without ImagePositionPatient or ImageOrientationPatient", folder,
                    "export the series again, as the scanner made it");
  const Vec3 pixels{io->GetSpacing(0), io->GetSpacing(1), 0};
  return {{p[0], p[1], p[2]}, {o[0], o[1], o[2]}, {o[3], o[4], o[5]}, pixels};
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

/// The library ends the program at a file that is cut off within its first group. That group begins with its length.
void refuse_cut_off_headers(const std::string& folder) {
  constexpr std::uintmax_t length_at = 140, first_group_at = 144;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_directory() || !entry.exists()) continue;
    require_input_file(entry.path(), "take it out of the folder");
    if (!is_dicom_file(entry.path().string())) continue;
    std::array<unsigned char, 4> bytes{};
    std::ifstream file(entry.path(), std::ios::binary);
    file.seekg(length_at).read(reinterpret_cast<char*>(bytes.data()), bytes.size());
    std::uintmax_t length = 0;
    for (std::size_t b = 0; b < bytes.size(); ++b) length |= std::uintmax_t{bytes[b]} << (8 * b);
    if (!file || entry.file_size() <= first_group_at + length)
      throw UserError("is truncated", entry.path().string(), "export it again, or take it out of the folder");
  }
}

}  // namespace

bool is_dicom_file(const std::string& path) {
  constexpr std::streamoff mark_at = 128;
  std::string mark(4, ' ');
  std::ifstream file(path, std::ios::binary);
  return file.seekg(mark_at).read(mark.data(), 4) && mark == "DICM";
}

Volume<float> read_dicom_series(const std::string& folder) {
  const auto names = itk::GDCMSeriesFileNames::New();
  refuse_cut_off_headers(folder);
  gdcm::Trace::DebugOff();
  gdcm::Trace::WarningOff();
  gdcm::Trace::ErrorOff();  // what it would print is looked at below, or thrown
  names->SetUseSeriesDetails(true);
  names->SetDirectory(folder);
  const auto series = names->GetSeriesUIDs();
  if (series.empty())
    throw UserError("holds no DICOM series", folder, "name a folder with one, or an image: .nii.gz, .nrrd, .mha");
  if (series.size() > 1)
    throw UserError(fmt::format("holds {} DICOM series", series.size()), folder,
                    "put the wanted one in a folder of its own");
  const auto files = names->GetFileNames(series.front());
  std::vector<SlicePlace> slices;
  slices.reserve(files.size());
  for (const auto& file : files) slices.push_back(place_of(file, folder));
  check_stack(stack_of(slices, folder), folder);
  const auto reader = itk::ImageSeriesReader<Image<float>>::New();
  reader->SetImageIO(itk::GDCMImageIO::New());
  reader->SetFileNames(files);
  reader->Update();
  return plain_volume(*reader->GetOutput());
}

}  // namespace heart::adapters
