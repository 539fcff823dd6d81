// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Images of our own on which the thesis's comparisons are repeated. The same bits everywhere, any size.
#pragma once
#include "benchmarks/study/field.hpp"

namespace heartgen::study {

/// A man with a camera on a tripod before a skyline: a large dark figure, parts of one or two pixels, a sky with a
/// gradient and clouds, textured grass, faint buildings, noise. Grey values 0 to 255. Stands in for the thesis's
/// "cameraman", which is not free.
Field photographer(int size = 256);

/// Bright shapes (1) on a dark ground (0): a disc, a ring, a square, a triangle, a cross and a thin bar. Each pixel is
/// replaced by 0 or 1, by the toss of a coin, with the given probability (salt and pepper).
struct NoisyShapes {
  Field image;
  PixelLabels truth;
};
NoisyShapes noisy_shapes(int size = 256, double probability = 0.5);

/// An image of flat regions and what they are.
struct FlatRegions {
  Field image;
  PixelLabels truth;  ///< 0, 1, ... in the order of the grey values
};

/// Four regions laid like bricks and a disc, so that each of the six pairs touches somewhere. Two level sets can name
/// four regions such that neighbours differ in one of them for four pairs only: along the other borders both curves
/// must run one on the other (the case of Fig 5.14). Grey values 40, 100, 160, 220.
FlatRegions bricks(int size = 100);

/// Three regions one inside the other (an egg), grey values 40, 120, 200: what one level set with two levels can hold.
FlatRegions nested(int size = 100);

}  // namespace heartgen::study
