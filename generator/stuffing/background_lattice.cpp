// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/stuffing/background_lattice.hpp"

#include <algorithm>
#include <array>

#include "generator/parallel/threads.hpp"

namespace heartgen::stuffing {
namespace {

double finest_edge(const tetmesh::Materials& m) {
  if (m.finest_edge_mm > 0) return m.finest_edge_mm;
  // The size field varies slowly: its samples at a sixty-fourth of the box miss little.
  constexpr int samples = 64;
  std::array<double, samples> finest;
  const Vec3 box = m.box_max_mm - m.box_min_mm;
  parallel::parallel_for(0, samples, [&](std::int64_t begin, std::int64_t end) {
    for (auto k = begin; k < end; ++k) {
      double least = m.edge_mm(m.box_min_mm);
      for (int j = 0; j < samples; ++j)
        for (int i = 0; i < samples; ++i) {
          const Vec3 share{(i + 0.5) / samples, (j + 0.5) / samples, (static_cast<double>(k) + 0.5) / samples};
          least = std::min(least, m.edge_mm(m.box_min_mm + Vec3{share.x * box.x, share.y * box.y, share.z * box.z}));
        }
      finest[static_cast<std::size_t>(k)] = least;
    }
  });
  return *std::min_element(finest.begin(), finest.end());
}

}  // namespace

WantedLevels wanted_levels(const tetmesh::Materials& m) {
  return wanted_levels(m.box_min_mm, m.box_max_mm, finest_edge(m), m.edge_mm);
}

Lattice build_background_lattice(const tetmesh::Materials& materials, const WantedLevels& wanted) {
  auto tree = make_octree(wanted, materials.edge_mm, materials.spots);
  auto near = active_leaves(tree, materials.label_at);
  return {std::move(tree), std::move(near)};
}

Lattice build_background_lattice(const tetmesh::Materials& materials) {
  return build_background_lattice(materials, wanted_levels(materials));
}

}  // namespace heartgen::stuffing
