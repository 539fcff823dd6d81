// SPDX-License-Identifier: GPL-3.0-or-later
// A subjective surface bridges the gap in a circle: seen from its middle, the edges that there are become cliffs.
#include <array>
#include <cmath>
#include <heartgen/pde.hpp>
#include <numbers>

#include "images.hpp"

int main() {
  using namespace heartgen;
  constexpr double radius = 20;
  Volume<float> image(grid_of(80, 1));
  for (std::int64_t j = 0; j < 80; ++j)
    for (std::int64_t i = 0; i < 80; ++i) {
      const bool is_on_circle = std::abs(radius_at(image.grid, i, j, 0) - radius) < 1;
      const bool is_in_gap = i > 40 && std::abs(static_cast<double>(j) - 39.5) < 4;
      image(i, j, 0) = is_on_circle && !is_in_gap ? 100.F : 0.F;
    }
  const std::array seeds{Vec3{39.5, 39.5, 0}};
  const auto seen = pde::subjective_surface(image, seeds, {.smoothing_mm = 1, .edge_per_mm = 5}, {}, parallel::self());
  const auto object = pde::object_of(seen, seeds);
  std::printf("%d steps, %s\n", seen.iterations, seen.steady ? "steady" : "not steady");
  return expect_near("area inside, mm2", count(object), std::numbers::pi * radius * radius, 0.15);
}
