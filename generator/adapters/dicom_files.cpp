// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/adapters/dicom_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <string_view>

#include "model/error.hpp"
#include "model/input_file.hpp"

namespace heartgen::adapters {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t mark_at = 128, first_element_at = 132;
constexpr std::string_view mark = "DICM";
constexpr std::uint32_t undefined = 0xffffffff;
constexpr std::uint32_t item = 0xfffee000, end_of_item = 0xfffee00d, end_of_sequence = 0xfffee0dd;
constexpr std::uint32_t pixel_data = 0x7fe00010;

/// How elements are written: parts 5 and 6 of the DICOM standard, "transfer syntaxes".
struct Syntax {
  bool is_explicit = true;  ///< a kind of two letters stands before the length
  bool is_big_endian = false;
};

struct Element {
  std::uint32_t tag = 0;  ///< group and number
  std::uint32_t length = 0;
  std::size_t value_at = 0;
  bool is_unknown = false;  ///< of the kind UN, whose contents are written without kinds
};

struct File {
  fs::path path;
  std::string bytes;
};

std::uint32_t number_at(const File& file, std::size_t at, std::size_t width, bool is_big_endian) {
  std::uint32_t number = 0;
  for (std::size_t b = 0; b < width; ++b) {
    const auto byte = static_cast<unsigned char>(file.bytes[at + (is_big_endian ? b : width - 1 - b)]);
    number = number << 8 | byte;
  }
  return number;
}

[[noreturn]] void refuse_cut(const File& file, std::uint32_t tag, std::uintmax_t wanted, std::uintmax_t there) {
  throw UserError(fmt::format("is truncated or damaged: element ({:04x},{:04x}) of {} bytes has {}", tag >> 16,
                              tag & 0xffff, wanted, there),
                  file.path.string(), "export it again, or take it out of the folder");
}

void require(const File& file, std::uint32_t tag, std::size_t at, std::uintmax_t wanted) {
  const std::uintmax_t there = file.bytes.size() - std::min(at, file.bytes.size());
  if (wanted > there) refuse_cut(file, tag, wanted, there);
}

bool has_long_length(std::string_view kind) {
  constexpr std::array<std::string_view, 13> kinds{"OB", "OD", "OF", "OL", "OV", "OW", "SQ",
                                                   "SV", "UC", "UN", "UR", "UT", "UV"};
  return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
}

Element element_at(const File& file, std::size_t at, const Syntax& syntax) {
  constexpr std::size_t short_header = 8, long_header = 12;
  require(file, 0, at, short_header);
  const auto number = [&](std::size_t from, std::size_t width) {
    return number_at(file, from, width, syntax.is_big_endian);
  };
  Element element;
  element.tag = number(at, 2) << 16 | number(at + 2, 2);
  element.value_at = at + short_header;
  if (!syntax.is_explicit || element.tag >> 16 == item >> 16) {
    element.length = number(at + 4, 4);
    return element;
  }
  const auto kind = std::string_view(file.bytes).substr(at + 4, 2);
  element.is_unknown = kind == "UN";
  element.length = number(at + 6, 2);
  if (!has_long_length(kind)) return element;
  require(file, element.tag, at, long_header);
  element.length = number(at + 8, 4);
  element.value_at = at + long_header;
  return element;
}

std::string text_of(const File& file, const Element& element) {
  std::string text = file.bytes.substr(element.value_at, element.length);
  std::erase_if(text, [](char c) { return c == '\0' || c == ' '; });
  return text;
}

/// What the walk looks for among the elements that lie in no sequence.
struct Found {
  std::int64_t rows = 0, columns = 0, frames = 1, samples = 1, bits = 0;
  bool has_plain_pixels = false;
  std::uintmax_t pixel_bytes = 0;
};

void note(const File& file, const Element& element, const Syntax& syntax, Found& found) {
  const auto number = [&] {
    return element.length < 2 ? 0 : std::int64_t{number_at(file, element.value_at, 2, syntax.is_big_endian)};
  };
  if (element.tag == 0x00280002) found.samples = number();
  if (element.tag == 0x00280010) found.rows = number();
  if (element.tag == 0x00280011) found.columns = number();
  if (element.tag == 0x00280100) found.bits = number();
  if (element.tag == 0x00280008) {
    const auto text = text_of(file, element);
    std::from_chars(text.data(), text.data() + text.size(), found.frames);
    found.frames = std::clamp<std::int64_t>(found.frames, 1, INT32_MAX);
  }
  if (element.tag == pixel_data) {
    found.has_plain_pixels = true;
    found.pixel_bytes = element.length;
  }
}

/// Sequences of undefined length are walked into, those of a length are stepped over.
Found walk(const File& file, std::size_t at, Syntax syntax) {
  constexpr std::size_t deepest = 64, shortest_element = 8;
  const Syntax outside = syntax;
  Found found;
  std::size_t depth = 0, unknown_from = 0;  // the depth at which an unknown sequence began
  while (at < file.bytes.size()) {
    if (depth == 0 && found.has_plain_pixels && file.bytes.size() - at < shortest_element) break;  // filling
    const Element element = element_at(file, at, syntax);
    at = element.value_at;
    const bool leaves = element.tag == end_of_item || element.tag == end_of_sequence;
    if (leaves && depth > 0 && --depth < unknown_from) {
      syntax = outside;
      unknown_from = 0;
    }
    if (leaves) continue;
    if (element.length == undefined) {
      if (++depth > deepest)
        throw UserError(fmt::format("is damaged: sequences within sequences, {} deep", depth), file.path.string(),
                        "export it again, or take it out of the folder");
      if (element.is_unknown && unknown_from == 0) {
        syntax = {false, false};
        unknown_from = depth;
      }
      continue;
    }
    require(file, element.tag, at, element.length);
    if (depth == 0) note(file, element, syntax, found);
    at += element.length;
  }
  return found;
}

/// Whether elements can be followed at all; not in a file that is compressed as a whole, or of a maker's own syntax.
bool can_be_followed(const std::string& syntax) {
  return syntax.starts_with("1.2.840.10008.1.2") && syntax != "1.2.840.10008.1.2.1.99";
}

DicomFile followed(const File& file) {
  DicomFile result{file.path, file.bytes.size(), true, {}, 0, 0, 1};
  std::size_t at = first_element_at;
  std::string syntax;
  while (at < file.bytes.size() && number_at(file, at, std::min<std::size_t>(2, file.bytes.size() - at), false) == 2) {
    const Element element = element_at(file, at, {});
    require(file, element.tag, element.value_at, element.length);
    if (element.tag == 0x00020002) result.sop_class = text_of(file, element);
    if (element.tag == 0x00020010) syntax = text_of(file, element);
    at = element.value_at + element.length;
  }
  if (at >= file.bytes.size()) refuse_cut(file, 0, 1, 0);
  if (!can_be_followed(syntax)) return result;
  const Found found = walk(file, at, {syntax != "1.2.840.10008.1.2", syntax == "1.2.840.10008.1.2.2"});
  result.rows = found.rows;
  result.columns = found.columns;
  result.frames = found.frames;
  const auto wanted = static_cast<std::uintmax_t>(found.rows * found.columns * found.samples * found.bits / 8) *
                      static_cast<std::uintmax_t>(found.frames);
  if (found.has_plain_pixels && wanted > found.pixel_bytes) refuse_cut(file, pixel_data, wanted, found.pixel_bytes);
  return result;
}

/// Somebody's note, by its first bytes; nothing is no text.
bool is_text(const std::string& start) {
  return !start.empty() && std::none_of(start.begin(), start.end(), [](char c) {
    return (static_cast<unsigned char>(c) < ' ' && c != '\n' && c != '\r' && c != '\t') || c == '\x7f';
  });
}

bool has_slice_ending(const fs::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending == ".dcm" || ending == ".dicom" || ending == ".ima";
}

std::string bytes_of(const fs::path& path, std::uintmax_t most) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream.is_open())
    throw UserError("cannot be opened", path.string(), "give the right to read it, or take it out of the folder");
  std::string bytes(static_cast<std::size_t>(std::min(most, fs::file_size(path))), '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

/// Nothing for what is no slice by its contents and by its name.
std::vector<DicomFile> looked_at(const fs::path& path) {
  constexpr std::uintmax_t start_bytes = 512;
  const std::string start = bytes_of(path, start_bytes);
  if (start.size() >= first_element_at && start.compare(mark_at, mark.size(), mark) == 0)
    return {followed({path, bytes_of(path, UINTMAX_MAX)})};
  if (is_text(start) && !has_slice_ending(path)) return {};
  return {{path, start.size(), false, {}, 0, 0, 1}};
}

}  // namespace

bool is_dicom_file(const std::string& path) {
  std::string start(mark.size(), ' ');
  std::ifstream file(path, std::ios::binary);
  return file.seekg(mark_at).read(start.data(), static_cast<std::streamsize>(mark.size())) && start == mark;
}

std::vector<DicomFile> dicom_files(const std::string& folder) {
  const std::array<std::string, 3> no_slices{"DICOMDIR", "Thumbs.db", "desktop.ini"};
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const bool is_known = std::find(no_slices.begin(), no_slices.end(), name) != no_slices.end();
    if (entry.is_other()) require_input_file(entry.path());               // a pipe would be waited for
    const bool may_be_read = entry.is_regular_file() || !entry.exists();  // a link to nothing is a file that is lost
    if (may_be_read && !name.starts_with('.') && !is_known) paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  std::vector<DicomFile> files;
  for (const auto& path : paths)
    for (auto& file : looked_at(path)) files.push_back(std::move(file));
  return files;
}

}  // namespace heartgen::adapters
