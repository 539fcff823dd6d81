// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/fibers/inpaint_grid.hpp"

#include <array>
#include <vector>

#include "generator/fibers/inpaint_kernels.hpp"
#include "generator/parallel/threads.hpp"

namespace heartgen::fibers {
namespace {

using parallel::Slab;

constexpr std::uint8_t filled = 3;  // a kind of our own: missing before, has an axis now

bool is_missing(std::uint8_t kind) { return kind == static_cast<std::uint8_t>(AxisKind::missing); }
bool has_axis(std::uint8_t kind) { return kind == static_cast<std::uint8_t>(AxisKind::known) || kind == filled; }

/// An owned voxel: its place in the slab's values, and which of its face neighbours lie in the image.
struct Place {
  std::size_t at;
  std::array<bool, 6> inside;  ///< -z -y -x +x +y +z
};

/// The face neighbours in the order of their numbers, as in a NeighborGraph.
struct Neighbors {
  std::array<std::ptrdiff_t, 6> offset;
  std::array<double, 6> distance_mm;

  explicit Neighbors(const Grid& g)
      : offset{-g.size[0] * g.size[1], -g.size[0], -1, 1, g.size[0], g.size[0] * g.size[1]},
        distance_mm{g.spacing_mm.z, g.spacing_mm.y, g.spacing_mm.x, g.spacing_mm.x, g.spacing_mm.y, g.spacing_mm.z} {}

  /// For the kernels.
  auto around(const Place& place) const {
    return [this, &place](auto&& visit) {
      for (std::size_t n = 0; n < 6; ++n)
        if (place.inside[n])
          visit(static_cast<std::size_t>(static_cast<std::ptrdiff_t>(place.at) + offset[n]), distance_mm[n]);
    };
  }
};

/// Owned voxels that are chosen(place), x fastest.
template <class Chosen>
std::vector<Place> places(const Slab<std::uint8_t>& kinds, const Chosen& chosen) {
  const auto& size = kinds.grid.size;
  std::vector<Place> result;
  for (auto k = kinds.first; k < kinds.end(); ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i) {
        const Place place{static_cast<std::size_t>(kinds.row(j, k) + i - kinds.values.data()),
                          {k > 0, j > 0, i > 0, i + 1 < size[0], j + 1 < size[1], k + 1 < size[2]}};
        if (chosen(place)) result.push_back(place);
      }
  return result;
}

template <class Body>
void for_each_place(const std::vector<Place>& list, const Body& body) {
  parallel::parallel_for(0, static_cast<std::int64_t>(list.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n) body(n, list[n]);
  });
}

/// Start values, layer by layer from the known voxels. Returns the number of filled voxels. @collective
std::int64_t fill_in_layers(const Neighbors& neighbors, Slab<AxisTensor>& axes, Slab<std::uint8_t>& kinds,
                            const parallel::Comm& comm) {
  auto open = places(kinds, [&](const Place& p) { return is_missing(kinds.values[p.at]); });
  std::int64_t total = 0;
  for (;;) {
    const auto known = [&](std::size_t e) { return has_axis(kinds.values[e]); };
    for_each_place(open, [&](std::size_t, const Place& p) {
      axes.values[p.at] = inpainting::mean_of_known(neighbors.around(p), axes.values, known);
    });
    std::vector<Place> rest;
    std::int64_t count = 0;
    for (const Place& p : open) {
      if (trace(axes.values[p.at]) > 0) {
        kinds.values[p.at] = filled;
        ++count;
      } else {
        rest.push_back(p);
      }
    }
    count = sum_int64(comm, count);
    if (count == 0) return total;
    total += count;
    open = std::move(rest);
    exchange_halo(axes, comm);
    exchange_halo(kinds, comm);
  }
}

/// Jacobi sweeps over the filled voxels; the slopes of their known neighbours enter, too. @collective
void sweep(const Neighbors& neighbors, const std::vector<Place>& inside, int iterations, Slab<AxisTensor>& axes,
           const Slab<std::uint8_t>& kinds, const parallel::Comm& comm) {
  const auto known = [&](std::size_t e) { return has_axis(kinds.values[e]); };
  const auto active = places(kinds, [&](const Place& p) {
    bool touches = kinds.values[p.at] == filled;
    neighbors.around(p)([&](std::size_t other, double) { touches |= kinds.values[other] == filled; });
    return touches && known(p.at);
  });
  auto slope = parallel::make_slab_like<double>(axes, 1);
  std::vector<AxisTensor> next(inside.size());
  for (int n = 0; n < iterations; ++n) {
    for_each_place(active, [&](std::size_t, const Place& p) {
      slope.values[p.at] = inpainting::inverse_slope(neighbors.around(p), axes.values, known, axes.values[p.at]);
    });
    exchange_halo(slope, comm);
    for_each_place(inside, [&](std::size_t at, const Place& p) {
      next[at] = inpainting::relaxed(neighbors.around(p), axes.values, slope.values, known, axes.values[p.at],
                                     slope.values[p.at]);
    });
    for (std::size_t at = 0; at < inside.size(); ++at) axes.values[inside[at].at] = next[at];
    exchange_halo(axes, comm);
  }
}

}  // namespace

std::int64_t inpaint_axes(Slab<AxisTensor>& axes, Slab<std::uint8_t>& kinds, int iterations,
                          const parallel::Comm& comm) {
  const Neighbors neighbors(axes.grid);
  exchange_halo(axes, comm);
  exchange_halo(kinds, comm);
  const std::int64_t count = fill_in_layers(neighbors, axes, kinds, comm);
  const auto inside = places(kinds, [&](const Place& p) { return kinds.values[p.at] == filled; });
  sweep(neighbors, inside, iterations, axes, kinds, comm);
  for_each_place(inside, [&](std::size_t, const Place& p) {
    axes.values[p.at] = axis_tensor(leading_axis(axes.values[p.at]));
    kinds.values[p.at] = static_cast<std::uint8_t>(AxisKind::known);
  });
  exchange_halo(axes, comm);
  exchange_halo(kinds, comm);
  return count;
}

Volume<Vec3> inpaint_axes(const Volume<Vec3>& fiber, const Mask& wall, int iterations, const parallel::Comm& comm) {
  const auto vectors = parallel::scatter(fiber, comm);
  auto kinds = parallel::scatter(wall, comm);
  auto axes = parallel::make_slab_like<AxisTensor>(vectors, 1);
  for (std::size_t v = 0; v < axes.values.size(); ++v) {
    const bool known = norm(vectors.values[v]) > 0.5;
    if (known) axes.values[v] = axis_tensor(normalized(vectors.values[v]));
    kinds.values[v] = static_cast<std::uint8_t>(!kinds.values[v] ? AxisKind::outside
                                                : known          ? AxisKind::known
                                                                 : AxisKind::missing);
  }
  inpaint_axes(axes, kinds, iterations, comm);
  auto result = parallel::make_slab_like<Vec3>(vectors, 0);
  const auto from = axes.owned();
  const auto before = vectors.owned();
  for (std::size_t v = 0; v < from.size(); ++v)
    result.owned()[v] = norm(before[v]) > 0.5 ? before[v] : leading_axis(from[v]);
  return parallel::gather(result, comm);
}

}  // namespace heartgen::fibers
