// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The broken circle of thesis Fig 4.6, and what each deformable contour makes of it: which ones close its gaps.
#pragma once
#include <string>
#include <vector>

#include "model/volume.hpp"

namespace heartgen::lab {

/// A dark ring on a white ground, in pixels of 1 mm, without some of its arcs.
struct BrokenCircle {
  int size = 100;         ///< pixels along both sides
  double radius_mm = 30;  ///< of the ring's middle line, around the centre of the image
  double width_mm = 3;    ///< of the ring
  double gap_deg = 30;    ///< of each gap
  int gaps = 4;           ///< evenly spread, the first in the direction of +j (down the picture)
  double noise = 0;       ///< standard deviation of the noise; grey values run from 0 (ring) to 255
};

Volume<float> draw(const BrokenCircle& circle);

struct Closing {
  std::string method;     ///< "snake_from_outside", ...
  std::string end;        ///< how the evolution ended
  bool closed = false;    ///< one piece, nowhere farther than `closed_within_mm` from the whole circle
  double inward_mm = 0;   ///< largest distance of the contour from the circle, to the inside
  double outward_mm = 0;  ///< and to the outside
  int iterations = 0;
  std::string why;  ///< what closed the gaps, or why they stayed open
  Mask inside;
  Volume<float> surface;  ///< subjective surfaces only: φ
};

/// A contour within this distance of the circle has closed it: less than half of the chord of a gap.
double closed_within_mm(const BrokenCircle& circle);

/// Snakes, geometric and geodesic contours and the subjective surface, each from where it has to start. Deterministic,
/// not collective.
std::vector<Closing> close_broken_circle(const BrokenCircle& circle);

}  // namespace heartgen::lab
