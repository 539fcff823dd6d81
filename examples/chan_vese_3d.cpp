// SPDX-License-Identifier: GPL-3.0-or-later
// Chan-Vese in space, and then inside of what it found: a tree of two splits.
#include <heartgen/pde.hpp>
#include <numbers>

#include "images.hpp"

int main() {
  using namespace heartgen;
  auto image = noisy_ball(grid_of(64, 64), 24, 60);
  for (std::int64_t k = 0; k < 64; ++k)
    for (std::int64_t j = 0; j < 64; ++j)
      for (std::int64_t i = 0; i < 64; ++i)
        if (radius_at(image.grid, i, j, k) < 14) image(i, j, k) += 100;  // a brighter ball in the ball
  const std::vector<SegmentationStep> steps{{.name = "object", .mu = 0.5},
                                            {.name = "core", .domain = "object.above", .mu = 0.5}};
  const auto tree = pde::segment(image, steps, parallel::self());
  const auto volume = [](double r) { return 4 * std::numbers::pi / 3 * r * r * r; };
  const double object = count(pde::side(tree, "object.above")), core = count(pde::side(tree, "core.above"));
  return expect_near("core, mm3", core, volume(14), 0.05) + (object < core);
}
