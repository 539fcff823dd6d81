// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/adapters/nifti_io.hpp"

#include <fmt/format.h>
#include <nifti1_io.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "generator/adapters/behind_wall.hpp"
#include "generator/adapters/image_checks.hpp"
#include "model/error.hpp"

namespace heartgen::adapters {
namespace {

/// sform first (what converters write), then qform, then bare voxel sizes.
mat44 ras_from_index(const nifti_image& image) {
  if (image.sform_code > 0) return image.sto_xyz;
  return image.qto_xyz;  // the library fills it from pixdim when there is no qform either
}

/// Length of the file's unit; files that name none mean mm.
double unit_mm(const nifti_image& image) {
  return image.xyz_units == NIFTI_UNITS_METER ? 1000 : image.xyz_units == NIFTI_UNITS_MICRON ? 1e-3 : 1;
}

Grid grid_of(const nifti_image& image) {
  Grid grid;
  grid.size = {image.nx, image.ny, std::max<std::int64_t>(image.nz, 1)};
  const mat44 m = ras_from_index(image);
  const double unit = unit_mm(image);
  std::array<Vec3, 3> columns;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 column = unit * Vec3{-m.m[0][axis], -m.m[1][axis], m.m[2][axis]};
    grid.spacing_mm[axis] = norm(column);
    columns[static_cast<std::size_t>(axis)] = normalized(column);
    for (int row = 0; row < 3; ++row) grid.direction[row][axis] = columns[static_cast<std::size_t>(axis)][row];
  }
  grid.origin_mm = unit * Vec3{-m.m[0][3], -m.m[1][3], m.m[2][3]};
  return grid;
}

std::int64_t voxels_of_a_phase(const nifti_image& image) {
  return static_cast<std::int64_t>(image.nx) * image.ny * std::max(image.nz, 1);
}

/// The voxels as they lie in the file, in this machine's byte order. Not by the library, which fills what a truncated
/// file lacks with zeros and makes NaN zero, and says neither. zlib reads plain files as they are.
std::vector<std::byte> read_voxel_bytes(const nifti_image& image, const std::string& path, int phase) {
  std::vector<std::byte> bytes(static_cast<std::size_t>(voxels_of_a_phase(image) * image.nbyper));
  const std::unique_ptr<gzFile_s, decltype(&gzclose)> file(gzopen(path.c_str(), "rb"), &gzclose);
  const auto begin = image.iname_offset + (std::max(phase, 1) - 1) * static_cast<std::int64_t>(bytes.size());
  bool complete = file && gzseek(file.get(), begin, SEEK_SET) == begin;
  constexpr std::size_t largest_read = 1U << 30;
  for (std::size_t done = 0; complete && done < bytes.size();) {
    const auto wanted = static_cast<unsigned>(std::min(largest_read, bytes.size() - done));
    complete = gzread(file.get(), &bytes[done], wanted) == static_cast<int>(wanted);
    done += wanted;
  }
  // Only past the last byte, behind other phases, is the checksum compared; a lack of it is no error of reading.
  int state = Z_OK;
  std::vector<std::byte> beyond(1U << 16);
  auto left = (std::max(image.nt, 1) - std::max(phase, 1)) * static_cast<std::int64_t>(bytes.size());
  for (int read = 1; complete && read > 0; left -= read)
    read = std::max(gzread(file.get(), beyond.data(), static_cast<unsigned>(beyond.size())), 0);
  complete = complete && left <= 0;
  if (complete) gzerror(file.get(), &state);
  if (!complete || state != Z_OK) throw UserError("is truncated or damaged", path, "copy or download it again");
  if (image.swapsize > 1 && image.byteorder != nifti_short_order())
    nifti_swap_Nbytes(bytes.size() / static_cast<std::size_t>(image.swapsize), image.swapsize, bytes.data());
  return bytes;
}

template <class T>
void copy_scaled(const nifti_image& image, const std::vector<std::byte>& bytes, std::vector<float>& to) {
  const T* from = reinterpret_cast<const T*>(bytes.data());
  const bool scaled = std::isfinite(image.scl_slope) && image.scl_slope != 0 && std::isfinite(image.scl_inter);
  const double slope = scaled ? image.scl_slope : 1, intercept = scaled ? image.scl_inter : 0;
  for (std::size_t i = 0; i < to.size(); ++i)
    to[i] = static_cast<float>(slope * static_cast<double>(from[i]) + intercept);
}

void copy_voxels(const nifti_image& image, const std::string& path, int phase, std::vector<float>& to) {
  const auto bytes = read_voxel_bytes(image, path, phase);
  switch (image.datatype) {
    case DT_UINT8:
      return copy_scaled<std::uint8_t>(image, bytes, to);
    case DT_INT8:
      return copy_scaled<std::int8_t>(image, bytes, to);
    case DT_INT16:
      return copy_scaled<std::int16_t>(image, bytes, to);
    case DT_UINT16:
      return copy_scaled<std::uint16_t>(image, bytes, to);
    case DT_INT32:
      return copy_scaled<std::int32_t>(image, bytes, to);
    case DT_UINT32:
      return copy_scaled<std::uint32_t>(image, bytes, to);
    case DT_INT64:
      return copy_scaled<std::int64_t>(image, bytes, to);
    case DT_UINT64:
      return copy_scaled<std::uint64_t>(image, bytes, to);
    case DT_FLOAT32:
      return copy_scaled<float>(image, bytes, to);
    case DT_FLOAT64:
      return copy_scaled<double>(image, bytes, to);
    default:
      throw UserError(fmt::format("holds voxels of type {}", nifti_datatype_string(image.datatype)), path,
                      "convert it to 16-bit integers or floats");
  }
}

/// The length of the header, with which a file begins, in either byte order.
bool is_version_2(const std::string& path) {
  constexpr std::int32_t version_2_bytes = 540;
  std::int32_t length = 0;
  const std::unique_ptr<gzFile_s, decltype(&gzclose)> file(gzopen(path.c_str(), "rb"), &gzclose);
  if (!file || gzread(file.get(), &length, sizeof length) != sizeof length) return false;
  std::int32_t swapped = length;
  nifti_swap_4bytes(1, &swapped);
  return length == version_2_bytes || swapped == version_2_bytes;
}

/// What the library makes of the header, in a process of its own; what it points to stays there.
nifti_image read_header(const std::string& path, int phase = 0) {
  const auto file_bytes = static_cast<double>(std::filesystem::file_size(path));
  const auto image = read_behind_wall<nifti_image>(path, allowance_for(file_bytes, 0), [&] {
    nifti_set_debug_level(0);
    const nifti_image* header = nifti_image_read(path.c_str(), 0);
    if (!header && is_version_2(path))
      throw UserError("is of version 2 of the NIfTI format, which is not read", path, "save it as NIfTI-1 or as .nrrd");
    if (!header) throw UserError("is no NIfTI file, or its header is damaged", path, "is it complete and undamaged?");
    return *header;
  });
  const double voxels = static_cast<double>(image.nx) * image.ny * std::max(image.nz, 1);
  const double phases = std::max(image.nt, 1);
  if (image.ndim > 3 && static_cast<double>(image.nvox) != voxels * phases)
    throw UserError("has more than four dimensions", path, "extract one volume first");
  if (static_cast<double>(image.nvox) != voxels * phases || image.nbyper < 1 || image.iname_offset < 0)
    throw UserError("is no NIfTI file, or its header is damaged", path, "is it complete and undamaged?");
  check_claim(voxels * phases * image.nbyper, file_bytes, path.ends_with(".gz"), path);
  check_phase(phase, std::max(image.nt, 1), path);
  return image;
}

/// What lies between header and voxels. Empty for a file that keeps its voxels elsewhere.
std::string read_extensions(const nifti_image& image, const std::string& path) {
  constexpr std::int64_t header_bytes = 348, max_bytes = 1 << 20;
  const std::int64_t wanted = std::min<std::int64_t>(image.iname_offset - header_bytes, max_bytes);
  if (wanted <= 0) return {};
  std::string text(static_cast<std::size_t>(wanted), ' ');
  const std::unique_ptr<gzFile_s, decltype(&gzclose)> file(gzopen(path.c_str(), "rb"), &gzclose);
  if (!file || gzseek(file.get(), header_bytes, SEEK_SET) != header_bytes) return {};
  const int bytes = gzread(file.get(), text.data(), static_cast<unsigned>(wanted));
  text.resize(static_cast<std::size_t>(std::max(bytes, 0)));
  return text;
}

/// The text after `start` up to `end`, from `at` on, which moves behind it; nothing where one of them is missing.
std::optional<std::string_view> between(std::string_view text, std::string_view start, std::string_view end,
                                        std::size_t& at) {
  const auto first = text.find(start, at);
  if (first == std::string_view::npos) return {};
  const auto from = first + start.size(), to = text.find(end, from);
  if (to == std::string_view::npos) return {};
  at = to + end.size();
  return text.substr(from, to - from);
}

}  // namespace

std::vector<std::pair<std::int32_t, std::string>> read_nifti_label_names(const std::string& path) {
  const std::string text = read_extensions(read_header(path), path);
  std::vector<std::pair<std::int32_t, std::string>> names;
  std::size_t at = 0;
  const auto table = between(text, "<LabelTable", "</LabelTable>", at);
  if (!table) return names;
  for (std::size_t next = 0; const auto label = between(*table, "<Label ", "</Label>", next);) {
    std::size_t key_at = 0, name_at = 0;
    const auto key = between(*label, "Key=\"", "\"", key_at);
    auto name = between(*label, "<![CDATA[", "]]>", name_at);
    if (!name) name = label->substr(std::min(label->find('>'), label->size() - 1) + 1);
    std::int32_t value = 0;
    if (key && std::from_chars(key->data(), key->data() + key->size(), value).ec == std::errc() && value != 0 &&
        !name->empty())
      names.emplace_back(value, *name);
  }
  return names;
}

Grid read_nifti_grid(const std::string& path, int phase) { return grid_of(read_header(path, phase)); }

Volume<float> read_nifti(const std::string& path, int phase) {
  const nifti_image image = read_header(path, phase);
  Volume<float> volume(grid_of(image));
  copy_voxels(image, path, phase, volume.voxels);
  return volume;
}

}  // namespace heartgen::adapters
