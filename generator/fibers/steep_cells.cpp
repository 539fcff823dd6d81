#include "generator/fibers/steep_cells.hpp"

#include <cmath>

#include "generator/fibers/frame.hpp"
#include "generator/parallel/threads.hpp"
#include "model/labels.hpp"

namespace heart::fibers {
namespace {

bool is_ventricular(std::int32_t region) {
  return region == tag(Region::lv_myocardium) || region == tag(Region::rv_myocardium);
}

bool is_steep(const Cell& cell, const FiberField& node) {
  constexpr double most_cosine = 0.906;  // 25 degrees
  for (std::size_t a = 0; a < 4; ++a)
    for (std::size_t b = a + 1; b < 4; ++b)
      if (std::abs(dot(node.fiber[static_cast<std::size_t>(cell[a])], node.fiber[static_cast<std::size_t>(cell[b])])) <
          most_cosine)
        return true;
  return false;
}

Vec3 centroid(const TetMesh& mesh, const Cell& cell) {
  Vec3 sum;
  for (const auto node : cell) sum += mesh.nodes_mm[static_cast<std::size_t>(node)];
  return sum / 4;
}

}  // namespace

void carry_to_steep_cells(const Hearts& hearts, const TetMesh& mesh, const FiberField& node, const std::string& method,
                          FiberField& cell) {
  std::vector<std::uint8_t> is_chosen(mesh.cells.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(mesh.cells.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto c = static_cast<std::size_t>(begin); c < static_cast<std::size_t>(end); ++c)
      is_chosen[c] = is_ventricular(mesh.region[c]) && is_steep(mesh.cells[c], node);
  });
  std::vector<std::size_t> steep;
  std::vector<Vec3> points;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    if (!is_chosen[c]) continue;
    steep.push_back(c);
    points.push_back(centroid(mesh, mesh.cells[c]));
  }
  const auto walls = point_walls(hearts, points, std::vector<std::uint8_t>(points.size(), 1));
  const auto axes = carried_axes(hearts, walls, points, atlas_positions(hearts, points), method);
  parallel::parallel_for(0, static_cast<std::int64_t>(steep.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n) {
      if (!walls.known[n] || trace(axes[n]) <= 0) continue;
      const auto frame = material_axes(atlas::leading_axis(axes[n]), walls.main(n).normal);
      cell.fiber[steep[n]] = frame.fiber;
      cell.sheet[steep[n]] = frame.sheet;
      cell.sheet_normal[steep[n]] = frame.sheet_normal;
    }
  });
}

}  // namespace heart::fibers
