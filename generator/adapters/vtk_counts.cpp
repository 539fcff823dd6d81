#include "generator/adapters/vtk_counts.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>

#include "model/error.hpp"

namespace heart::adapters {
namespace {

constexpr std::uint64_t largest_compression = 1032;
constexpr std::uint64_t nominal_block = 1U << 26;  // writers announce their usual block size, however short the array
constexpr std::uint64_t most_components = 4096;

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

/// "POINTS 8 double" and its like, each where it first begins a line. Values take a byte at least.
void check_legacy(const File& file) {
  const std::string_view text = file.bytes;
  for (const std::string_view key : {"\nPOINTS ", "\nCELLS ", "\nCELL_TYPES ", "\nPOINT_DATA ", "\nCELL_DATA "}) {
    const auto at = text.find(key);
    if (at != std::string_view::npos)
      require(file, number_at(text, at + key.size()), text.size(), key.substr(1, key.size() - 2));
  }
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
                  [&](std::uint64_t count) { require(file, count, most_components, "NumberOfComponents"); });
  if (appended == std::string_view::npos) return;
  const auto data = text.find('_', appended);
  const bool raw = text.substr(appended, 64).find("\"raw\"") != std::string_view::npos;
  if (raw && data != std::string_view::npos && header.find("\"LittleEndian\"") != std::string_view::npos)
    check_appended(file, header, data + 1);
}

}  // namespace

void refuse_absurd_counts(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream contents;
  contents << stream.rdbuf();
  const File file{path, std::move(contents).str()};
  if (file.bytes.starts_with("# vtk DataFile"))
    check_legacy(file);
  else if (file.bytes.find("<VTKFile") < 256)
    check_xml(file);
}

}  // namespace heart::adapters
