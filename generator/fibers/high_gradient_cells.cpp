// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/fibers/high_gradient_cells.hpp"

#include <algorithm>
#include <cmath>

#include "generator/fibers/frame.hpp"
#include "generator/parallel/threads.hpp"
#include "model/labels.hpp"

namespace heartgen::fibers {
namespace {

bool is_ventricular(std::int32_t region) {
  return region == tag(Region::lv_myocardium) || region == tag(Region::rv_myocardium);
}

/// The least cosine of an angle between fibres at two of the cell's nodes.
double min_cosine(const Cell& cell, const FiberField& node) {
  double least = 1;
  for (std::size_t a = 0; a < 4; ++a)
    for (std::size_t b = a + 1; b < 4; ++b)
      least = std::min(least, std::abs(dot(node.fiber[static_cast<std::size_t>(cell[a])],
                                           node.fiber[static_cast<std::size_t>(cell[b])])));
  return least;
}

Vec3 centroid(const TetMesh& mesh, const Cell& cell) {
  Vec3 sum;
  for (const auto node : cell) sum += mesh.nodes_mm[static_cast<std::size_t>(node)];
  return sum / 4;
}

/// Cells that are carried to, and where.
struct SteepCells {
  std::vector<std::size_t> number;
  std::vector<Vec3> centroid_mm;
  void add(const TetMesh& mesh, std::size_t c) {
    number.push_back(c);
    centroid_mm.push_back(centroid(mesh, mesh.cells[c]));
  }
};

PointWalls walls_at(const RegisteredPair& hearts, const std::vector<Vec3>& points_mm) {
  return point_walls(hearts, points_mm, std::vector<std::uint8_t>(points_mm.size(), 1));
}

void set(FiberField& cell, std::size_t c, const AxisTensor& axis, const Vec3& normal) {
  const auto frame = material_axes(leading_axis(axis), normal);
  cell.fiber[c] = frame.fiber;
  cell.sheet[c] = frame.sheet;
  cell.sheet_normal[c] = frame.sheet_normal;
}

/// The fits of one wall at the cell's nodes, in `found`; fewer than four where that wall does not have them all.
void fits_at(const Cell& cell, const WallFits& wall, std::vector<const AngleFit*>& found) {
  found.clear();
  for (const auto n : cell)
    if (const auto fit = wall.of_point[static_cast<std::size_t>(n)]; fit >= 0)
      found.push_back(&wall.fits[static_cast<std::size_t>(fit)]);
}

/// Returns those that the fits at their nodes are not enough for.
SteepCells carry_between_nodes(const RegisteredPair& hearts, const TetMesh& mesh, const SteepCells& steep,
                               const FittedAxes& carried, const std::string& method, FiberField& cell) {
  const auto walls = walls_at(hearts, steep.centroid_mm);
  const auto atlas_mm = atlas_positions(hearts, steep.centroid_mm);
  std::vector<std::uint8_t> done(steep.number.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(done.size()), [&](std::int64_t begin, std::int64_t end) {
    std::vector<const AngleFit*> fits;
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n) {
      const bool left = walls.left_share[n] >= 1;
      if (!walls.known[n] || (!left && walls.left_share[n] > 0)) continue;
      fits_at(mesh.cells[steep.number[n]], left ? carried.fits.lv : carried.fits.rv, fits);
      if (fits.size() < 4) continue;
      const auto& at = walls.main(n);
      const auto local = between_fits(fits, feature_of(hearts, left, method, steep.centroid_mm[n], atlas_mm[n], at));
      set(cell, steep.number[n], in_patient_frame(local, at), at.normal);
      done[n] = 1;
    }
  });
  SteepCells left_over;
  for (std::size_t n = 0; n < done.size(); ++n)
    if (!done[n]) left_over.add(mesh, steep.number[n]);
  return left_over;
}

void carry_to_centroids(const RegisteredPair& hearts, const SteepCells& steep, const std::string& method,
                        FiberField& cell) {
  const auto walls = walls_at(hearts, steep.centroid_mm);
  const auto axes =
      carried_axes(hearts, walls, steep.centroid_mm, atlas_positions(hearts, steep.centroid_mm), method).axes;
  for (std::size_t n = 0; n < axes.size(); ++n)
    if (walls.known[n] && trace(axes[n]) > 0) set(cell, steep.number[n], axes[n], walls.main(n).normal);
}

}  // namespace

void carry_to_steep_cells(const RegisteredPair& hearts, const TetMesh& mesh, const FiberField& node,
                          const FittedAxes& carried, const std::string& method, FiberField& cell) {
  constexpr double steep = 0.906, too_steep = 0.5;  // 25 degrees; 60, beyond which a cubic is no good guess
  std::vector<double> cosine(mesh.cells.size(), 1);
  parallel::parallel_for(0, static_cast<std::int64_t>(mesh.cells.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto c = static_cast<std::size_t>(begin); c < static_cast<std::size_t>(end); ++c)
      if (is_ventricular(mesh.region[c])) cosine[c] = min_cosine(mesh.cells[c], node);
  });
  const bool fitted = !carried.fits.lv.fits.empty() || !carried.fits.rv.fits.empty();
  SteepCells between, single;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (cosine[c] < steep) (fitted && cosine[c] > too_steep ? between : single).add(mesh, c);
  const auto left_over = carry_between_nodes(hearts, mesh, between, carried, method, cell);
  for (const auto c : left_over.number) single.add(mesh, c);
  carry_to_centroids(hearts, single, method, cell);
}

}  // namespace heartgen::fibers
