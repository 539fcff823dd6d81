// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A slice as a canvas to draw on, with the way from space to its pixels: what slice_picture encodes.
#pragma once
#include "validation/report/canvas.hpp"
#include "validation/report/pictures.hpp"

namespace heartgen::report {

struct SliceCanvas {
  Canvas canvas;
  Vec3 corner_mm, right, down;  ///< LPS of the first pixel's centre, and unit directions of the picture
  double pixel_mm = 1;

  /// Where a point is seen, along the slice's normal.
  Point2 at(const Vec3& lps_mm) const {
    const Vec3 off = (1 / pixel_mm) * (lps_mm - corner_mm);
    return {dot(off, right) + 0.5, dot(off, down) + 0.5};
  }
  /// Distance from the slice, mm, on either side.
  double off_mm(const Vec3& lps_mm) const { return dot(lps_mm - corner_mm, cross(right, down)); }
};

/// Arguments and errors as slice_picture.
SliceCanvas slice_canvas(const CtVolume* ct, const LabelVolume* labels, SlicePlane plane, std::int64_t index,
                         const SliceOptions& options = {});

}  // namespace heartgen::report
