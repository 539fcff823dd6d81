// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/adapters/itk_io.hpp"

#include <fmt/format.h>
#include <itkImageFileReader.h>
#include <itkImageFileWriter.h>
#include <itkImageIOFactory.h>
#include <itkMetaDataObject.h>
#include <itkMetaImageIOFactory.h>
#include <itkMultiThreaderBase.h>
#include <itkNiftiImageIOFactory.h>
#include <itkNrrdImageIOFactory.h>
#include <itkVectorImage.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string_view>

#include "generator/adapters/behind_wall.hpp"
#include "generator/adapters/dicom_files.hpp"
#include "generator/adapters/dicom_io.hpp"
#include "generator/adapters/image_checks.hpp"
#include "generator/adapters/itk_volume.hpp"
#include "generator/adapters/meta_image.hpp"
#include "generator/adapters/nifti_io.hpp"
#include "model/error.hpp"
#include "model/input_file.hpp"
#include "model/new_file.hpp"
#include "model/priors.hpp"
#include "model/text.hpp"

namespace heartgen::adapters {

static auto members(LabelSegment& s) { return std::tie(s.name, s.value, s.layer); }

namespace {

namespace fs = std::filesystem;
constexpr const char* known_formats =
    "known formats: .nii, .nii.gz, .nrrd, .mhd, .mha, or a folder with a DICOM series";

/// Debian's ITK registers no formats by itself.
void register_formats() {
  static const bool done = [] {
    itk::Object::GlobalWarningDisplayOff();
    itk::NiftiImageIOFactory::RegisterOneFactory();
    itk::NrrdImageIOFactory::RegisterOneFactory();
    itk::MetaImageIOFactory::RegisterOneFactory();
    return true;
  }();
  static_cast<void>(done);
}

/// The double nearest to `value` with that many decimals; dividing (not multiplying by 1e-6) gives the same bits as
/// reading the decimal text.
double rounded(double value, double per_unit) { return std::round(value * per_unit) / per_unit + 0.0; }

void round_geometry(Grid& grid) {
  for (int axis = 0; axis < 3; ++axis) {
    grid.spacing_mm[axis] = rounded(grid.spacing_mm[axis], 1e6);
    grid.origin_mm[axis] = rounded(grid.origin_mm[axis], 1e3);
    for (int row = 0; row < 3; ++row) grid.direction[row][axis] = rounded(grid.direction[row][axis], 1e6);
  }
}

/// For each new axis: the old axis that lies nearest to it, each used once, the clearest match first.
std::array<int, 3> nearest_axes(const Mat3& direction) {
  std::array<int, 3> source{-1, -1, -1};
  std::array<bool, 3> used{};
  for (int round = 0; round < 3; ++round) {
    int best_row = -1, best_column = -1;
    double best = -1;
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column)
        if (source[static_cast<std::size_t>(row)] < 0 && !used[static_cast<std::size_t>(column)] &&
            std::abs(direction[row][column]) > best) {
          best = std::abs(direction[row][column]);
          best_row = row;
          best_column = column;
        }
    source[static_cast<std::size_t>(best_row)] = best_column;
    used[static_cast<std::size_t>(best_column)] = true;
  }
  return source;
}

/// The first three axes of what a header says, and what takes more of them.
Grid header_grid(const itk::ImageIOBase& io, const std::string& path) {
  const unsigned dimensions = io.GetNumberOfDimensions();
  if (dimensions > 3 && io.GetDimensions(3) > 1)
    throw UserError(fmt::format("has {} dimensions, a volume has 3", dimensions), path, "extract one time frame first");
  Grid grid;
  grid.size = {1, 1, 1};
  for (unsigned axis = 0; axis < std::min(dimensions, 3U); ++axis) {
    grid.size[axis] = static_cast<std::int64_t>(io.GetDimensions(axis));
    grid.spacing_mm[static_cast<int>(axis)] = io.GetSpacing(axis);
    grid.origin_mm[static_cast<int>(axis)] = io.GetOrigin(axis);
    const auto direction = io.GetDirection(axis);
    for (unsigned row = 0; row < std::min(dimensions, 3U); ++row)
      grid.direction[static_cast<int>(row)][static_cast<int>(axis)] = direction[row];
  }
  return grid;
}

/// Looks at the header before any voxel is read, and allows for what the voxels take.
void check_header(const itk::ImageIOBase& io, const std::string& path, bool allow_2d) {
  const Grid grid = header_grid(io, path);
  check_grid(grid, path);
  check_size(grid.size, path, allow_2d);
  constexpr double copies = 3;  // the library's as floats, and two ways out
  const auto components = static_cast<double>(io.GetNumberOfComponents());
  const double values = static_cast<double>(grid.voxel_count()) * components;
  const auto bytes = static_cast<double>(io.GetComponentSize());
  const auto whole = allowance_for(static_cast<double>(fs::file_size(path)), values * (bytes + copies * sizeof(float)));
  allow_memory(whole.memory_bytes);
}

/// A patient of less than a few millimetres, or of many metres, comes from lengths in another unit.
void check_extent(const Grid& grid, const std::string& path) {
  double largest = 0;
  for (int axis = 0; axis < 3; ++axis)
    largest = std::max(largest, grid.spacing_mm[axis] * static_cast<double>(grid.size[static_cast<std::size_t>(axis)]));
  if (largest < priors::patient_min_mm || largest > priors::patient_max_mm)
    throw UserError(fmt::format("is {:.3g} mm wide, which no patient is", largest), path,
                    "give spacing and origin in mm, not in m or um");
}

bool is_nifti(const std::string& path) { return path.ends_with(".nii") || path.ends_with(".nii.gz"); }

/// The library takes the frame left-anterior-superior for another one, turned by 180 degrees about the third axis, and
/// reads voxels from whatever the header names.
void check_nrrd_header(const std::string& path) {
  constexpr std::string_view key = "space:";
  std::ifstream file(path, std::ios::binary);
  for (std::string line; std::getline(file, line) && !line.empty() && line != "\r";) {
    for (const std::string_view data_key : {"data file: ", "datafile: "})
      if (line.starts_with(data_key)) {
        const auto data =
            fs::path(path).parent_path() / line.substr(data_key.size(), line.find('\r') - data_key.size());
        if (fs::exists(data)) require_input_file(data);
      }
    if (!line.starts_with(key)) continue;
    std::string space;
    for (const char c : line.substr(key.size()))
      if (std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '-')
        space += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (space == "left-anterior-superior" || space == "las")
      throw UserError("has the frame left-anterior-superior, which cannot be read faithfully", path,
                      "write it as left-posterior-superior, right-anterior-superior or NIfTI");
  }
}

itk::ImageIOBase::Pointer open_header(const std::string& path) {
  if (path.ends_with(".nrrd")) check_nrrd_header(path);
  const auto io = itk::ImageIOFactory::CreateImageIO(path.c_str(), itk::ImageIOFactory::ReadMode);
  if (!io && is_dicom_file(path))
    throw UserError("is one file of a DICOM series", path, "name the folder that holds the series and nothing else");
  if (!io) throw UserError("is no image of a known format, or its header is damaged", path, known_formats);
  io->SetFileName(path);
  io->ReadImageInformation();
  return io;
}

/// By ITK, in a process of its own.
Volume<float> read_scalar_image(const std::string& path, bool allow_2d) {
  const auto io = open_header(path);
  check_header(*io, path, allow_2d);
  if (io->GetNumberOfComponents() != 1)
    throw UserError(fmt::format("has {} components per voxel", io->GetNumberOfComponents()), path,
                    "give a scalar image in Hounsfield units");
  if (is_meta_image(path))
    check_meta_image(path, static_cast<std::uintmax_t>(io->GetImageSizeInBytes()), "copy or download it again");
  const auto reader = itk::ImageFileReader<Image<float>>::New();
  reader->SetImageIO(io);
  reader->SetFileName(path);
  reader->Update();
  return plain_volume(*reader->GetOutput());
}

/// What a library says, without the object and the address that it begins with, and the system's last error, which may
/// be of something else, at its end.
std::string what_failed(const itk::ExceptionObject& error) {
  auto text = one_line(error.GetDescription());
  if (const auto address = text.find("(0x"); address != text.npos)
    if (const auto end = text.find("): ", address); end != text.npos) text.erase(0, end + 3);
  return text.substr(0, text.find(" Reason: "));
}

UserError unreadable(const std::string& path, const itk::ExceptionObject& error) {
  return {fmt::format("cannot be read: {}", what_failed(error)), path, "is it complete and undamaged?"};
}

/// While it lives, what libraries write to std::cerr goes nowhere: MetaIO says there, in lines of its own, what an
/// exception then says again.
class QuietLibraries {
 public:
  QuietLibraries() : usual_(std::cerr.rdbuf(nullptr)) {}
  ~QuietLibraries() {
    std::cerr.rdbuf(usual_);  // clears the state, too
  }
  QuietLibraries(const QuietLibraries&) = delete;
  QuietLibraries& operator=(const QuietLibraries&) = delete;

 private:
  std::streambuf* usual_;
};

/// What a reader of ITK's returns in a process of its own. The allowance is for the header.
template <class T, class Read>
T read_by_itk(const std::string& path, const Read& read) {
  register_formats();
  if (is_meta_image(path)) check_meta_header(path);
  return read_behind_wall<T>(path, allowance_for(static_cast<double>(fs::file_size(path)), 0), [&] {
    itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(1);
    try {
      return read();
    } catch (const itk::ExceptionObject& error) {
      throw unreadable(path, error);
    }
  });
}

Volume<float> read_file(const std::string& path, bool allow_2d, int phase) {
  if (is_nifti(path)) {
    const Grid grid = read_nifti_grid(path, phase);
    check_grid(grid, path);
    check_size(grid.size, path, allow_2d);
    return read_nifti(path, phase);
  }
  check_phase(phase, 1, path);
  return read_by_itk<Volume<float>>(path, [&] { return read_scalar_image(path, allow_2d); });
}

void check_finite(const Volume<float>& volume, const std::string& path) {
  for (const float value : volume.voxels)
    if (!std::isfinite(value)) throw UserError("contains NaN or infinite voxels", path, "repair the image");
}

Volume<float> read_any(const std::string& path, bool allow_2d, int phase = 0) {
  if (!fs::is_directory(path)) require_input_file(path);
  const Volume<float> volume =
      fs::is_directory(path) ? read_dicom_series(path, allow_2d, phase) : read_file(path, allow_2d, phase);
  check_grid(volume.grid, path);
  check_size(volume.grid.size, path, allow_2d);
  check_finite(volume, path);
  return with_canonical_axes(volume);
}

Volume<std::int32_t> whole_numbers(const Volume<float>& image, const std::string& path) {
  constexpr float largest_exact = 16777216;  // beyond it not every whole number is a float
  Volume<std::int32_t> values(image.grid);
  for (std::size_t i = 0; i < image.voxels.size(); ++i) {
    const float value = image.voxels[i];
    if (value != std::floor(value) || std::abs(value) > largest_exact)
      throw UserError(fmt::format("holds the value {}, labels are whole numbers", value), path, "is this a label map?");
    values.voxels[i] = static_cast<std::int32_t>(value);
  }
  return values;
}

/// The number behind "Segment0_LabelValue" or "Segment0_Layer".
std::int32_t header_number(const itk::MetaDataDictionary& header, const std::string& key, std::int32_t otherwise) {
  std::string text;
  std::int32_t number = otherwise;
  if (itk::ExposeMetaData<std::string>(header, key, text))
    std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

/// Older files have no values: every segment is a layer of its own, marked by 1.
std::vector<LabelSegment> named_segments(const itk::MetaDataDictionary& header, std::size_t layers,
                                         const std::string& path) {
  std::vector<LabelSegment> segments;
  for (int n = 0;; ++n) {
    const std::string prefix = fmt::format("Segment{}_", n);
    LabelSegment segment;
    if (!itk::ExposeMetaData<std::string>(header, prefix + "Name", segment.name)) return segments;
    segment.value = header_number(header, prefix + "LabelValue", 1);
    const auto layer = header_number(header, prefix + "Layer", layers > 1 ? n : 0);
    if (layer < 0 || static_cast<std::size_t>(layer) >= layers)
      throw UserError(fmt::format("segment \"{}\" refers to layer {} of {}", segment.name, layer, layers), path,
                      "save the segmentation again");
    segment.layer = static_cast<std::size_t>(layer);
    segments.push_back(segment);
  }
}

/// Every component of a vector image as a volume of its own.
std::vector<Volume<float>> read_layers(itk::ImageIOBase* io, const std::string& path) {
  const auto reader = itk::ImageFileReader<itk::VectorImage<float, 3>>::New();
  reader->SetImageIO(io);
  reader->SetFileName(path);
  reader->Update();
  const auto& image = *reader->GetOutput();
  const std::size_t count = image.GetNumberOfComponentsPerPixel();
  std::vector<Volume<float>> layers(count, Volume<float>(grid_of(image)));
  const float* data = image.GetBufferPointer();
  for (std::size_t v = 0; v < layers.front().voxels.size(); ++v)
    for (std::size_t layer = 0; layer < count; ++layer) layers[layer].voxels[v] = *data++;
  return layers;
}

/// The frame that a NRRD's vectors are measured in; the identity where the header has none.
Mat3 measurement_frame(const itk::MetaDataDictionary& header) {
  std::vector<std::vector<double>> columns;
  Mat3 frame;
  if (!itk::ExposeMetaData(header, "NRRD_measurement frame", columns) || columns.size() != 3) return frame;
  for (std::size_t column = 0; column < 3; ++column)
    for (std::size_t row = 0; row < 3 && columns[column].size() == 3; ++row)
      frame[static_cast<int>(row)][static_cast<int>(column)] = columns[column][row];
  return frame;
}

/// All that a file of vectors, or of overlapping labels, holds.
struct LayeredFile {
  std::vector<Volume<float>> layers;
  std::vector<LabelSegment> segments;
  Mat3 frame;
};

auto members(LayeredFile& f) { return std::tie(f.layers, f.segments, f.frame); }

LayeredFile read_layered_file(const std::string& path) {
  const auto file = read_by_itk<LayeredFile>(path, [&] {
    const auto io = open_header(path);
    check_header(*io, path, false);
    auto layers = read_layers(io, path);
    auto segments = named_segments(io->GetMetaDataDictionary(), layers.size(), path);
    return LayeredFile{std::move(layers), std::move(segments), measurement_frame(io->GetMetaDataDictionary())};
  });
  check_grid(file.layers.at(0).grid, path);
  for (const auto& layer : file.layers) check_finite(layer, path);
  return file;
}

template <class To>
Volume<To> converted(const Volume<float>& in) {
  Volume<To> out(in.grid);
  for (std::size_t i = 0; i < in.voxels.size(); ++i) {
    const float clamped = std::clamp(in.voxels[i], static_cast<float>(std::numeric_limits<To>::min()),
                                     static_cast<float>(std::numeric_limits<To>::max()));
    out.voxels[i] = static_cast<To>(std::lround(clamped));
  }
  return out;
}

/// The NIfTI library says nothing when a file cannot be made or the disk is full. A compressed file ends with the
/// number of bytes in it, modulo 2^32.
bool is_whole_nifti(const std::string& path, std::uintmax_t voxel_bytes) {
  constexpr std::uintmax_t header_bytes = 352;
  std::error_code error;
  const auto on_disk = fs::file_size(path, error);
  if (error || !path.ends_with(".gz")) return !error && on_disk >= header_bytes + voxel_bytes;
  std::array<unsigned char, 4> last{};
  std::ifstream file(path, std::ios::binary);
  file.seekg(-4, std::ios::end).read(reinterpret_cast<char*>(last.data()), last.size());
  std::uint32_t bytes = 0;
  for (std::size_t b = 0; b < last.size(); ++b) bytes |= std::uint32_t{last[b]} << (8 * b);
  return file && bytes == static_cast<std::uint32_t>(header_bytes + voxel_bytes);
}

UserError no_room(const std::string& path) {
  return {"cannot be written", path, "is there room on the disk, and the right to write there?"};
}

/// `file` is what becomes `path`.
void check_written(const std::string& file, const std::string& path, std::uintmax_t voxel_bytes) {
  bool whole = true;
  try {
    if (is_nifti(file)) whole = is_whole_nifti(file, voxel_bytes);
    if (is_meta_image(file)) check_meta_image(file, voxel_bytes, "");
  } catch (const UserError&) {
    whole = false;
  }
  if (!whole) throw no_room(path);
}

template <class T>
typename Image<T>::Pointer itk_image(const Volume<T>& volume) {
  auto image = Image<T>::New();
  typename Image<T>::SizeType size;
  typename Image<T>::SpacingType spacing;
  typename Image<T>::PointType origin;
  typename Image<T>::DirectionType direction;
  for (unsigned axis = 0; axis < 3; ++axis) {
    size[axis] = static_cast<itk::SizeValueType>(volume.grid.size[axis]);
    spacing[axis] = volume.grid.spacing_mm[static_cast<int>(axis)];
    origin[axis] = volume.grid.origin_mm[static_cast<int>(axis)];
    for (unsigned row = 0; row < 3; ++row)
      direction(row, axis) = volume.grid.direction[static_cast<int>(row)][static_cast<int>(axis)];
  }
  image->SetRegions(size);
  image->SetSpacing(spacing);
  image->SetOrigin(origin);
  image->SetDirection(direction);
  image->Allocate();
  std::copy(volume.voxels.begin(), volume.voxels.end(), image->GetBufferPointer());
  return image;
}

/// Writes `file`, which becomes `path`.
template <class T>
void write_file(const std::string& file, const std::string& path, const Volume<T>& volume) {
  register_formats();
  const QuietLibraries quiet;
  const auto writer = itk::ImageFileWriter<Image<T>>::New();
  writer->SetFileName(file);
  writer->SetInput(itk_image(volume));
  writer->SetUseCompression(!path.ends_with(".nii"));
  try {
    writer->Update();
  } catch (const itk::ExceptionObject& error) {
    throw UserError(fmt::format("cannot be written: {}", what_failed(error)), path,
                    "is there room on the disk, and the right to write there?");
  }
  check_written(file, path, volume.voxels.size() * sizeof(T));
}

/// A header and, beside it, its voxels: written under the names that they have aside, the header then told the voxels'
/// own name. Last both take their places, one right after the other.
template <class T>
void write_pair(const std::string& path, const Volume<T>& volume) {
  constexpr const char* voxels_ending = ".zraw";
  NewFile header(path);
  NewFile voxels(fs::path(header.place).replace_extension(voxels_ending));
  if (voxels.partial != fs::path(header.partial).replace_extension(voxels_ending))
    throw UserError("cannot be written: " + voxels.partial.string() + " is in the way", path, "remove that file");
  write_file(header.partial.string(), path, volume);
  if (!point_to_voxels(header.partial.string(), voxels.place.filename().string())) throw no_room(path);
  voxels.finish();
  header.finish();
}

template <class T>
void write(const std::string& path, const Volume<T>& volume) {
  check_image_output(path);
  if (path.ends_with(".mhd")) return write_pair(path, volume);
  NewFile whole(path);
  write_file(whole.partial.string(), path, volume);
  whole.finish();
}

}  // namespace

template <class T>
Volume<T> with_canonical_axes(const Volume<T>& volume) {
  const auto source = nearest_axes(volume.grid.direction);
  Grid grid;
  Vec3 corner_index;  // index in the old volume of the new voxel (0, 0, 0)
  std::array<std::int64_t, 3> stride{}, old_stride{1, volume.grid.size[0], volume.grid.size[0] * volume.grid.size[1]};
  std::int64_t start = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int from = source[static_cast<std::size_t>(axis)];
    const bool flip = volume.grid.direction[axis][from] < 0;
    const auto length = volume.grid.size[static_cast<std::size_t>(from)];
    grid.size[static_cast<std::size_t>(axis)] = length;
    grid.spacing_mm[axis] = volume.grid.spacing_mm[from];
    corner_index[from] = flip ? static_cast<double>(length - 1) : 0;
    stride[static_cast<std::size_t>(axis)] = (flip ? -1 : 1) * old_stride[static_cast<std::size_t>(from)];
    if (flip) start += (length - 1) * old_stride[static_cast<std::size_t>(from)];
    for (int row = 0; row < 3; ++row) grid.direction[row][axis] = (flip ? -1 : 1) * volume.grid.direction[row][from];
  }
  grid.origin_mm = lps_from_index(volume.grid, corner_index);
  round_geometry(grid);
  Volume<T> result(grid);
  std::size_t to = 0;
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i)
        result.voxels[to++] =
            volume.voxels[static_cast<std::size_t>(start + i * stride[0] + j * stride[1] + k * stride[2])];
  return result;
}
template Volume<float> with_canonical_axes(const Volume<float>&);
template Volume<std::int16_t> with_canonical_axes(const Volume<std::int16_t>&);
template Volume<std::uint8_t> with_canonical_axes(const Volume<std::uint8_t>&);

CtVolume read_ct(const std::string& path, int phase) {
  const Volume<float> image = read_any(path, false, phase);
  check_extent(image.grid, path);
  return converted<std::int16_t>(image);
}

LabelVolume read_labels(const std::string& path) {
  const Volume<float> image = read_any(path, false);
  for (const float value : image.voxels)
    if (value < 0 || value > 255 || value != std::floor(value))
      throw UserError(fmt::format("holds the value {}, labels are whole numbers from 0 to 255", value), path,
                      "is this a label map?");
  return converted<std::uint8_t>(image);
}

LabelImage read_label_image(const std::string& path) {
  if (!path.ends_with(".nrrd") || !fs::is_regular_file(path)) {
    LabelImage image{{whole_numbers(read_any(path, false), path)}, {}};
    if (is_nifti(path))
      for (auto& [value, name] : read_nifti_label_names(path)) image.segments.push_back({std::move(name), value, 0});
    return image;
  }
  require_input_file(path);
  const auto file = read_layered_file(path);
  LabelImage image;
  image.segments = file.segments;
  for (const auto& layer : file.layers) image.layers.push_back(whole_numbers(with_canonical_axes(layer), path));
  return image;
}

Volume<float> read_image(const std::string& path) { return read_any(path, true); }

ComponentImage read_components(const std::string& path) {
  require_input_file(path);
  auto file = read_layered_file(path);
  for (auto& layer : file.layers) layer = with_canonical_axes(layer);
  return {std::move(file.layers), file.frame};
}

void check_image_output(const std::string& path) {
  constexpr std::array endings{".nii", ".nii.gz", ".nrrd", ".mhd", ".mha"};
  if (std::none_of(endings.begin(), endings.end(), [&](const char* ending) { return path.ends_with(ending); }))
    throw UserError("is of no known kind", path, "use .nii.gz, .nii, .nrrd, .mha or .mhd");
  check_output(path);
}

void write_volume(const std::string& path, const Volume<std::int16_t>& volume) { write(path, volume); }
void write_volume(const std::string& path, const Volume<std::uint8_t>& volume) { write(path, volume); }
void write_volume(const std::string& path, const Volume<float>& volume) { write(path, volume); }

}  // namespace heartgen::adapters
