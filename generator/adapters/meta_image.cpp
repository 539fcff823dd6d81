#include "generator/adapters/meta_image.hpp"

#include <fmt/format.h>

#include <charconv>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>

#include "model/error.hpp"
#include "model/input_file.hpp"

namespace heart::adapters {
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

}  // namespace

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

}  // namespace heart::adapters
