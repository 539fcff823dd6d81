// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/safe_screening.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

namespace heartgen::pde {
namespace {

using parallel::Comm;
using parallel::Slab;

/// Forces are compared with a little room for rounding: of the solver's float and of this sum.
constexpr float margin = 1e-4f;

/// Rounds end here, or when one decides less than this part (one over it) of what was left.
constexpr int max_rounds = 20;
constexpr std::int64_t worthwhile = 50;

/// Norms of the weights of any set of the three upper neighbours; bit a of the index stands for axis a.
using Norms = std::array<float, 8>;

Norms norms_of(const AxisWeights& w) {
  Norms norms{};
  for (unsigned set = 0; set < 8; ++set)
    norms[set] = std::sqrt((set & 1 ? w.x * w.x : 0) + (set & 2 ? w.y * w.y : 0) + (set & 4 ? w.z * w.z : 0));
  return norms;
}

/// States of the six neighbours of a voxel, lower and upper along each axis; decided_outside where there is none.
struct Around {
  std::array<std::uint8_t, 3> lower, upper;
};

/// What pulls a voxel away from `side` at most.
float bound(const Around& around, std::uint8_t side, const AxisWeights& w, const Norms& norms) {
  const std::array<float, 3> weight{w.x, w.y, w.z};
  float lower = 0;
  unsigned inside = 0, open = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    if (around.lower[a] != decided_outside && around.lower[a] != side) lower += weight[a];
    if (around.upper[a] == decided_outside) continue;
    inside |= 1u << a;
    if (around.upper[a] != side) open |= 1u << a;
  }
  return lower + (open ? norms[open] : -norms[inside]);
}

struct Problem {
  const Slab<float>& image;
  LinearForce force;
  AxisWeights weights;
  Norms norms;

  float pull(float grey) const { return std::clamp(force.gain * (grey - force.middle), -force.limit, force.limit); }
};

/// The state of a voxel whose pull is stronger than whatever its neighbours can do.
std::uint8_t first_state(float pull, float most) {
  return pull > most ? decided_above : pull < -most ? decided_below : undecided;
}

/// An undecided voxel of a slice: its place in the slice and its pull.
struct Open {
  std::int32_t row, column;
  float pull;
};
using OpenSlices = std::vector<std::vector<Open>>;

/// Decides a slice by the pull alone; returns what is left.
std::vector<Open> first_round(const Problem& p, std::int64_t k, Slab<std::uint8_t>& state) {
  const auto nx = state.grid.size[0], ny = state.grid.size[1];
  const float most = p.weights.x + p.weights.y + p.weights.z + p.norms[7] + margin;
  std::int64_t left = 0;
  for (std::int64_t j = 0; j < ny; ++j) {
    std::uint8_t* s = state.row(j, k);
    const float* g = p.image.row(j, k);
    for (std::int64_t i = 0; i < nx; ++i) {
      if (s[i] != decided_outside) s[i] = first_state(p.pull(g[i]), most);
      left += s[i] == undecided;
    }
  }
  std::vector<Open> open;
  open.reserve(static_cast<std::size_t>(left));
  for (std::int64_t j = 0; j < ny; ++j) {
    const std::uint8_t* s = state.row(j, k);
    const float* g = p.image.row(j, k);
    for (std::int64_t i = 0; i < nx; ++i)
      if (s[i] == undecided) open.push_back({static_cast<std::int32_t>(j), static_cast<std::int32_t>(i), p.pull(g[i])});
  }
  return open;
}

OpenSlices first_round(const Problem& p, Slab<std::uint8_t>& state) {
  OpenSlices open(static_cast<std::size_t>(state.count));
  parallel::parallel_for(state.first, state.end(), [&](std::int64_t from, std::int64_t to) {
    for (auto k = from; k < to; ++k) open[static_cast<std::size_t>(k - state.first)] = first_round(p, k, state);
  });
  return open;
}

Around around(const Slab<std::uint8_t>& state, const Open& voxel, std::int64_t k) {
  const auto& size = state.grid.size;
  const std::uint8_t* here = state.row(voxel.row, k) + voxel.column;
  const auto at = [&](bool exists, std::int64_t step) {
    return exists ? here[step] : static_cast<std::uint8_t>(decided_outside);
  };
  return {{at(voxel.column > 0, -1), at(voxel.row > 0, -size[0]), at(k > 0, -state.slice_size())},
          {at(voxel.column + 1 < size[0], 1), at(voxel.row + 1 < size[1], size[0]),
           at(k + 1 < size[2], state.slice_size())}};
}

std::uint8_t next_state(const Problem& p, const Around& neighbours, float pull) {
  if (pull > bound(neighbours, decided_above, p.weights, p.norms) + margin) return decided_above;
  if (-pull > bound(neighbours, decided_below, p.weights, p.norms) + margin) return decided_below;
  return undecided;
}

/// One more round over what is left, all voxels seeing the states before it. Returns how many were decided here.
std::int64_t decide_more(const Problem& p, OpenSlices& open, Slab<std::uint8_t>& state) {
  std::vector<std::vector<std::uint8_t>> next(open.size());
  const auto for_slices = [&](auto&& body) {
    parallel::parallel_for(0, static_cast<std::int64_t>(open.size()), [&](std::int64_t from, std::int64_t to) {
      for (auto n = static_cast<std::size_t>(from); n < static_cast<std::size_t>(to); ++n)
        body(n, state.first + static_cast<std::int64_t>(n));
    });
  };
  for_slices([&](std::size_t n, std::int64_t k) {
    next[n].reserve(open[n].size());
    for (const Open& voxel : open[n]) next[n].push_back(next_state(p, around(state, voxel, k), voxel.pull));
  });
  std::vector<std::int64_t> decided(open.size(), 0);
  for_slices([&](std::size_t n, std::int64_t k) {
    std::size_t left = 0;
    for (std::size_t v = 0; v < open[n].size(); ++v) {
      const Open voxel = open[n][v];
      if (next[n][v] == undecided)
        open[n][left++] = voxel;
      else
        state.row(voxel.row, k)[voxel.column] = next[n][v];
    }
    decided[n] = static_cast<std::int64_t>(open[n].size() - left);
    open[n].resize(left);
  });
  return std::accumulate(decided.begin(), decided.end(), std::int64_t{0});
}

std::int64_t size_of(const OpenSlices& open) {
  std::int64_t sum = 0;
  for (const auto& slice : open) sum += static_cast<std::int64_t>(slice.size());
  return sum;
}

}  // namespace

Slab<std::uint8_t> screen(const Slab<float>& image, const Slab<std::uint8_t>& domain, const LinearForce& force,
                          const AxisWeights& weights, const Comm& comm) {
  const Problem problem{image, force, weights, norms_of(weights)};
  auto state = parallel::make_slab_like<std::uint8_t>(domain, 1);
  std::ranges::transform(domain.owned(), state.owned().begin(),
                         [](std::uint8_t d) { return d ? undecided : decided_outside; });
  auto open = first_round(problem, state);
  for (int round = 1; round < max_rounds; ++round) {
    parallel::exchange_halo(state, comm);
    std::array<std::int64_t, 2> left_and_decided{size_of(open), 0};
    left_and_decided[1] = decide_more(problem, open, state);
    parallel::sum_int64(comm, left_and_decided);
    if (left_and_decided[1] * worthwhile < left_and_decided[0]) break;
  }
  parallel::exchange_halo(state, comm);
  return state;
}

}  // namespace heartgen::pde
