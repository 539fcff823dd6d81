// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/image/subvoxel_distance.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "generator/image/isotropic_distance.hpp"
#include "generator/image/voxel_layers.hpp"
#include "generator/parallel/threads.hpp"
#include "model/priors.hpp"

namespace heartgen::image {
namespace {

constexpr float half = 0.5F;

/// Where the mask says that a surface runs next to a voxel, and where it runs by the share.
struct NextTo {
  bool surface = false;
  std::optional<float> distance_voxels;  ///< empty where mask and share disagree
};

/// Distance to the plane through the crossings of the axes.
NextTo next_to(const Mask& inside, const Volume<float>& share, std::int64_t i, std::int64_t j, std::int64_t k) {
  constexpr double least = 0.01;
  const Grid& g = inside.grid;
  const bool in = inside(i, j, k) != 0;
  const float here = share(i, j, k);
  NextTo result;
  bool agree = (here > half) == in;
  double inverse_squared = 0;
  for (int axis = 0; axis < 3; ++axis) {
    double nearest = 2;
    for (const int side : {-1, 1}) {
      const std::int64_t a = i + (axis == 0) * side, b = j + (axis == 1) * side, c = k + (axis == 2) * side;
      if (!g.contains(a, b, c) || (inside(a, b, c) != 0) == in) continue;
      result.surface = true;
      const float there = share(a, b, c);
      agree = agree && (there > half) != in;
      if (agree) nearest = std::min(nearest, static_cast<double>((here - half) / (here - there)));
    }
    if (nearest <= 1) inverse_squared += 1 / std::max(nearest * nearest, least * least);
  }
  if (result.surface && agree) result.distance_voxels = static_cast<float>(1 / std::sqrt(inverse_squared));
  return result;
}

/// What the share adds to distances of voxels next to the surface.
struct Changes {
  Volume<float> mm;
  Mask known;
};

Changes changes_next_to_surface(const Mask& inside, const Volume<float>& share, const LevelSet& distance) {
  const Grid& g = inside.grid;
  Changes changes{Volume<float>(g), Mask(g)};
  parallel::parallel_for(0, g.size[2], [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < g.size[1]; ++j)
        for (std::int64_t i = 0; i < g.size[0]; ++i) {
          const NextTo at = next_to(inside, share, i, j, k);
          changes.known(i, j, k) = at.surface;
          if (!at.distance_voxels) continue;
          const float mm = *at.distance_voxels * static_cast<float>(g.spacing_mm.x);
          changes.mm(i, j, k) = (inside(i, j, k) ? -mm : mm) - distance(i, j, k);
        }
  });
  return changes;
}

/// Mean of the known neighbours' changes, weighted by the inverse square of their distance.
class MeanAround {
 public:
  explicit MeanAround(const Changes& changes) : changes_(&changes), steps_(neighbor_steps(changes.known.grid)) {
    for (std::size_t n = 0; n < weights_.size(); ++n) {
      const auto& s = neighbors26[n];
      weights_[n] = 1 / static_cast<float>(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]);
    }
  }
  float at(std::int64_t v) const {
    const Grid& g = changes_->known.grid;
    const bool inner = is_inner(g, v);
    const std::int64_t i = v % g.size[0], j = v / g.size[0] % g.size[1], k = v / (g.size[0] * g.size[1]);
    float sum = 0, total = 0;
    for (std::size_t n = 0; n < steps_.size(); ++n) {
      const auto& s = neighbors26[n];
      if (!inner && !g.contains(i + s[0], j + s[1], k + s[2])) continue;
      const auto from = static_cast<std::size_t>(v + steps_[n]);
      if (!changes_->known.voxels[from]) continue;
      sum += weights_[n] * changes_->mm.voxels[from];
      total += weights_[n];
    }
    return sum / total;
  }

 private:
  const Changes* changes_;
  std::array<std::int64_t, 26> steps_;
  std::array<float, 26> weights_;
};

/// A surface that moves takes the distances on either side of it along.
void continue_changes(Changes& changes) {
  const auto layers = static_cast<int>(priors::wall_reach_mm / changes.known.grid.spacing_mm.x);
  const MeanAround mean(changes);
  Mask seen = changes.known;
  auto front = known_voxels(seen);
  for (int layer = 0; layer < layers; ++layer) {
    front = unseen_around(seen, front);
    std::vector<float> values(front.size());
    parallel::parallel_for(0, static_cast<std::int64_t>(front.size()), [&](std::int64_t begin, std::int64_t end) {
      for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n)
        values[n] = mean.at(front[n]);
    });
    for (std::size_t n = 0; n < front.size(); ++n) {
      changes.mm.voxels[static_cast<std::size_t>(front[n])] = values[n];
      changes.known.voxels[static_cast<std::size_t>(front[n])] = 1;
    }
  }
}

}  // namespace

LevelSet signed_distance(const Mask& inside, const Volume<float>& share) {
  LevelSet distance = signed_distance(inside, 0);
  if (share.voxels.empty()) return distance;
  Changes changes = changes_next_to_surface(inside, share, distance);
  continue_changes(changes);
  for (std::size_t v = 0; v < distance.voxels.size(); ++v) distance.voxels[v] += changes.mm.voxels[v];
  return distance;
}

}  // namespace heartgen::image
