// SPDX-License-Identifier: GPL-3.0-or-later
// Total variation with L1 fidelity: what is smaller than 3 / lambda vanishes, whatever its contrast; the rest stays.
#include <heartgen/pde.hpp>

#include "images.hpp"

int main() {
  using namespace heartgen;
  const auto middle_after = [](double radius_mm) {
    const auto image = noisy_ball(grid_of(40, 40), radius_mm, 0);
    auto slab = parallel::scatter(image, parallel::self());
    pde::total_variation_l1(slab, {.lambda = 0.5, .iterations = 400}, parallel::self());
    return static_cast<double>(parallel::gather(slab, parallel::self())(20, 20, 20));
  };
  return expect_near("ball of 12 mm, grey value", middle_after(12), 100, 0.02) +
         (middle_after(3) > 1);  // 3 / lambda is 6 mm
}
