// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/active_contours.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "generator/pde/level_set_motion.hpp"
#include "generator/pde/redistance.hpp"
#include "generator/pde/spacing.hpp"
#include "model/error.hpp"

namespace heartgen::pde {
namespace {

using parallel::Comm;
using parallel::Slab;

constexpr int steps_between_redistances = 10;
constexpr int redistance_steps = 14;  // half a voxel each: farther than the contour moves in between

void check(const ContourSettings& s) {
  const char* where = s.model == ContourModel::geodesic ? "geodesic contour" : "geometric contour";
  if (!(s.curvature_mm >= 0)) throw UserError("the curvature must not be negative", where, "0 leaves it out");
  if (!(s.attraction_mm >= 0)) throw UserError("the attraction must not be negative", where, "0 leaves it out");
  if (s.max_iterations < 0) throw UserError("iterations must not be negative", where, "");
  if (!(s.tolerance >= 0)) throw UserError("the tolerance must not be negative", where, "0 never settles");
  if (!std::isfinite(s.balloon) || (s.balloon == 0 && s.curvature_mm == 0 && s.attraction_mm == 0))
    throw UserError("nothing moves the contour", where, "give a curvature or a balloon");
}

MotionTerms terms_of(const ContourSettings& s) {
  if (s.model == ContourModel::geodesic) return {0, s.curvature_mm, s.attraction_mm, s.balloon};
  if (s.curvature_on_edges) return {s.curvature_mm, 0, 0, s.balloon};
  return {0, s.curvature_mm, 0, s.balloon};
}

std::int64_t count_inside(const Slab<float>& phi, const Comm& comm) {
  return parallel::sum_int64(comm, std::ranges::count_if(phi.owned(), [](float v) { return v < 0; }));
}

/// Share of the voxels beside the contour that are on another side than before. The values of φ tell less: edges press
/// its level sets together between two redistances.
double changed_share(const Slab<float>& now, const Slab<float>& before, const Comm& comm) {
  const auto near = static_cast<float>(smallest_spacing(now.grid));
  std::int64_t changed = 0, beside = 0;
  const auto a = now.owned(), b = before.owned();
  for (std::size_t v = 0; v < a.size(); ++v) {
    beside += std::abs(a[v]) < near;
    changed += (a[v] < 0) != (b[v] < 0);
  }
  changed = parallel::sum_int64(comm, changed);
  beside = parallel::sum_int64(comm, beside);
  return static_cast<double>(changed) / static_cast<double>(std::max<std::int64_t>(beside, 1));
}

/// Time between two looks at the contour: a circle of ten voxels' radius moves by a voxel, a balloon by two voxels.
double check_time(const ContourSettings& s, const Grid& grid) {
  const double h = smallest_spacing(grid), bend = std::max(s.curvature_mm, s.attraction_mm);
  return std::max(bend > 0 ? 10 * h * h / bend : 0, s.balloon != 0 ? 2 * h / std::abs(s.balloon) : 0);
}

}  // namespace

const char* name_of(ContourEnd end) {
  switch (end) {
    case ContourEnd::settled:
      return "settled";
    case ContourEnd::vanished:
      return "vanished";
    case ContourEnd::filled_the_image:
      return "filled the image";
    case ContourEnd::out_of_iterations:
      break;
  }
  return "out of iterations";
}

ContourResult evolve_contour(const Slab<float>& start, const Slab<float>& h, const ContourSettings& settings,
                             const Comm& comm) {
  check(settings);
  const auto all = start.grid.voxel_count();
  if (const auto n = count_inside(start, comm); n == 0 || n == all)
    throw UserError("the contour has no inside or no outside at the start", "active contour",
                    "check the seed and the radius");
  const MotionTerms terms = terms_of(settings);
  const double step = stable_step(h, terms, comm);
  ContourResult result{start, ContourEnd::out_of_iterations, 0, 0};
  redistance(result.level_set, {2 * redistance_steps}, comm);
  Slab<float> before = result.level_set;
  double next_check = check_time(settings, start.grid);
  while (result.iterations < settings.max_iterations) {
    const int steps = std::min(steps_between_redistances, settings.max_iterations - result.iterations);
    move_level_sets(result.level_set, h, terms, step, steps, Border::free, comm);
    redistance(result.level_set, {redistance_steps}, comm);
    result.iterations += steps;
    result.time = result.iterations * step;
    if (const auto n = count_inside(result.level_set, comm); n == 0 || n == all) {
      result.end = n == 0 ? ContourEnd::vanished : ContourEnd::filled_the_image;
      break;
    }
    if (result.time < next_check) continue;
    if (changed_share(result.level_set, before, comm) < settings.tolerance) {
      result.end = ContourEnd::settled;
      break;
    }
    before.values = result.level_set.values;
    next_check = result.time + check_time(settings, start.grid);
  }
  return result;
}

LevelSet balls(const Grid& grid, std::span<const Vec3> centers_mm, double radius_mm) {
  if (centers_mm.empty()) throw UserError("no seed", "contour", "give a point inside the object");
  if (!(radius_mm > 0)) throw UserError("the radius must be positive", "contour", "give the start's radius in mm");
  for (const Vec3& c : centers_mm)
    if (!contains_point(grid, c)) throw UserError("a seed lies outside the image", "contour", "give LPS mm");
  LevelSet result(grid);
  std::size_t v = 0;
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i, ++v) {
        const Vec3 p = lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        double nearest = 1e30;
        for (const Vec3& c : centers_mm) nearest = std::min(nearest, norm(p - c));
        result.voxels[v] = static_cast<float>(nearest - radius_mm);
      }
  return result;
}

Mask inside_of(const LevelSet& level_set) {
  Mask mask(level_set.grid);
  std::ranges::transform(level_set.voxels, mask.voxels.begin(),
                         [](float v) { return static_cast<std::uint8_t>(v < 0); });
  return mask;
}

ContourVolume evolve_contour(const Volume<float>& image_on_root, const LevelSet& start_on_root,
                             const EdgeSettings& edges, const ContourSettings& settings, const Comm& comm) {
  parallel::run_on_root(comm, [&] {
    if (image_on_root.grid.size != start_on_root.grid.size)
      throw UserError("image and starting contour differ in size", "active contour", "both must be on one grid");
  });
  const auto h = edge_function(parallel::scatter(image_on_root, comm), edges, comm);
  auto found = evolve_contour(parallel::scatter(start_on_root, comm), h, settings, comm);
  return {parallel::gather(found.level_set, comm), found.end, found.iterations, found.time};
}

}  // namespace heartgen::pde
