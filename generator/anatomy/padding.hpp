// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Images whose scanner measured a disc or a box only, with one value put around it. Lungs that the field of view cuts
/// open into that value as into the air around a body. A wall of fat around what was measured closes them.
#pragma once
#include <cstdint>
#include <vector>

#include "model/volume.hpp"

namespace heartgen::anatomy {

/// Along an axis of the image: slices that hold nothing but one value, and columns of voxels that hold nothing else in
/// the other slices.
struct Padding {
  std::int16_t value_hu = 0;
  std::size_t axis = 2;
  std::int64_t width = 0;               ///< columns of one row of the plane across the axis
  std::vector<std::uint8_t> is_column;  ///< per column: 1 where it is padding. Empty: there is no padding at all
  std::vector<std::uint8_t> is_slice;   ///< per slice, likewise
  std::vector<std::int64_t> wall;       ///< columns of the padding next to what was measured
  std::vector<std::int64_t> lids;       ///< slices of it, likewise

  bool is_there() const { return !is_column.empty(); }
  std::int64_t column_of(const Index3& at) const { return at[axis == 0 ? 1 : 0] + width * at[axis == 2 ? 1 : 2]; }
  bool covers(const Index3& at) const {
    return is_there() && (is_slice[static_cast<std::size_t>(at[axis])] != 0 ||
                          is_column[static_cast<std::size_t>(column_of(at))] != 0);
  }
};

/// Padding of at most -500 HU into which lungs open; none where there is nothing to mistake for air around the body.
Padding find_padding(const CtVolume& ct);

/// Puts fat into the wall and the lids, 12 mm thick, and air where it is darker than that (scanners write -2048,
/// -3024).
void close_padding(CtVolume& ct, const Padding& padding);

/// Takes the wall and the lids out again, and the labels of all padding.
void reopen_padding(CtVolume& ct, const Padding& padding);
void clear_padding(LabelVolume& labels, const Padding& padding);

}  // namespace heartgen::anatomy
