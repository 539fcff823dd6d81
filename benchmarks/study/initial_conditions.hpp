// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Where the Chan-Vese flow starts (thesis 5.2).
#pragma once
#include <vector>

#include "benchmarks/study/regions.hpp"

namespace heartgen::study {

/// Signed distance to a circle, positive inside, pixels.
Field circle_start(int width, int height, double center_x, double center_y, double radius);
/// The circle in the middle, its radius a third of the shorter side.
Field circle_start(int width, int height);
/// Signed distance to `across` × `across` circles spread evenly, positive inside, pixels.
Field many_circles_start(int width, int height, int across = 10);
/// Independent values, uniform in [-1, 1): a function of `key` and the pixel.
Field random_start(int width, int height, std::uint64_t key = 1);
/// H(phi) - H(-phi) of the solution with μ = 0: +1 in the brighter of the two best classes, else -1.
Field two_class_start(const Field& image, const Domain& domain, Norm norm);

struct NamedStart {
  const char* name;
  Field phi;
};
/// The four of 5.2, the slowest last by the thesis; the two classes are those of the L2 norm.
std::vector<NamedStart> four_starts(const Field& image, const Domain& domain);

}  // namespace heartgen::study
