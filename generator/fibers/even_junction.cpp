#include "generator/fibers/even_junction.hpp"

#include "generator/parallel/threads.hpp"

namespace heart::fibers {
namespace {

using atlas::AxisTensor;

AxisTensor relaxed_axis(const NeighborGraph& graph, const std::vector<AxisTensor>& axes, std::size_t e) {
  AxisTensor sum;
  for (auto n = static_cast<std::size_t>(graph.start[e]); n < static_cast<std::size_t>(graph.start[e + 1]); ++n) {
    const double h = graph.distance_mm[n];
    sum += (1 / (h * h)) * axes[static_cast<std::size_t>(graph.neighbor[n])];
  }
  return trace(sum) > 0 ? atlas::axis_tensor(atlas::leading_axis(sum)) : axes[e];
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

}  // namespace heart::fibers
