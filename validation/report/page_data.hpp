// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Arrays inside an HTML page: little-endian bytes, deflated (zlib), as base64.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace heartgen::report {

/// Arrays one after the other, each from a multiple of four bytes.
struct Blob {
  std::vector<std::uint8_t> bytes;

  /// Where the next array begins.
  std::size_t start() {
    while (bytes.size() % 4) bytes.push_back(0);
    return bytes.size();
  }
  void append(std::uint64_t value, int width) {
    for (int b = 0; b < width; ++b) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * b)));
  }
};

std::vector<std::uint8_t> deflated(const std::vector<std::uint8_t>& bytes);
std::string deflated_base64(const std::vector<std::uint8_t>& bytes);

}  // namespace heartgen::report
