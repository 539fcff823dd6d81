// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// How a FillTask and a FillAnswer stand in a file: the exchange's name and version, then the members in their order.
/// Both programs come out of one tree; an answer of another version is refused.
#pragma once
#include <cstdio>
#include <stdexcept>
#include <string>

#include "generator/adapters/tetgen_mesher.hpp"
#include "model/archive.hpp"

namespace heartgen::adapters {

inline const std::string exchange_name = "heartgen-tetgen exchange 1";

struct FileSink : Packing<FileSink> {
  std::FILE* file;
  explicit FileSink(std::FILE* file_) : file(file_) {}
  void raw(const void* data, std::size_t size) {
    if (size > 0 && std::fwrite(data, 1, size, file) != size) throw std::runtime_error("disk is full");
  }
};

/// Believes no count that the rest of the file cannot hold.
struct FileSource : Unpacking<FileSource> {
  std::FILE* file;
  std::size_t left = 0;
  explicit FileSource(std::FILE* file_) : file(file_) {
    std::fseek(file, 0, SEEK_END);
    if (const long end = std::ftell(file); end > 0) left = static_cast<std::size_t>(end);
    std::rewind(file);
  }
  void require(std::size_t size) const {
    if (size > left) throw std::runtime_error("is cut off");
  }
  void raw(void* data, std::size_t size) {
    require(size);
    if (size > 0 && std::fread(data, 1, size, file) != size) throw std::runtime_error("is cut off");
    left -= size;
  }
};

/// Throws std::runtime_error where the disk is full.
template <class T>
void write_exchange(std::FILE* file, const T& value) {
  FileSink sink(file);
  sink.put(exchange_name);
  sink.put(value);
  if (std::fflush(file) != 0) throw std::runtime_error("disk is full");
}

/// Throws std::runtime_error for what write_exchange has not written.
template <class T>
T read_exchange(std::FILE* file) {
  FileSource source(file);
  std::string name;
  source.get(name);
  if (name != exchange_name) throw std::runtime_error("is of another version");
  T value;
  source.get(value);
  return value;
}

}  // namespace heartgen::adapters
