#include "generator/fibers/inpaint.hpp"

#include <algorithm>
#include <cmath>

#include "generator/parallel/threads.hpp"

namespace heart::fibers {
namespace {

using atlas::AxisTensor;

/// Half of the squared Frobenius norm counts off-diagonal components twice, as the matrices do.
double squared_difference(const AxisTensor& a, const AxisTensor& b) {
  double sum = 0;
  for (std::size_t c = 0; c < 6; ++c) {
    const double d = a.c[c] - b.c[c];
    sum += (c < 3 ? 1 : 2) * d * d;
  }
  return sum;
}

AxisTensor mean_of_known(const NeighborGraph& graph, const std::vector<AxisTensor>& axes,
                         const std::vector<std::uint8_t>& known, std::size_t e) {
  AxisTensor sum;
  double total = 0;
  for (auto n = graph.start[e]; n < graph.start[e + 1]; ++n) {
    const auto other = static_cast<std::size_t>(graph.neighbor[static_cast<std::size_t>(n)]);
    if (!known[other]) continue;
    sum += axes[other];
    ++total;
  }
  return total > 0 ? (1 / total) * sum : sum;
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
      axes[e] = mean_of_known(graph, axes, known, e);
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

/// 1 / |grad u| at an element, from the differences to its neighbours.
double inverse_slope(const NeighborGraph& graph, const std::vector<AxisTensor>& axes,
                     const std::vector<std::uint8_t>& unknown, std::size_t e) {
  constexpr double least_slope_per_mm = 1e-3;
  double sum = least_slope_per_mm * least_slope_per_mm;
  for (auto n = graph.start[e]; n < graph.start[e + 1]; ++n) {
    const auto other = static_cast<std::size_t>(graph.neighbor[static_cast<std::size_t>(n)]);
    if (unknown[other]) continue;
    const double h = graph.distance_mm[static_cast<std::size_t>(n)];
    sum += squared_difference(axes[e], axes[other]) / (2 * h * h);
  }
  return 1 / std::sqrt(sum);
}

AxisTensor relaxed(const NeighborGraph& graph, const std::vector<AxisTensor>& axes, const std::vector<double>& slope,
                   const std::vector<std::uint8_t>& unknown, std::size_t e) {
  AxisTensor sum;
  double total = 0;
  for (auto n = graph.start[e]; n < graph.start[e + 1]; ++n) {
    const auto other = static_cast<std::size_t>(graph.neighbor[static_cast<std::size_t>(n)]);
    if (unknown[other]) continue;
    const double h = graph.distance_mm[static_cast<std::size_t>(n)];
    const double weight = (slope[e] + slope[other]) / (h * h);
    sum += weight * axes[other];
    total += weight;
  }
  return total > 0 ? (1 / total) * sum : axes[e];
}

}  // namespace

NeighborGraph edge_graph(const TetMesh& mesh, const std::vector<std::uint8_t>& use) {
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    if (!use[c]) continue;
    for (const auto a : mesh.cells[c])
      for (const auto b : mesh.cells[c])
        if (a != b) edges.emplace_back(a, b);
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  NeighborGraph graph;
  graph.start.assign(mesh.nodes_mm.size() + 1, 0);
  for (const auto& [a, b] : edges) {
    ++graph.start[static_cast<std::size_t>(a) + 1];
    graph.neighbor.push_back(b);
    const double length = norm(mesh.nodes_mm[static_cast<std::size_t>(a)] - mesh.nodes_mm[static_cast<std::size_t>(b)]);
    graph.distance_mm.push_back(static_cast<float>(std::max(length, 1e-6)));
  }
  for (std::size_t n = 1; n < graph.start.size(); ++n) graph.start[n] += graph.start[n - 1];
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
  std::sort(active.begin(), active.end());
  active.erase(std::unique(active.begin(), active.end()), active.end());
  std::vector<double> slope(axes.size());
  std::vector<AxisTensor> next(filled.size());
  for (int sweep = 0; sweep < iterations; ++sweep) {
    parallel::parallel_for(0, static_cast<std::int64_t>(active.size()), [&](std::int64_t begin, std::int64_t end) {
      for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n)
        slope[active[n]] = unknown[active[n]] ? 0 : inverse_slope(graph, axes, unknown, active[n]);
    });
    parallel::parallel_for(0, static_cast<std::int64_t>(filled.size()), [&](std::int64_t begin, std::int64_t end) {
      for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n)
        next[n] = relaxed(graph, axes, slope, unknown, filled[n]);
    });
    for (std::size_t n = 0; n < filled.size(); ++n) axes[filled[n]] = next[n];
  }
  for (const auto e : filled) {
    axes[e] = atlas::axis_tensor(atlas::leading_axis(axes[e]));
    missing[e] = 0;
  }
  return static_cast<std::int64_t>(filled.size());
}

}  // namespace heart::fibers
