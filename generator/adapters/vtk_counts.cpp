// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/adapters/vtk_counts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>

#include "model/error.hpp"

namespace heartgen::adapters {
namespace {

constexpr std::uint64_t largest_compression = 1032;
constexpr std::uint64_t nominal_block = 1U << 26;  // writers announce their usual block size, however short the array
constexpr std::uint64_t max_components = 4096;

struct File {
  const std::filesystem::path& path;
  std::string bytes;
};

void require(const File& file, std::uint64_t count, std::uint64_t most, std::string_view what) {
  if (count > most)
    throw UserError(fmt::format("claims {} {}, more than its {} bytes can hold", count, what, file.bytes.size()),
                    file.path.string(), "is the file complete and undamaged?");
}

/// The number at `at`; nothing there: 0, too many digits: the largest number.
std::uint64_t number_at(std::string_view text, std::size_t at) {
  while (at < text.size() && text[at] == ' ') ++at;
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data() + at, text.data() + text.size(), value);
  return error == std::errc::result_out_of_range ? UINT64_MAX : value;
}

/// Calls `check` with the number behind every occurrence of `key`.
template <class Check>
void for_each_number(std::string_view text, std::string_view key, Check check) {
  for (auto at = text.find(key); at != std::string_view::npos; at = text.find(key, at + key.size()))
    check(number_at(text, at + key.size()));
}

bool matches(std::string_view text, std::size_t at, std::string_view upper_case) {
  if (text.size() - at < upper_case.size()) return false;
  return std::equal(upper_case.begin(), upper_case.end(), text.begin() + static_cast<std::ptrdiff_t>(at),
                    [](char wanted, char c) { return wanted == std::toupper(static_cast<unsigned char>(c)); });
}

/// Where the words behind a keyword of a legacy file begin, where it first begins a line; npos: nowhere.
std::size_t behind_keyword(std::string_view text, std::string_view keyword) {
  for (auto end = text.find('\n'); end != std::string_view::npos; end = text.find('\n', end + 1)) {
    const auto start = std::min(text.find_first_not_of(" \t", end + 1), text.size());
    const auto next = start + keyword.size();
    if (matches(text, start, keyword) && next < text.size() && std::isspace(static_cast<unsigned char>(text[next])))
      return next;
  }
  return std::string_view::npos;
}

/// The whole numbers of a legacy file, one after the other: text, or four bytes each, the highest first.
struct Numbers {
  std::string_view text;
  std::size_t at;
  bool is_binary;

  /// -1: there are no more.
  std::int64_t next() {
    constexpr std::size_t width = 4;
    if (is_binary) {
      if (at + width > text.size()) return -1;
      std::uint32_t number = 0;
      for (std::size_t b = 0; b < width; ++b) number = number << 8 | static_cast<unsigned char>(text[at + b]);
      at += width;
      return static_cast<std::int32_t>(number);
    }
    while (at < text.size() && std::isspace(static_cast<unsigned char>(text[at])) != 0) ++at;
    std::int64_t number = -1;
    const auto [end, error] = std::from_chars(text.data() + at, text.data() + text.size(), number);
    at = static_cast<std::size_t>(end - text.data());
    return error == std::errc() ? number : -1;
  }
  void skip(std::int64_t count) {
    if (is_binary)
      at += 4 * static_cast<std::size_t>(count);
    else
      for (; count > 0; --count) next();
  }
};

[[noreturn]] void refuse_cells(const File& file, const std::string& what) {
  throw UserError("is damaged: " + what, file.path.string(), "is the file complete and undamaged?");
}

/// Before version 5: "CELLS 2 10", then the number of nodes and the nodes of every cell, 10 numbers in all, which the
/// library believes, and as many types.
void check_legacy_cells(const File& file, std::uint64_t types) {
  const std::string_view text = file.bytes;
  const auto at = behind_keyword(text, "CELLS");
  const auto line_end = at == std::string_view::npos ? at : text.find('\n', at);
  if (line_end == std::string_view::npos) return;
  Numbers header{text, at, false};
  const std::int64_t cells = header.next(), size = header.next();
  if (cells < 0 || size < cells || static_cast<std::uint64_t>(cells) != types)
    refuse_cells(file, fmt::format("{} cells of {} numbers have {} types", cells, size, types));
  const auto is_binary = behind_keyword(text.substr(0, at), "BINARY") != std::string_view::npos;
  Numbers numbers{text, line_end + 1, is_binary};
  std::int64_t left = size;
  for (std::int64_t cell = 0; cell < cells; ++cell) {
    const auto nodes = numbers.next();
    if (nodes < 0 || nodes >= left)
      refuse_cells(file, fmt::format("its cells do not fit the {} numbers behind CELLS", size));
    numbers.skip(nodes);
    left -= nodes + 1;
  }
  if (left != 0) refuse_cells(file, fmt::format("its cells do not fill the {} numbers behind CELLS", size));
}

/// "POINTS 8 double" and its like, each where it first begins a line. Values take a byte at least.
void check_legacy(const File& file) {
  constexpr std::string_view version_at = "# vtk DataFile Version ";
  const std::string_view text = file.bytes;
  std::uint64_t types = 0;
  for (const std::string_view keyword : {"POINTS", "CELLS", "CELL_TYPES", "POINT_DATA", "CELL_DATA"}) {
    const auto at = behind_keyword(text, keyword);
    if (at == std::string_view::npos) continue;
    const auto count = number_at(text, at);
    require(file, count, text.size(), keyword);
    if (keyword == "CELL_TYPES") types = count;
  }
  if (number_at(text, version_at.size()) < 5) check_legacy_cells(file, types);
}

std::uint64_t word_at(std::string_view bytes, std::size_t at, std::size_t width) {
  std::uint64_t value = 0;
  if (at + width > bytes.size()) return UINT64_MAX;
  std::memcpy(&value, bytes.data() + at, width);  // little-endian, as this machine
  return value;
}

/// The table before an array: number of blocks, bytes of a block, bytes of the last one, then the compressed bytes of
/// every block; or one number of bytes.
void check_block_table(const File& file, std::size_t at, std::size_t width, bool compressed) {
  const std::uint64_t rest = at < file.bytes.size() ? file.bytes.size() - at : 0;
  const std::uint64_t first = word_at(file.bytes, at, width);
  require(file, first, compressed ? rest / width : rest, compressed ? "blocks" : "bytes in an array");
  if (!compressed || first == 0) return;
  for (const std::size_t word : {1, 2})
    require(file, word_at(file.bytes, at + word * width, width), rest * largest_compression + nominal_block,
            "bytes in a block");
  if (word_at(file.bytes, at + width, width) == 0)
    throw UserError("has compressed arrays with blocks of 0 bytes", file.path.string(),
                    "is it undamaged, and does header_type say how wide the numbers before an array are?");
  for (std::uint64_t block = 0; block < first; ++block)
    require(file, word_at(file.bytes, at + (3 + block) * width, width), rest, "bytes in a compressed block");
}

void check_appended(const File& file, std::string_view header, std::size_t data_begin) {
  const bool compressed = header.find("compressor=") != std::string_view::npos;
  const std::size_t width = header.find("header_type=\"UInt64\"") != std::string_view::npos ? 8 : 4;
  for_each_number(header, " offset=\"", [&](std::uint64_t offset) {
    require(file, offset, file.bytes.size() - data_begin, "bytes before an array");
    check_block_table(file, data_begin + static_cast<std::size_t>(offset), width, compressed);
  });
}

void check_xml(const File& file) {
  const std::string_view text = file.bytes;
  const auto appended = text.find("<AppendedData");
  const std::string_view header = text.substr(0, appended);
  const std::uint64_t most = text.size() * largest_compression;
  for (const std::string_view key : {"NumberOfPoints", "NumberOfCells", "NumberOfPolys", "NumberOfTuples",
                                     "NumberOfVerts", "NumberOfLines", "NumberOfStrips"})
    for_each_number(header, std::string(key) + "=\"", [&](std::uint64_t count) { require(file, count, most, key); });
  for_each_number(header, "NumberOfComponents=\"",
                  [&](std::uint64_t count) { require(file, count, max_components, "NumberOfComponents"); });
  if (appended == std::string_view::npos) return;
  const auto data = text.find('_', appended);
  const bool raw = text.substr(appended, 64).find("\"raw\"") != std::string_view::npos;
  if (raw && data != std::string_view::npos && header.find("\"LittleEndian\"") != std::string_view::npos)
    check_appended(file, header, data + 1);
}

}  // namespace

void refuse_absurd_counts(const std::filesystem::path& path) {
  File file{path, std::string(static_cast<std::size_t>(std::filesystem::file_size(path)), '\0')};
  std::ifstream stream(path, std::ios::binary);
  stream.read(file.bytes.data(), static_cast<std::streamsize>(file.bytes.size()));
  file.bytes.resize(static_cast<std::size_t>(stream.gcount()));
  if (file.bytes.starts_with("# vtk DataFile"))
    check_legacy(file);
  else if (file.bytes.find("<VTKFile") < 256)
    check_xml(file);
}

}  // namespace heartgen::adapters
