// Images whose scanner measured a disc or a box only, with one value put around it. Lungs that the field of view cuts
// open into that value as into the air around a body. A thin wall around what was measured closes them.
#pragma once
#include <cstdint>
#include <vector>

#include "model/volume.hpp"

namespace heart::segment {

/// Columns of voxels along an axis that hold nothing but one value, in all slices that are not empty.
struct Padding {
  std::int16_t value_hu = 0;
  std::size_t axis = 2;
  std::int64_t width = 0;               ///< columns of one row of the plane across the axis
  std::vector<std::uint8_t> is_padded;  ///< per column; empty where there is no padding
  std::vector<std::int64_t> wall;       ///< the columns next to what was measured

  bool is_there() const { return !is_padded.empty(); }
  std::int64_t column_of(const Index3& at) const { return at[axis == 0 ? 1 : 0] + width * at[axis == 2 ? 1 : 2]; }
  bool covers(const Index3& at) const { return is_there() && is_padded[static_cast<std::size_t>(column_of(at))] != 0; }
};

/// Padding of at most -500 HU into which lungs open; none where there is nothing to mistake for air around the body.
Padding find_padding(const CtVolume& ct);

/// Puts fat into the wall, 6 mm thick.
void close_padding(CtVolume& ct, const Padding& padding);

/// Takes that back, and the labels that lie there.
void reopen_padding(CtVolume& ct, const Padding& padding);
void clear_padding(LabelVolume& labels, const Padding& padding);

}  // namespace heart::segment
