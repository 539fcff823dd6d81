// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/text.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <fstream>
#include <numeric>

#include "model/error.hpp"
#include "model/new_file.hpp"

namespace heartgen {
namespace {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
    }
  }
  return row.back();
}

/// A candidate that holds the whole word ("edge_mm", "heart_edge_mm") was meant more likely than one with as few
/// letters.
std::size_t distance_to_candidate(std::string_view word, std::string_view candidate) {
  return candidate.find(word) != candidate.npos ? 1 : edit_distance(word, candidate);
}

}  // namespace

std::string nearest_name(std::string_view word, const std::vector<std::string>& candidates) {
  if (candidates.empty()) return "";
  return *std::min_element(candidates.begin(), candidates.end(), [&](const auto& a, const auto& b) {
    return distance_to_candidate(word, a) < distance_to_candidate(word, b);
  });
}

std::string number_text(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

double parse_number(std::string_view text, const std::string& where) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size())
    throw UserError(fmt::format("\"{}\" is not a number", text), where, "write a number such as 0.5");
  return value;
}

namespace {

void refuse_output(const std::filesystem::path& path, const std::error_code& error) {
  if (error) throw UserError("cannot be written: " + error.message(), path.string(), "name another file");
}

// By trying: some file systems, read-only ones among them, promise rights that they do not give.
std::error_code try_to_write_in(const std::filesystem::path& folder) {
  std::string probe = (folder / ".heartgen-XXXXXX").string();
  if (mkdtemp(probe.data()) == nullptr || rmdir(probe.c_str()) != 0) return {errno, std::generic_category()};
  return {};
}

}  // namespace

void check_output(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  if (path.empty() || fs::is_directory(path)) refuse_output(path, std::make_error_code(std::errc::is_a_directory));
  fs::path there = path;  // the first that exists, going up
  while (!there.empty() && !fs::exists(there)) there = there.parent_path();
  if (there.empty()) there = ".";
  if (there != path && !fs::is_directory(there)) refuse_output(path, std::make_error_code(std::errc::not_a_directory));
  if (fs::is_directory(there)) return refuse_output(path, try_to_write_in(there));
  if (access(there.c_str(), W_OK) != 0) refuse_output(path, {errno, std::generic_category()});
}

bool lies_in(const std::filesystem::path& path, const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  std::error_code error;
  const auto whole = [&](const fs::path& p) {
    const auto absolute = fs::weakly_canonical(fs::absolute(p, error), error);
    return absolute.filename().empty() ? absolute.parent_path() : absolute;
  };
  const auto inner = whole(path), outer = whole(folder);
  return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

void make_folder_of(const std::filesystem::path& path) {
  std::error_code error;
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), error);
  refuse_output(path, error);
}

void write_text(const std::filesystem::path& path, std::string_view text) {
  NewFile whole(path);
  std::ofstream file(whole.partial, std::ios::binary);
  file.write(text.data(), static_cast<std::streamsize>(text.size()));
  file.close();
  if (!file) throw UserError("cannot be written", path.string(), "is there room, and the right to write there?");
  whole.finish();
}

}  // namespace heartgen
