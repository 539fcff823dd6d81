// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Values one after another in a file: numbers as text, separated by blanks and line ends of any kind, or as they lie
/// in memory. What a file claims to hold is checked against what is left of it before memory is asked for.
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

#include "model/error.hpp"
#include "model/vec.hpp"

namespace heartgen::mesh_files {

/// The file's bytes. Throws UserError where it cannot be read.
std::string whole_file(const std::filesystem::path& path);

enum class Kind { text, binary, swapped };  ///< swapped: binary, of a machine with the other order of bytes

struct Values {
  std::string_view rest;
  const std::filesystem::path* path;
  const char* remedy;  ///< of every error
  Kind kind = Kind::text;
  bool has_comments = false;  ///< from '#' to the end of the line

  [[noreturn]] void fail(const std::string& problem) const { throw UserError(problem, path->string(), remedy); }
  [[noreturn]] void fail_here() const {
    fail(kind == Kind::text ? "ends too early, or has letters where a number belongs" : "ends too early");
  }

  static constexpr std::string_view blanks = " \t\r\n\v\f";
  void skip_blanks() {
    for (;;) {
      rest.remove_prefix(std::min(rest.find_first_not_of(blanks), rest.size()));
      if (!has_comments || !rest.starts_with('#')) return;
      line();
    }
  }
  bool is_at_end() {
    skip_blanks();
    return rest.empty();
  }
  std::string_view word() {
    skip_blanks();
    const auto found = rest.substr(0, rest.find_first_of(blanks));
    rest.remove_prefix(found.size());
    return found;
  }
  /// Up to the end of the line, without blanks around it.
  std::string_view line() {
    auto found = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(found.size() + 1, rest.size()));
    found.remove_prefix(std::min(found.find_first_not_of(blanks), found.size()));
    return found.substr(0, found.find_last_not_of(blanks) + 1);
  }
  /// The next line that holds more than blanks and comments, as values of its own.
  Values filled_line() {
    skip_blanks();
    if (rest.empty()) fail_here();
    auto found = line();
    if (has_comments) found = found.substr(0, found.find('#'));
    return {found, path, remedy, Kind::text, has_comments};
  }

  template <class T>
  T next_of_text() {
    auto text = word();
    if (text.starts_with('+')) text.remove_prefix(1);
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) fail_here();
    return value;
  }
  /// T is the type that binary files have there.
  template <class T>
  T next() {
    if (kind == Kind::text) return next_of_text<T>();
    if (rest.size() < sizeof(T)) fail_here();
    std::array<char, sizeof(T)> bytes;
    std::copy_n(rest.begin(), sizeof(T), bytes.begin());
    rest.remove_prefix(sizeof(T));
    if (kind == Kind::swapped) std::reverse(bytes.begin(), bytes.end());
    T value{};
    std::memcpy(&value, bytes.data(), sizeof(T));
    return value;
  }
  template <class T>
  void skip(std::size_t count) {
    for (; count > 0; --count) next<T>();
  }
  template <class T = double>
  Vec3 vector() {
    const auto x = next<T>(), y = next<T>(), z = next<T>();
    return {static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
  }
  Vec3 point() {
    const Vec3 p = vector();
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) fail("a coordinate is not finite");
    return p;
  }

  /// Everything that is counted takes a byte or more.
  std::size_t checked(std::int64_t value) const {
    if (value < 0) fail(fmt::format("{} is no count", value));
    if (static_cast<std::size_t>(value) > rest.size()) fail_here();
    return static_cast<std::size_t>(value);
  }
  template <class T = std::int64_t>
  std::size_t count() {
    return checked(next<T>());
  }
  std::size_t count_of_text() { return checked(next_of_text<std::int64_t>()); }
  /// A line's text before binary values: they begin behind its end.
  std::size_t count_on_a_line() {
    const auto value = count_of_text();
    line();
    return value;
  }
};

}  // namespace heartgen::mesh_files
