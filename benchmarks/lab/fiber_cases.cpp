// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/lab/fiber_cases.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string_view>

#include "datasets/phantom/shapes.hpp"
#include "generator/image/isotropic_distance.hpp"
#include "generator/image/resample.hpp"
#include "generator/parallel/threads.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"
#include "model/mathematics.hpp"

namespace heartgen::lab {
namespace {

constexpr double uneven_mm = 0.4, uneven_over_mm = 5;

Vec3 center_of(const Grid& grid, std::size_t v) { return image::voxel_center(grid, static_cast<std::int64_t>(v)); }

Grid grid_around(const Landmarks& marks, const Vec3& spacing_mm) {
  constexpr double half_mm = 95;
  const Vec3 middle = 0.5 * (marks.seeds_mm.at("lv_blood") + marks.seeds_mm.at("rv_blood"));
  Grid grid;
  for (int axis = 0; axis < 3; ++axis)
    grid.size[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(2 * half_mm / spacing_mm[axis]);
  grid.spacing_mm = spacing_mm;
  grid.origin_mm = middle - Vec3{half_mm, half_mm, half_mm};
  return grid;
}

template <class RegionAt>
LabelVolume labels_on(const Grid& grid, RegionAt&& region_at) {
  LabelVolume labels(grid);
  parallel::parallel_for(0, grid.voxel_count(), [&](std::int64_t begin, std::int64_t end) {
    for (auto v = static_cast<std::size_t>(begin); v < static_cast<std::size_t>(end); ++v)
      labels.voxels[v] = tag(region_at(v));
  });
  return labels;
}

/// White noise under a Gaussian, whose correlation is one of twice the variance, brought to uneven_mm; the same places
/// whatever the labels' grid.
Volume<float> random_field(const Grid& labels, std::uint64_t key) {
  constexpr double spacing_mm = 1.2;
  Grid grid = labels;
  grid.spacing_mm = {spacing_mm, spacing_mm, spacing_mm};
  for (int axis = 0; axis < 3; ++axis)
    grid.size[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(
        static_cast<double>(labels.size[static_cast<std::size_t>(axis)]) * labels.spacing_mm[axis] / spacing_mm);
  Volume<float> field(grid);
  parallel::parallel_for(0, grid.voxel_count(), [&](std::int64_t begin, std::int64_t end) {
    for (auto v = static_cast<std::size_t>(begin); v < static_cast<std::size_t>(end); ++v)
      field.voxels[v] = static_cast<float>(phantom::random_symmetric(key, v));
  });
  field = image::smoothed(field, uneven_over_mm / 2 / grid.spacing_mm.x);
  double squares = 0;
  for (const float x : field.voxels) squares += double{x} * x;
  const double scale = uneven_mm / std::sqrt(squares / static_cast<double>(field.voxels.size()));
  for (float& x : field.voxels) x = static_cast<float>(scale * x);
  return field;
}

using Displacement = std::array<Volume<float>, 3>;

Displacement random_displacement(const Grid& grid, std::uint64_t key) {
  return {random_field(grid, key), random_field(grid, key + 1), random_field(grid, key + 2)};
}

Vec3 moved(const Displacement& by, const Vec3& point_mm) {
  const Vec3 at = index_from_lps(by[0].grid, point_mm);
  return point_mm + Vec3{sample_linear(by[0], at), sample_linear(by[1], at), sample_linear(by[2], at)};
}

/// Blood, and what stands in it.
bool is_pool(Region region) { return is_blood(region) || region == Region::papillary; }

/// Ventricles alone, up to a plane `below_mm` under the mitral valve and tilted against the long axis: what other
/// people's segmentations look like.
void cut_labels(FiberCase& heart, double below_mm, double tilt_deg) {
  const Vec3 up = phantom::long_axis(heart.model);
  const Vec3 side = normalized(cross(up, Vec3{0, 0, 1}));
  const double tilt = tilt_deg * std::numbers::pi / 180;
  const Vec3 normal = math::cos(tilt) * up + math::sin(tilt) * side;
  const Vec3 point = heart.landmarks.valves.at("mitral").center_mm - below_mm * up;
  for (std::size_t v = 0; v < heart.labels.voxels.size(); ++v) {
    auto& label = heart.labels.voxels[v];
    const auto region = static_cast<Region>(label);
    const bool ventricle = region == Region::lv_myocardium || region == Region::rv_myocardium ||
                           region == Region::papillary || region == Region::lv_blood || region == Region::rv_blood;
    if (!ventricle || dot(center_of(heart.labels.grid, v) - point, normal) > 0) label = 0;
  }
  heart.landmarks = {};
}

constexpr std::string_view uneven = "uneven";

// Of the phantom that a case is made from.
int variant_of(const std::string& name) {
  int variant = 1;
  if (name == "thick" || name == "dilated" || name == "cut" || name == "tilted" || name == uneven) return variant;
  std::string_view digits = name;
  if (digits.starts_with(uneven)) digits.remove_prefix(uneven.size());
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), variant);
  if (error != std::errc{} || end != digits.data() + digits.size() || variant < 0)
    throw UserError(fmt::format("\"{}\" is no phantom", name), "--cases",
                    "give variants and the words thick, dilated, cut, tilted, uneven (uneven3: of variant 3)");
  return variant;
}

}  // namespace

LabelVolume exact_labels(const phantom::HeartModel& model, const Landmarks& marks, const Vec3& spacing_mm) {
  const Grid grid = grid_around(marks, spacing_mm);
  return labels_on(grid, [&](std::size_t v) { return phantom::region_at(model, center_of(grid, v)); });
}

LabelVolume uneven_labels(const phantom::HeartModel& model, const Landmarks& marks, const Vec3& spacing_mm,
                          std::uint64_t seed) {
  const Grid grid = grid_around(marks, spacing_mm);
  const auto of_pools = random_displacement(grid, 8 * seed), of_others = random_displacement(grid, 8 * seed + 4);
  return labels_on(grid, [&](std::size_t v) {
    const Region pool = phantom::region_at(model, moved(of_pools, center_of(grid, v)));
    if (is_pool(pool)) return pool;
    const Region other = phantom::region_at(model, moved(of_others, center_of(grid, v)));
    return is_pool(other) ? pool : other;
  });
}

FiberCase make_fiber_case(const std::string& name, const Vec3& spacing_mm) {
  constexpr double flat_cut_mm = 6;  // below the valves' plates
  FiberCase heart;
  heart.name = name;
  phantom::HeartOverrides overrides;
  if (name == "thick") overrides.lv_wall_mm = 14;
  if (name == "dilated") overrides.lv_wall_mm = 7;
  const int variant = variant_of(name);
  heart.model = phantom::make_heart_model(variant, overrides);
  heart.landmarks = phantom::landmarks_of(heart.model);
  heart.labels = name.starts_with(uneven)
                     ? uneven_labels(heart.model, heart.landmarks, spacing_mm, static_cast<std::uint64_t>(variant))
                     : exact_labels(heart.model, heart.landmarks, spacing_mm);
  if (name == "cut") cut_labels(heart, 12, 0);
  if (name == "tilted") cut_labels(heart, flat_cut_mm, 15);
  return heart;
}

void check_fiber_case(const std::string& name) { variant_of(name); }

}  // namespace heartgen::lab
