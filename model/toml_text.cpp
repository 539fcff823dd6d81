// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/toml_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>

#include "model/error.hpp"

namespace heartgen {
namespace {

constexpr std::size_t max_bytes = 4U << 20, max_parts = 16, deepest = 64;

/// Behind the string that begins at `at`: '...', "...", or three of these marks on either side.
std::size_t behind_string(std::string_view text, std::size_t at) {
  const char mark = text[at];
  const std::string three(3, mark);
  const std::string end = text.substr(at, 3) == three ? three : std::string(1, mark);
  for (at += end.size(); at < text.size(); ++at) {
    if (text.substr(at, end.size()) == end) return at + end.size();
    if (end.size() == 1 && text[at] == '\n') return at;
    if (mark == '"' && text[at] == '\\') ++at;
  }
  return at;
}

/// Counts what the parser would nest; a bracket that closes nothing is its business.
void check_nesting(std::string_view text, const std::string& path) {
  std::size_t line = 1, depth = 0, parts = 1;
  const auto refuse = [&](const char* what) {
    throw UserError(fmt::format("not valid TOML: {}", what), fmt::format("{}:{}", path, line), "correct the recipe");
  };
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    if (c == '\n') ++line;
    if (c == '"' || c == '\'') {
      const auto end = behind_string(text, at);
      line += static_cast<std::size_t>(std::count(text.begin() + static_cast<std::ptrdiff_t>(at),
                                                  text.begin() + static_cast<std::ptrdiff_t>(end), '\n'));
      at = end;
      continue;
    }
    if (c == '#') {
      at = std::min(text.find('\n', at), text.size());
      continue;
    }
    if (c == '[' || c == '{') ++depth;
    if ((c == ']' || c == '}') && depth > 0) --depth;
    if (c == '.')
      ++parts;
    else if (std::string_view("[]{}=,\n").find(c) != std::string_view::npos)
      parts = 1;
    if (depth > deepest) refuse("values lie within values too often");
    if (parts > max_parts) refuse("a key has too many parts");
    ++at;
  }
}

}  // namespace

std::string checked_toml(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file.is_open()) throw UserError("no right to read it", path, "ask its owner for the right");
  if (std::filesystem::file_size(path) > max_bytes)
    throw UserError("is too large for a recipe", path, "name a recipe, which is a short text");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  check_nesting(text, path);
  return text;
}

}  // namespace heartgen
