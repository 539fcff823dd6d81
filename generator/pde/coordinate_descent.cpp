// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/coordinate_descent.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace heartgen::pde {
namespace {

using parallel::Comm;
using parallel::Slab;
using Bytes = Slab<std::uint8_t>;

/// (i + 2 j + 3 k) modulo this differs between any two voxels of one term, a voxel and its three upper neighbours.
constexpr int classes = 4;

struct Problem {
  const Slab<float>& image;
  const Bytes& domain;
  LinearForce force;
  AxisWeights weights;
};

/// Steps from a voxel to its neighbours in memory; the upper neighbour of the last voxel along an axis does not exist.
struct Voxel {
  const std::uint8_t *domain, *above;
  std::int64_t step[3];
  bool has_lower[3], has_upper[3];
};

/// |w ∇above| at the voxel `offset` away, which has upper neighbours where `has_upper`; `flipped` (an offset) counts as
/// on the other side.
double term(const Voxel& v, std::int64_t offset, const bool (&has_upper)[3], std::int64_t flipped,
            const AxisWeights& w) {
  const float weight[3] = {w.x, w.y, w.z};
  const auto side = [&](std::int64_t at) { return v.above[at] ^ static_cast<std::uint8_t>(at == flipped); };
  double square = 0;
  for (int a = 0; a < 3; ++a) {
    const auto upper = offset + v.step[a];
    if (has_upper[a] && v.domain[upper] && side(upper) != side(offset)) square += double{weight[a]} * weight[a];
  }
  return std::sqrt(square);
}

/// Change of the sum when the voxel changes sides.
double change(const Problem& p, const Voxel& v, float grey) {
  constexpr std::int64_t nobody = INT64_MIN;
  double sum = term(v, 0, v.has_upper, 0, p.weights) - term(v, 0, v.has_upper, nobody, p.weights);
  for (int a = 0; a < 3; ++a) {
    if (!v.has_lower[a] || !v.domain[-v.step[a]]) continue;
    bool has_upper[3] = {v.has_upper[0], v.has_upper[1], v.has_upper[2]};
    has_upper[a] = true;
    sum += term(v, -v.step[a], has_upper, 0, p.weights) - term(v, -v.step[a], has_upper, nobody, p.weights);
  }
  const double pull = std::clamp(p.force.gain * (grey - p.force.middle), -p.force.limit, p.force.limit);
  return sum + (*v.above ? pull : -pull);
}

/// Whether the neighbours and the grey value keep the voxel where it is: every part of the change is then at least 0.
/// So it is with most, and this is found out sooner than the change.
bool is_held(const Voxel& v, float grey, float middle) {
  const auto side = *v.above;
  if (side ? grey < middle : grey > middle) return false;
  for (int a = 0; a < 3; ++a) {
    if (v.has_lower[a] && v.above[-v.step[a]] != side) return false;
    if (v.has_upper[a] && v.above[v.step[a]] != side) return false;
  }
  return true;
}

/// The voxels of a row that belong to the class; returns whether any changed sides.
bool descend_row(const Problem& p, const Runs& runs, std::int64_t j, std::int64_t k, std::int64_t kind, Bytes& above) {
  const auto& size = above.grid.size;
  const std::uint8_t* d = p.domain.row(j, k);
  std::uint8_t* a = above.row(j, k);
  const float* g = p.image.row(j, k);
  Voxel v{d, a, {1, size[0], above.slice_size()}, {false, j > 0, k > 0}, {false, j + 1 < size[1], k + 1 < size[2]}};
  const auto offset = ((kind - 2 * j - 3 * k) % classes + classes) % classes;
  bool changed = false;
  for (const Run& run : runs)
    for (auto i = run.begin + ((offset - run.begin) % classes + classes) % classes; i < run.end; i += classes) {
      if (!d[i]) continue;
      v.domain = d + i;
      v.above = a + i;
      v.has_lower[0] = i > 0;
      v.has_upper[0] = i + 1 < size[0];
      if (!is_held(v, g[i], p.force.middle) && change(p, v, g[i]) < 0) {
        a[i] ^= 1;
        changed = true;
      }
    }
  return changed;
}

/// The step, a pass through one class, at which something last changed in each owned row. What a voxel gains depends on
/// its own row and six around it; where nothing changed there since the voxel's last turn it cannot gain now either.
struct LastChanges {
  std::int64_t first = 0, count = 0, rows = 0;  ///< owned slices, rows of a slice
  std::vector<int> step;                        ///< -1 where nothing did

  /// Whether the row must be looked at from `since` on; changes of other ranks are not known, so it must beside those.
  bool any(std::int64_t j, std::int64_t k, int since) const {
    constexpr std::int64_t around[][2] = {{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, -1}, {-1, 1}};
    return std::ranges::any_of(around, [&](const auto& to) {
      const auto row = j + to[0], slice = k - first + to[1];
      if (row < 0 || row >= rows) return false;
      return slice < 0 || slice >= count || step[static_cast<std::size_t>(slice * rows + row)] >= since;
    });
  }
};

}  // namespace

void descend_coordinates(const Slab<float>& image, const Bytes& domain, const LinearForce& force,
                         const AxisWeights& weights, const RowRuns& visited, int passes, Bytes& above,
                         const Comm& comm) {
  const Problem p{image, domain, force, weights};
  const auto ny = image.grid.size[1];
  LastChanges last{image.first, image.count, ny, std::vector<int>(static_cast<std::size_t>(image.count * ny), -1)};
  auto next = last.step;
  for (int step = 0; step < passes * classes; ++step) {
    parallel::for_rows(image, [&](std::int64_t j, std::int64_t k) {
      if (last.any(j, k, step - classes) && descend_row(p, visited.at(j, k), j, k, step % classes, above))
        next[static_cast<std::size_t>((k - image.first) * ny + j)] = step;
    });
    last.step = next;
    parallel::exchange_halo(above, comm);
    const bool end_of_pass = step % classes == classes - 1;
    if (end_of_pass &&
        parallel::sum_int64(comm, std::ranges::count_if(next, [&](int at) { return at > step - classes; })) == 0)
      break;
  }
}

}  // namespace heartgen::pde
