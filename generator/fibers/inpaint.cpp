// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/fibers/inpaint.hpp"

#include <algorithm>

#include "generator/fibers/inpaint_kernels.hpp"
#include "generator/parallel/threads.hpp"
#include "model/mesh_queries/mesh_edges.hpp"
#include "model/sort_unique.hpp"

namespace heartgen::fibers {
namespace {

/// The neighbours of an element, for the kernels.
auto around(const NeighborGraph& graph, std::size_t e) {
  return [&graph, e](auto&& visit) {
    for (auto n = static_cast<std::size_t>(graph.start[e]); n < static_cast<std::size_t>(graph.start[e + 1]); ++n)
      visit(static_cast<std::size_t>(graph.neighbor[n]), double{graph.distance_mm[n]});
  };
}

/// Start values, layer by layer from the known elements. Returns the filled elements, ascending.
std::vector<std::size_t> fill_in_layers(const NeighborGraph& graph, std::vector<AxisTensor>& axes,
                                        const std::vector<std::uint8_t>& missing) {
  std::vector<std::uint8_t> known(missing.size());
  for (std::size_t e = 0; e < missing.size(); ++e) known[e] = !missing[e];
  std::vector<std::size_t> filled, layer, open;
  for (std::size_t e = 0; e < missing.size(); ++e)
    if (missing[e]) open.push_back(e);
  for (;;) {
    layer.clear();
    for (const auto e : open) {
      axes[e] = inpainting::mean_of_known(around(graph, e), axes, [&](std::size_t other) { return known[other] != 0; });
      if (trace(axes[e]) > 0) layer.push_back(e);
    }
    if (layer.empty()) break;
    for (const auto e : layer) known[e] = 1;
    filled.insert(filled.end(), layer.begin(), layer.end());
    std::erase_if(open, [&](std::size_t e) { return known[e] != 0; });
  }
  std::sort(filled.begin(), filled.end());
  return filled;
}

}  // namespace

NeighborGraph edge_graph(const TetMesh& mesh, const std::vector<std::uint8_t>& use) {
  const auto edges = mesh_queries::edges_of_cells(mesh.cells, mesh.nodes_mm.size(), use);
  NeighborGraph graph;
  graph.start.assign(mesh.nodes_mm.size() + 1, 0);
  for (const auto& [a, b] : edges)
    for (const auto n : {a, b}) ++graph.start[static_cast<std::size_t>(n) + 1];
  for (std::size_t n = 1; n < graph.start.size(); ++n) graph.start[n] += graph.start[n - 1];
  graph.neighbor.resize(2 * edges.size());
  graph.distance_mm.resize(2 * edges.size());
  // Edges ascend, so a node's smaller neighbours come before its larger ones, and both ascend.
  auto next = graph.start;
  for (const auto& [a, b] : edges) {
    const double length = norm(mesh.nodes_mm[static_cast<std::size_t>(a)] - mesh.nodes_mm[static_cast<std::size_t>(b)]);
    for (const auto& [from, to] : {mesh_queries::NodePair{a, b}, mesh_queries::NodePair{b, a}}) {
      const auto at = static_cast<std::size_t>(next[static_cast<std::size_t>(from)]++);
      graph.neighbor[at] = to;
      graph.distance_mm[at] = static_cast<float>(std::max(length, 1e-6));
    }
  }
  return graph;
}

std::int64_t inpaint_axes(const NeighborGraph& graph, int iterations, std::vector<AxisTensor>& axes,
                          std::vector<std::uint8_t>& missing) {
  const auto filled = fill_in_layers(graph, axes, missing);
  std::vector<std::uint8_t> unknown = missing;
  for (const auto e : filled) unknown[e] = 0;
  std::vector<std::size_t> active = filled;  // elements whose slope enters: the filled ones and their known neighbours
  for (const auto e : filled)
    for (auto n = graph.start[e]; n < graph.start[e + 1]; ++n)
      active.push_back(static_cast<std::size_t>(graph.neighbor[static_cast<std::size_t>(n)]));
  sort_unique(active);
  const auto is_known = [&](std::size_t e) { return !unknown[e]; };
  std::vector<double> slope(axes.size());
  std::vector<AxisTensor> next(filled.size());
  for (int sweep = 0; sweep < iterations; ++sweep) {
    parallel::parallel_for(0, static_cast<std::int64_t>(active.size()), [&](std::int64_t begin, std::int64_t end) {
      for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n)
        if (const auto e = active[n]; is_known(e))
          slope[e] = inpainting::inverse_slope(around(graph, e), axes, is_known, axes[e]);
    });
    parallel::parallel_for(0, static_cast<std::int64_t>(filled.size()), [&](std::int64_t begin, std::int64_t end) {
      for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n)
        next[n] =
            inpainting::relaxed(around(graph, filled[n]), axes, slope, is_known, axes[filled[n]], slope[filled[n]]);
    });
    for (std::size_t n = 0; n < filled.size(); ++n) axes[filled[n]] = next[n];
  }
  for (const auto e : filled) {
    axes[e] = axis_tensor(leading_axis(axes[e]));
    missing[e] = 0;
  }
  return static_cast<std::int64_t>(filled.size());
}

}  // namespace heartgen::fibers
