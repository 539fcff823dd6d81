#include "generator/atlas/label_surface.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <vector>

#include "generator/parallel/threads.hpp"

namespace heart::atlas {
namespace {

constexpr double few = 0.11;  // of the voxels within reach; fewer on the wrong side hardly move the surface

/// A Gaussian's values at the integers, up to where it is negligible.
struct Bell {
  std::vector<double> values;
  explicit Bell(double sigma) : values(static_cast<std::size_t>(std::ceil(2.5 * sigma)) + 1) {
    for (std::size_t n = 0; n < values.size(); ++n)
      values[n] = std::exp(-0.5 * static_cast<double>(n * n) / (sigma * sigma));
  }
  std::int64_t reach() const { return static_cast<std::int64_t>(values.size()) - 1; }
  double volume() const {
    const double line = 2 * std::accumulate(values.begin(), values.end(), 0.0) - values.front();
    return line * line * line;
  }
  double operator()(std::int64_t n) const { return values[static_cast<std::size_t>(std::abs(n))]; }
};

struct Wrong {
  std::int64_t i = 0, j = 0;
  double shift_mm = 0;
};

/// Voxels on the wrong side, per slice.
std::vector<std::vector<Wrong>> on_wrong_side(const Mask& inside, const LevelSet& surface) {
  const Grid& g = surface.grid;
  std::vector<std::vector<Wrong>> wrong(static_cast<std::size_t>(g.size[2]));
  parallel::parallel_for(0, g.size[2], [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < g.size[1]; ++j)
        for (std::int64_t i = 0; i < g.size[0]; ++i)
          if (const float here = surface(i, j, k); here != 0 && (here < 0) != (inside(i, j, k) != 0))
            wrong[static_cast<std::size_t>(k)].push_back({i, j, -double{here}});
  });
  return wrong;
}

struct Sums {
  double shift_mm = 0, weight = 0;
};

/// Adds a voxel's shift to a slice that lies `across` of it.
void add(const Wrong& wrong, double across, const Bell& bell, const Grid& g, std::vector<Sums>& slice) {
  const std::int64_t reach = bell.reach();
  const std::int64_t low = std::max<std::int64_t>(wrong.i - reach, 0), high = std::min(wrong.i + reach, g.size[0] - 1);
  for (std::int64_t j = std::max<std::int64_t>(wrong.j - reach, 0); j <= std::min(wrong.j + reach, g.size[1] - 1); ++j)
    for (std::int64_t i = low; i <= high; ++i) {
      const double weight = across * bell(j - wrong.j) * bell(i - wrong.i);
      Sums& sum = slice[static_cast<std::size_t>(j * g.size[0] + i)];
      sum.shift_mm += weight * wrong.shift_mm;
      sum.weight += weight;
    }
}

/// One slice's shifts, out of what its neighbours ask for, in their order.
void shift_slice(const std::vector<std::vector<Wrong>>& wrong, const Bell& bell, std::int64_t k, LevelSet& surface) {
  const Grid& g = surface.grid;
  const std::int64_t first = std::max<std::int64_t>(k - bell.reach(), 0);
  const std::int64_t last = std::min(k + bell.reach(), g.size[2] - 1);
  std::vector<Sums> sums(static_cast<std::size_t>(g.size[0] * g.size[1]));
  for (std::int64_t from = first; from <= last; ++from)
    for (const Wrong& w : wrong[static_cast<std::size_t>(from)]) add(w, bell(k - from), bell, g, sums);
  float* const slice = surface.voxels.data() + g.offset(0, 0, k);
  const double half_weight = few * bell.volume();
  for (std::size_t v = 0; v < sums.size(); ++v) {
    const auto& [shift_mm, weight] = sums[v];
    slice[v] += static_cast<float>(shift_mm * weight / (weight * weight + half_weight * half_weight));
  }
}

}  // namespace

void respect_labels(const Mask& inside, double reach_voxels, int rounds, LevelSet& surface) {
  const Bell bell(reach_voxels);
  for (int round = 0; round < rounds; ++round) {
    const auto wrong = on_wrong_side(inside, surface);
    parallel::parallel_for(0, surface.grid.size[2], [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t k = begin; k < end; ++k) shift_slice(wrong, bell, k, surface);
    });
  }
}

}  // namespace heart::atlas
