// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/naming/pieces.hpp"

#include <algorithm>

#include "generator/chest/working_image.hpp"
#include "generator/image/components.hpp"
#include "generator/image/distance.hpp"
#include "generator/naming/priors.hpp"

namespace heartgen::naming {
namespace {

constexpr double brighter_level = 0.2;  // below, contrast is weak: more smoothing
constexpr double gap_mm = 2.5;          // between the pieces of two levels: partial volume
constexpr double shallowest_mm = 4;     // of weak blood: less is a vessel of the lung, or noise
constexpr double speck_mm3 = 250;       // smaller holes and walls are noise

/// Blood above the threshold that no brighter level has taken.
Mask blood_above(const Scene& scene, const Levels& levels, const Mask& valley, double threshold,
                 const Volume<std::int32_t>& taken) {
  const bool is_weak = threshold <= levels.muscle_hu + brighter_level * levels.contrast_hu();
  const auto& hu = (is_weak ? scene.smoother : scene.smooth).voxels;
  return chest::mask_where(scene.hu.grid, [&](const Vec3&, std::size_t v) {
    return static_cast<double>(hu[v]) > threshold && scene.room.voxels[v] && !valley.voxels[v] && taken.voxels[v] == 0;
  });
}

/// The part of it that is deep, and not the partial volume around what is taken.
Mask deep_part(const Mask& blood, const Volume<std::int32_t>& taken) {
  const auto beside = image::distance_to(
      chest::mask_where(blood.grid, [&](const Vec3&, std::size_t v) { return taken.voxels[v] > 0; }));
  const Mask free = chest::mask_where(blood.grid, [&](const Vec3&, std::size_t v) {
    return blood.voxels[v] && static_cast<double>(beside.voxels[v]) > gap_mm;
  });
  const auto depth = chest::depth_of(free);
  const auto core = image::distance_to(chest::mask_where(
      blood.grid, [&](const Vec3&, std::size_t v) { return static_cast<double>(depth.voxels[v]) > shallowest_mm; }));
  constexpr double and_a_little_mm = 0.5;
  return chest::mask_where(blood.grid, [&](const Vec3&, std::size_t v) {
    return free.voxels[v] && static_cast<double>(core.voxels[v]) <= shallowest_mm + and_a_little_mm;
  });
}

/// Distance to walls and to what is no blood; specks of either count as blood, and are added to it.
Volume<float> depth_between_walls(Mask& blood, const Mask& ridge) {
  const Mask solid =
      chest::mask_where(blood.grid, [&](const Vec3&, std::size_t v) { return !blood.voxels[v] || ridge.voxels[v]; });
  const auto speck = static_cast<std::int64_t>(speck_mm3 / blood.grid.voxel_volume_mm3());
  const Mask walls = image::drop_small_components(solid, speck);
  for (std::size_t v = 0; v < blood.voxels.size(); ++v)
    if (solid.voxels[v] && !walls.voxels[v]) blood.voxels[v] = 1;
  return image::distance_to(walls);
}

/// Blood on ridges joins the nearest basin, in rings of one voxel.
void fill_ridges(const Mask& blood, image::Basins& basins) {
  auto& label = basins.label;
  const std::array<std::int64_t, 3> stride{1, label.grid.size[0], label.grid.size[0] * label.grid.size[1]};
  std::vector<std::pair<std::size_t, std::int32_t>> ring;
  constexpr int thickest_ridge = 3;
  for (int n = 0; n < thickest_ridge; ++n) {
    ring.clear();
    std::size_t v = 0;
    for (std::int64_t k = 0; k < label.grid.size[2]; ++k)
      for (std::int64_t j = 0; j < label.grid.size[1]; ++j)
        for (std::int64_t i = 0; i < label.grid.size[0]; ++i, ++v) {
          if (!blood.voxels[v] || label.voxels[v] > 0 || basins.depth_mm.voxels[v] > 0) continue;
          const Index3 here{i, j, k};
          std::int32_t nearest = 0;
          for (std::size_t a = 0; a < 3 && nearest == 0; ++a) {
            if (here[a] > 0) nearest = label.voxels[v - static_cast<std::size_t>(stride[a])];
            if (nearest == 0 && here[a] + 1 < label.grid.size[a])
              nearest = label.voxels[v + static_cast<std::size_t>(stride[a])];
          }
          if (nearest > 0) ring.emplace_back(v, nearest);
        }
    for (const auto& [voxel, name] : ring) label.voxels[voxel] = name;
  }
}

}  // namespace

Pieces cut_into_pieces(const Scene& scene, const Levels& levels, const Walls& walls) {
  constexpr double least_tolerance_hu = 25, tolerance_share = 0.12;
  constexpr float bright_peak_mm = 3, weak_peak_mm = 4, min_drop_mm = 0.5, never = 2;
  Pieces pieces{Volume<std::int32_t>(scene.hu.grid), {0}};
  for (const double threshold : thresholds(walls.flat, levels, walls.noise_hu)) {
    const bool is_first = pieces.level.size() == 1;
    Mask blood = blood_above(scene, levels, walls.valley, threshold, pieces.label);
    if (!is_first) blood = deep_part(blood, pieces.label);
    const auto depth = depth_between_walls(blood, walls.ridge);
    auto basins = image::divide_at_constrictions(depth, {is_first ? bright_peak_mm : weak_peak_mm, min_drop_mm, never});
    fill_ridges(blood, basins);
    join_basins(basins, scene.smooth, std::max(least_tolerance_hu, tolerance_share * levels.contrast_hu()));
    cut_off_trunks(basins);
    const auto before = static_cast<std::int32_t>(pieces.level.size()) - 1;
    for (std::size_t v = 0; v < blood.voxels.size(); ++v)
      if (basins.label.voxels[v] > 0 && pieces.label.voxels[v] == 0)
        pieces.label.voxels[v] = basins.label.voxels[v] + before;
    pieces.level.insert(pieces.level.end(), static_cast<std::size_t>(basins.count),
                        (threshold - levels.muscle_hu) / levels.contrast_hu());
  }
  drop_rim(scene, pieces);
  return pieces;
}

void drop_rim(const Scene& scene, Pieces& pieces) {
  std::vector<double> voxels(pieces.level.size(), 0), depth(pieces.level.size(), 0);
  for (std::size_t v = 0; v < pieces.label.voxels.size(); ++v) {
    const auto label = static_cast<std::size_t>(pieces.label.voxels[v]);
    voxels[label] += 1;
    depth[label] += static_cast<double>(scene.room_depth_mm.voxels[v]);
  }
  const double voxel_ml = scene.hu.grid.voxel_volume_mm3() / 1000;
  std::vector<std::int32_t> number(pieces.level.size(), 0);
  std::vector<double> level{0};
  for (std::size_t n = 1; n < number.size(); ++n) {
    if (voxels[n] * voxel_ml < no_part_ml && depth[n] < no_part_depth_mm * voxels[n]) continue;
    number[n] = static_cast<std::int32_t>(level.size());
    level.push_back(pieces.level[n]);
  }
  for (auto& label : pieces.label.voxels) label = number[static_cast<std::size_t>(label)];
  pieces.level = std::move(level);
}

void cut_off_trunks(image::Basins& basins) {
  constexpr double large_mm3 = 25e3, trunk_mm3 = 3e3, opening_share = 0.6, and_mm = 2;
  constexpr float trunk_depth_mm = 5;
  const Grid& grid = basins.label.grid;
  const double voxel_mm3 = grid.voxel_volume_mm3();
  const auto before = basins.count;
  for (std::int32_t piece = 1; piece <= before; ++piece) {
    const auto is_piece = [&](std::int32_t label) { return label == piece; };
    const Box box = bounding_box(basins.label, 1, is_piece);
    const auto label = crop(basins.label, box);
    const auto depth = crop(basins.depth_mm, box);
    float peak = 0;
    std::int64_t voxels = 0;
    for (std::size_t v = 0; v < label.voxels.size(); ++v) {
      if (label.voxels[v] != piece) continue;
      peak = std::max(peak, depth.voxels[v]);
      ++voxels;
    }
    if (static_cast<double>(voxels) * voxel_mm3 < large_mm3) continue;
    const double radius = opening_share * static_cast<double>(peak);
    const auto core = image::distance_to(chest::mask_where(label.grid, [&](const Vec3&, std::size_t v) {
      return label.voxels[v] == piece && static_cast<double>(depth.voxels[v]) > radius;
    }));
    const auto rest = image::connected_components(chest::mask_where(label.grid, [&](const Vec3&, std::size_t v) {
      return label.voxels[v] == piece && static_cast<double>(core.voxels[v]) > radius + and_mm;
    }));
    std::vector<float> deepest(rest.voxel_count.size(), 0);
    for (std::size_t v = 0; v < label.voxels.size(); ++v) {
      auto& d = deepest[static_cast<std::size_t>(rest.label.voxels[v])];
      d = std::max(d, depth.voxels[v]);
    }
    std::vector<std::int32_t> name(rest.voxel_count.size(), piece);
    for (std::size_t n = 1; n < name.size(); ++n)
      if (static_cast<double>(rest.voxel_count[n]) * voxel_mm3 > trunk_mm3 && deepest[n] > trunk_depth_mm)
        name[n] = ++basins.count;
    auto cut = label;
    for (std::size_t v = 0; v < label.voxels.size(); ++v)
      if (rest.label.voxels[v] > 0) cut.voxels[v] = name[static_cast<std::size_t>(rest.label.voxels[v])];
    paste(cut, box, basins.label);
  }
}

}  // namespace heartgen::naming
