// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A buffered file for export formats. Numbers are written by fmt: shortest text that reads back to the same double,
/// whatever the locale.
#pragma once
#include <fmt/compile.h>
#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>

#include "model/error.hpp"
#include "model/new_file.hpp"

namespace heartgen::exporters {

class OutFile {
 public:
  /// Makes the folder that the file is in. Throws UserError when it cannot.
  explicit OutFile(const std::filesystem::path& path) : file_(path), stream_(file_.partial, std::ios::binary) {}

  /// `format` is an FMT_COMPILE("...") literal.
  template <class Format, class... Args>
  void print(const Format& format, const Args&... args) {
    fmt::format_to(std::back_inserter(buffer_), format, args...);
    if (buffer_.size() > block_bytes) flush();
  }

  /// The bytes as they lie in memory.
  template <class T>
  void raw(std::span<const T> values) {
    const auto bytes = std::as_bytes(values);
    const auto* data = reinterpret_cast<const char*>(bytes.data());
    buffer_.append(data, data + bytes.size());
    if (buffer_.size() > block_bytes) flush();
  }
  template <class T>
  void raw(const T& value) {
    raw(std::span<const T>(&value, 1));
  }

  /// One number with its most significant byte first, as legacy VTK wants it.
  template <class T>
  void big_endian(T value) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    if constexpr (std::endian::native == std::endian::little)
      for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(bytes[i], bytes[sizeof(T) - 1 - i]);
    raw(std::span<const char>(bytes));
  }

  /// Must be called; throws UserError when anything could not be written. Returns the path.
  std::filesystem::path close() {
    flush();
    stream_.close();
    if (!stream_)
      throw UserError("cannot be written", file_.path.string(), "is there room, and the right to write there?");
    file_.finish();
    return file_.path;
  }

 private:
  static constexpr std::size_t block_bytes = 1 << 20;
  void flush() {
    stream_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    buffer_.clear();
  }
  NewFile file_;
  std::ofstream stream_;
  fmt::memory_buffer buffer_;
};

}  // namespace heartgen::exporters
