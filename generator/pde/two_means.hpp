// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The best division of grey values into two classes, regardless of where the voxels lie: Chan-Vese with mu = 0 and
/// the initial condition for mu > 0 (thesis 5.2). 2-medians (L1) or 2-means (L2), the global optimum on a histogram,
/// then refined to exact medians or means of the voxels.
#pragma once
#include <cstdint>

#include "generator/parallel/slab.hpp"
#include "generator/pde/chan_vese.hpp"

namespace heartgen::pde {

/// Sides of a division of a domain.
enum Side : std::uint8_t { side_none = 0, side_below = 1, side_above = 2 };

struct TwoClasses {
  double c_below = 0;  ///< median or mean of each class; equal when there is one grey value only
  double c_above = 0;
};

/// Medians (L1) or means (L2) of the two sides; an empty side keeps its value of `before`. @collective
TwoClasses side_values(const parallel::Slab<float>& image, const parallel::Slab<std::uint8_t>& sides, Norm norm,
                       const TwoClasses& before, const parallel::Comm& comm);

/// Sides by the threshold in the middle of the two values; values on it are below.
void divide(const parallel::Slab<float>& image, const parallel::Slab<std::uint8_t>& domain, const TwoClasses& classes,
            parallel::Slab<std::uint8_t>& sides);

/// Sides by a level of a field: above where field > level; voxels of no side keep that. Returns how many voxels have
/// changed sides. @collective
std::int64_t divide_at_level(const parallel::Slab<float>& field, float level, parallel::Slab<std::uint8_t>& sides,
                             const parallel::Comm& comm);

/// 1 where the side is above, with one ghost slice, filled. @collective
parallel::Slab<std::uint8_t> above_mask(const parallel::Slab<std::uint8_t>& sides, const parallel::Comm& comm);

/// The domain must not be empty. @collective
TwoClasses two_means(const parallel::Slab<float>& image, const parallel::Slab<std::uint8_t>& domain, Norm norm,
                     const parallel::Comm& comm);

}  // namespace heartgen::pde
