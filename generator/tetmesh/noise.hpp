// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Numbers that look random and are the same everywhere.
#pragma once
#include <cstdint>

namespace heartgen::tetmesh {

struct Noise {
  std::uint32_t state = 1;
  /// In [-1, 1).
  double next() {
    state = state * 1664525U + 1013904223U;
    return static_cast<double>(state >> 8) / 8388608.0 - 1.0;
  }
};

}  // namespace heartgen::tetmesh
