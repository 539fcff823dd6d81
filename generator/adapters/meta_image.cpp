// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/adapters/meta_image.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>
#include <vector>

#include "generator/adapters/behind_wall.hpp"
#include "model/error.hpp"
#include "model/input_file.hpp"

namespace heartgen::adapters {
namespace {

namespace fs = std::filesystem;

/// The value of "KEY = VALUE", empty on a line with another key.
std::string meta_value(const std::string& line, const std::string& key) {
  if (!line.starts_with(key + " =")) return {};
  const auto first = line.find_first_not_of(' ', key.size() + 2);
  return first == std::string::npos ? std::string{} : line.substr(first, line.find_last_not_of(" \r") - first + 1);
}

/// Of a list of numbers; "1e-3" is none.
bool has_negative(const std::string& list) { return list.starts_with('-') || list.find(" -") != std::string::npos; }

[[noreturn]] void refuse_header(const std::string& path, const std::string& what) {
  throw UserError("has a damaged header: " + what, path, "is it complete and undamaged?");
}

/// The library's places hold 255 bytes of a text, and 500 of a line.
void check_line(const std::string& line, const std::string& path) {
  constexpr std::size_t longest_key = 200, longest_text = 254, longest_list = 480;
  const auto sign = std::min(line.find_first_of("=:"), line.size());
  const bool is_list = line.find_first_not_of("0123456789+-.eE \t\r", sign + 1) == std::string::npos;
  if (sign > longest_key || line.size() - sign > (is_list ? longest_list : longest_text))
    refuse_header(path, fmt::format("the line \"{}...\" is {} bytes long", one_line(line.substr(0, 20)), line.size()));
}

/// Whole numbers in a line, until something else.
std::vector<std::int64_t> whole_numbers(const std::string& list) {
  std::vector<std::int64_t> numbers;
  std::istringstream stream(list);
  for (std::int64_t number = 0; stream >> number;) numbers.push_back(number);
  return numbers;
}

}  // namespace

void check_meta_header(const std::string& path) {
  constexpr std::size_t max_bytes = 1 << 20;
  constexpr std::int64_t max_dimensions = 4;
  std::ifstream header(path, std::ios::binary);
  std::size_t bytes = 0;
  std::int64_t dimensions = 0;
  for (std::string line; std::getline(header, line);) {
    check_line(line, path);
    if ((bytes += line.size() + 1) > max_bytes) refuse_header(path, "it does not end");
    if (const auto value = meta_value(line, "NDims"); !value.empty()) {
      const auto numbers = whole_numbers(value);
      dimensions = numbers.empty() ? 0 : numbers.front();
      if (dimensions < 1 || dimensions > max_dimensions)
        refuse_header(path, fmt::format("{} dimensions", one_line(value)));
    }
    if (const auto value = meta_value(line, "DimSize"); !value.empty()) {
      const auto sizes = whole_numbers(value);
      const bool is_empty = std::any_of(sizes.begin(), sizes.end(), [](auto size) { return size < 1; });
      if (dimensions == 0 || static_cast<std::int64_t>(sizes.size()) != dimensions || is_empty)
        refuse_header(path, fmt::format("{} dimensions of sizes {}", dimensions, one_line(value)));
    }
    if (!meta_value(line, "ElementDataFile").empty()) return;
  }
}

bool is_meta_image(const std::string& path) { return path.ends_with(".mhd") || path.ends_with(".mha"); }

void check_meta_image(const std::string& path, std::uintmax_t voxel_bytes, const char* remedy) {
  std::ifstream header(path, std::ios::binary);
  std::uintmax_t expected = voxel_bytes;
  std::string data_file;
  for (std::string line; data_file.empty() && std::getline(header, line);
       data_file = meta_value(line, "ElementDataFile")) {
    if (has_negative(meta_value(line, "ElementSpacing")))
      throw UserError("has a voxel spacing that is not positive", path, "turn the axis in TransformMatrix instead");
    if (meta_value(line, "CompressedData") == "True") expected = 0;  // unknown, when no size follows
    const auto size = meta_value(line, "CompressedDataSize");
    std::from_chars(size.data(), size.data() + size.size(), expected);
  }
  const bool local = data_file == "LOCAL";
  const fs::path data = local ? fs::path(path) : fs::path(path).parent_path() / data_file;
  if (data_file == "LIST" || !fs::exists(data) || fs::is_directory(data)) return;
  require_input_file(data, remedy);
  const auto start = local ? static_cast<std::uintmax_t>(header.tellg()) : 0;
  if (fs::file_size(data) < start + expected)
    throw UserError(local ? "is truncated" : fmt::format("its voxels in {} are truncated", data_file), path, remedy);
}

bool point_to_voxels(const std::string& header, const std::string& voxels_file) {
  constexpr std::string_view key = "ElementDataFile = ";
  std::ostringstream text;
  text << std::ifstream(header, std::ios::binary).rdbuf();
  const std::string before = text.str();
  const auto at = before.rfind(key);
  std::ofstream file(header, std::ios::binary | std::ios::trunc);
  file << before.substr(0, at) << key << voxels_file << "\n";
  return at != std::string::npos && file.flush().good();
}

}  // namespace heartgen::adapters
