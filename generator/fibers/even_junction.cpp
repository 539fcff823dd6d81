// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/fibers/even_junction.hpp"

#include <cmath>

#include "generator/parallel/threads.hpp"
#include "model/priors.hpp"

namespace heartgen::fibers {
namespace {

AxisTensor relaxed_axis(const NeighborGraph& graph, const std::vector<AxisTensor>& axes, std::size_t e) {
  AxisTensor sum;
  for (auto n = static_cast<std::size_t>(graph.start[e]); n < static_cast<std::size_t>(graph.start[e + 1]); ++n) {
    const double h = graph.distance_mm[n];
    sum += (1 / (h * h)) * axes[static_cast<std::size_t>(graph.neighbor[n])];
  }
  return trace(sum) > 0 ? axis_tensor(leading_axis(sum)) : axes[e];
}

/// Length of the element's edges; 0 where it has none.
double mean_edge_mm(const NeighborGraph& graph, std::size_t e) {
  double sum = 0;
  for (auto n = static_cast<std::size_t>(graph.start[e]); n < static_cast<std::size_t>(graph.start[e + 1]); ++n)
    sum += double{graph.distance_mm[n]};
  const auto count = graph.start[e + 1] - graph.start[e];
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

}  // namespace

void relax_axes(const NeighborGraph& graph, const std::vector<std::uint8_t>& blended, int iterations,
                std::vector<AxisTensor>& axes) {
  std::vector<std::size_t> elements;
  for (std::size_t e = 0; e < axes.size(); ++e)
    if (blended[e] && trace(axes[e]) > 0) elements.push_back(e);
  std::vector<AxisTensor> next(elements.size());
  for (int sweep = 0; sweep < iterations; ++sweep) {
    parallel::parallel_for(0, static_cast<std::int64_t>(elements.size()), [&](std::int64_t begin, std::int64_t end) {
      for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n)
        next[n] = relaxed_axis(graph, axes, elements[n]);
    });
    for (std::size_t n = 0; n < elements.size(); ++n) axes[elements[n]] = next[n];
  }
}

void turn_evenly(const NeighborGraph& graph, const std::vector<double>& from_junction_mm,
                 std::vector<AxisTensor>& axes) {
  const double width_mm = priors::wall_junction_mm;
  constexpr double sweeps_per_square = 4;  // of the edges across: some 30 sweeps at edges of 1.8 mm
  std::vector<std::uint8_t> blended(axes.size());
  double edges_mm = 0, count = 0;
  for (std::size_t e = 0; e < axes.size(); ++e) {
    if (from_junction_mm[e] >= width_mm / 2) continue;
    const double edge_mm = mean_edge_mm(graph, e);
    blended[e] = edge_mm > 0 && from_junction_mm[e] < (width_mm - edge_mm) / 2;
    if (!blended[e]) continue;
    edges_mm += edge_mm;
    ++count;
  }
  if (count == 0) return;
  const double across = width_mm * count / edges_mm;
  relax_axes(graph, blended, static_cast<int>(std::ceil(sweeps_per_square * across * across)), axes);
}

}  // namespace heartgen::fibers
