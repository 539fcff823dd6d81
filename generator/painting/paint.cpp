// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/painting/paint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <tuple>
#include <utility>

#include "generator/parallel/threads.hpp"
#include "model/crop.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"

namespace heartgen::painting {
namespace {

using Weights = std::array<double, 4>;  // barycentric

/// The centres of n^3 parts of equal volume of a tetrahedron: the simplex 0 <= x <= y <= z <= 1 cut by the grid of
/// width 1/n, whose cubes fall into six such simplices each (Kuhn).
std::vector<Weights> sample_points(int n) {
  constexpr int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  std::vector<Weights> points;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j <= k; ++j)
      for (int i = 0; i <= j; ++i)
        for (const auto& order : orders) {
          const std::array<int, 3> corner{i, j, k};
          std::array<double, 3> x;
          for (int step = 0; step < 3; ++step)  // the centre: the axis that is stepped along first is the highest
            x[static_cast<std::size_t>(order[step])] =
                (static_cast<double>(corner[static_cast<std::size_t>(order[step])]) + 0.75 - 0.25 * step) / n;
          if (x[0] <= x[1] && x[1] <= x[2]) points.push_back({x[0], x[1] - x[0], x[2] - x[1], 1 - x[2]});
        }
  return points;
}

constexpr int min_parts = 3, max_parts = 8;  // along an edge

/// Enough that neighbouring points lie in neighbouring voxels.
int parts_for(double edge_mm, double voxel_mm) {
  return std::clamp(static_cast<int>(std::ceil(edge_mm / voxel_mm)) + 1, min_parts, max_parts);
}

bool holds(const Mask& mask, const Vec3& lps_mm) {
  const Vec3 index = index_from_lps(mask.grid, lps_mm);
  const auto i = std::llround(index.x), j = std::llround(index.y), k = std::llround(index.z);
  return mask.grid.contains(i, j, k) && mask(i, j, k) != 0;
}

struct BoxMm {
  Vec3 low, high;
  bool meets(const BoxMm& other) const {
    for (int axis = 0; axis < 3; ++axis)
      if (low[axis] > other.high[axis] || other.low[axis] > high[axis]) return false;
    return true;
  }
};

BoxMm box_of(std::span<const Vec3> points) {
  constexpr double far = std::numeric_limits<double>::max();
  BoxMm box{{far, far, far}, {-far, -far, -far}};
  for (const auto& p : points)
    for (int axis = 0; axis < 3; ++axis) {
      box.low[axis] = std::min(box.low[axis], p[axis]);
      box.high[axis] = std::max(box.high[axis], p[axis]);
    }
  return box;
}

/// Around the voxels, not only their centres.
BoxMm box_of(const Grid& grid) {
  std::array<Vec3, 8> corners;
  for (std::size_t c = 0; c < 8; ++c) {
    Vec3 index;
    for (int axis = 0; axis < 3; ++axis)
      index[axis] = (c >> axis & 1U) != 0 ? static_cast<double>(grid.size[static_cast<std::size_t>(axis)]) - 0.5 : -0.5;
    corners[c] = lps_from_index(grid, index);
  }
  return box_of(corners);
}

/// What a cell has of each region: all of its points there, and those in no region before.
struct Share {
  std::vector<float> all, own;
};

/// Samples cells for regions that lie near them.
struct Sampler {
  const TetMesh& mesh;
  const std::vector<RegionMask>& regions;
  std::vector<BoxMm> boxes;
  double voxel_mm;
  std::array<std::vector<Weights>, max_parts + 1> points{};

  Sampler(const TetMesh& mesh_, const std::vector<RegionMask>& regions_)
      : mesh(mesh_), regions(regions_), voxel_mm(std::numeric_limits<double>::max()) {
    for (const auto& region : regions) {
      boxes.push_back(box_of(region.mask.grid));
      const Vec3& s = region.mask.grid.spacing_mm;
      voxel_mm = std::min({voxel_mm, s.x, s.y, s.z});
    }
    for (int n = min_parts; n <= max_parts; ++n) points[static_cast<std::size_t>(n)] = sample_points(n);
  }

  std::array<Vec3, 4> corners(std::size_t cell) const {
    std::array<Vec3, 4> p;
    for (std::size_t n = 0; n < 4; ++n) p[n] = mesh.nodes_mm[static_cast<std::size_t>(mesh.cells[cell][n])];
    return p;
  }

  /// Empty where no region is near.
  Share share_of(std::size_t cell) const {
    const auto p = corners(cell);
    const BoxMm box = box_of(p);
    if (std::none_of(boxes.begin(), boxes.end(), [&](const BoxMm& b) { return b.meets(box); })) return {};
    Share share{std::vector<float>(regions.size()), std::vector<float>(regions.size())};
    const auto& at = points[static_cast<std::size_t>(parts_for(norm(box.high - box.low), voxel_mm))];
    const float one = 1 / static_cast<float>(at.size());
    for (const auto& w : at) {
      const Vec3 point = w[0] * p[0] + w[1] * p[1] + w[2] * p[2] + w[3] * p[3];
      bool is_taken = false;
      for (std::size_t r = 0; r < regions.size(); ++r) {
        if (!holds(regions[r].mask, point)) continue;
        share.all[r] += one;
        if (!std::exchange(is_taken, true)) share.own[r] += one;
      }
    }
    for (auto& value : share.all) value = std::min(value, 1.0F);
    return share;
  }
};

/// A cell that may count for a region.
struct Candidate {
  float share;
  std::int32_t cell, region;
  bool operator<(const Candidate& other) const {  // most first
    return std::tie(other.share, cell, region) < std::tie(share, other.cell, other.region);
  }
};

/// Gives cells to regions, those that hold most of one first, as long as that brings its volume nearer.
void tag_cells(TetMesh& mesh, std::vector<Candidate> candidates, std::vector<double> left_mm3) {
  std::sort(candidates.begin(), candidates.end());
  for (const auto& [share, cell, region] : candidates) {
    auto& tag = mesh.user_region[static_cast<std::size_t>(cell)];
    auto& left = left_mm3[static_cast<std::size_t>(region)];
    const double volume = cell_volume_mm3(mesh, mesh.cells[static_cast<std::size_t>(cell)]);
    if (tag != 0 || volume > 2 * left) continue;
    tag = first_user_region + region;
    left -= volume;
  }
}

Grid turned(Grid grid) {
  for (int axis = 0; axis < 2; ++axis) {
    grid.origin_mm[axis] = -grid.origin_mm[axis];
    auto& row = grid.direction.rows[static_cast<std::size_t>(axis)];
    row = -1.0 * row;
  }
  return grid;
}

bool touches(const Mask& mask, const Grid& grid, const Target& target) {
  std::size_t v = 0;
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i, ++v)
        if (mask.voxels[v] != 0 && target.holds(lps_from_index(
                                       grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)})))
          return true;
  return false;
}

double gap_mm(const BoxMm& a, const Target& b) {
  Vec3 gap;
  for (int axis = 0; axis < 3; ++axis)
    gap[axis] = std::max({0.0, a.low[axis] - b.high_mm[axis], b.low_mm[axis] - a.high[axis]});
  return norm(gap);
}

}  // namespace

void paint(TetMesh& mesh, const std::vector<RegionMask>& regions,
           const std::function<bool(std::int32_t region)>& takes) {
  const Sampler sampler(mesh, regions);
  mesh.user_regions.clear();
  for (std::size_t r = 0; r < regions.size(); ++r)
    mesh.user_regions.push_back(
        {regions[r].name, first_user_region + static_cast<std::int32_t>(r), std::vector<float>(mesh.cells.size())});
  mesh.user_region.assign(mesh.cells.size(), 0);
  std::vector<Share> shares(mesh.cells.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(shares.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto c = static_cast<std::size_t>(begin); c < static_cast<std::size_t>(end); ++c)
      if (takes(mesh.region[c])) shares[c] = sampler.share_of(c);
  });
  std::vector<Candidate> candidates;
  std::vector<double> own_mm3(regions.size(), 0);
  for (std::size_t c = 0; c < shares.size(); ++c)
    for (std::size_t r = 0; r < shares[c].all.size(); ++r) {
      mesh.user_regions[r].fraction[c] = shares[c].all[r];
      if (shares[c].own[r] == 0) continue;
      own_mm3[r] += static_cast<double>(shares[c].own[r]) * cell_volume_mm3(mesh, mesh.cells[c]);
      candidates.push_back({shares[c].own[r], static_cast<std::int32_t>(c), static_cast<std::int32_t>(r)});
    }
  tag_cells(mesh, std::move(candidates), own_mm3);
}

double volume_mm3(const Mask& mask) {
  return static_cast<double>(std::count(mask.voxels.begin(), mask.voxels.end(), 1)) * mask.grid.voxel_volume_mm3();
}

double volume_mm3(const TetMesh& mesh, const UserRegion& region) {
  double volume = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (region.fraction[c] > 0)
      volume += static_cast<double>(region.fraction[c]) * cell_volume_mm3(mesh, mesh.cells[c]);
  return volume;
}

Target walls_of(const LabelVolume& labels) {
  Target target{"the heart's walls", {}, {}, {}};
  std::vector<Vec3> ends;
  const auto box =
      bounding_box(labels, 0, [](std::uint8_t label) { return is_myocardium(static_cast<Region>(label)); });
  for (const auto& index : {box.begin, box.end})
    ends.push_back(lps_from_index(
        labels.grid, {static_cast<double>(index[0]), static_cast<double>(index[1]), static_cast<double>(index[2])}));
  const BoxMm around = box_of(ends);
  target.low_mm = around.low;
  target.high_mm = around.high;
  target.holds = [&labels](const Vec3& lps_mm) {
    const Vec3 at = index_from_lps(labels.grid, lps_mm);
    const auto i = std::llround(at.x), j = std::llround(at.y), k = std::llround(at.z);
    return labels.grid.contains(i, j, k) && is_myocardium(static_cast<Region>(labels(i, j, k)));
  };
  return target;
}

void refuse_regions_elsewhere(const std::vector<RegionMask>& regions, const Target& target) {
  for (const auto& region : regions) {
    const Grid& grid = region.mask.grid;
    if (touches(region.mask, grid, target)) continue;
    const double gap = gap_mm(box_of(grid), target);
    const auto where = gap > 0 ? fmt::format("{:.0f} mm away from {}", gap, target.what)
                               : fmt::format("beside {}, in the box around it", target.what);
    throw UserError(fmt::format("the region \"{}\" lies {}", region.name, where), region.file,
                    touches(region.mask, turned(grid), target)
                        ? "it lies there with x and y turned: write it in LPS, not in RAS"
                        : "give one of the same patient, in the same frame (LPS, mm)");
  }
}

void carry_regions_to_parent(const TetMesh& part, TetMesh& whole) {
  if (part.user_regions.empty() || part.parent_cell.empty()) return;
  whole.user_region.assign(whole.cells.size(), 0);
  whole.user_regions.clear();
  for (const auto& region : part.user_regions)
    whole.user_regions.push_back({region.name, region.tag, std::vector<float>(whole.cells.size())});
  for (std::size_t c = 0; c < part.cells.size(); ++c) {
    const auto there = static_cast<std::size_t>(part.parent_cell[c]);
    whole.user_region[there] = part.user_region[c];
    for (std::size_t r = 0; r < part.user_regions.size(); ++r)
      whole.user_regions[r].fraction[there] = part.user_regions[r].fraction[c];
  }
}

}  // namespace heartgen::painting
