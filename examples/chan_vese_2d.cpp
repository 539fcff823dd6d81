// SPDX-License-Identifier: GPL-3.0-or-later
// Chan-Vese in the plane: a disc in noise as strong as its contrast. An image of one slice is a picture.
#include <heartgen/pde.hpp>
#include <numbers>

#include "images.hpp"

int main() {
  using namespace heartgen;
  const auto picture = noisy_ball(grid_of(128, 1), 40, 100);
  const Mask everywhere(picture.grid, 1);
  const auto found = pde::chan_vese(picture, everywhere, {.norm = pde::Norm::l1, .mu = 2}, parallel::self());
  std::printf("%d sweeps, grey values %.1f and %.1f\n", found.iterations, found.c_below, found.c_above);
  return expect_near("area of the disc, mm2", count(found.above), std::numbers::pi * 40 * 40, 0.02);
}
