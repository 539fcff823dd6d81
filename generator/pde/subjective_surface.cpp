// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/subjective_surface.hpp"

#include <algorithm>
#include <cmath>

#include "generator/image/components.hpp"
#include "generator/image/morphology.hpp"
#include "generator/pde/active_contours.hpp"
#include "generator/pde/level_set_motion.hpp"
#include "generator/pde/spacing.hpp"
#include "model/error.hpp"

namespace heartgen::pde {
namespace {

using parallel::Comm;
using parallel::Slab;

constexpr MotionTerms flow{0, 1, 1, 0};

Index3 voxel_of(const Grid& grid, const Vec3& point_mm) {
  const Vec3 index = index_from_lps(grid, point_mm);
  Index3 voxel;
  for (std::size_t axis = 0; axis < 3; ++axis)
    voxel[axis] = std::clamp<std::int64_t>(std::lround(index[static_cast<int>(axis)]), 0, grid.size[axis] - 1);
  return voxel;
}

double lowest_at(const Slab<float>& phi, std::span<const Vec3> points_mm, const Comm& comm) {
  double lowest = 1e30;
  for (const Vec3& point : points_mm)
    if (const auto [i, j, k] = voxel_of(phi.grid, point); k >= phi.first && k < phi.end())
      lowest = std::min(lowest, static_cast<double>(phi.row(j, k)[i]));
  return parallel::min(comm, lowest);
}

/// Change of φ over the image, relative to the object's share of it: what lies above half the plateau.
double relative_change(const Slab<float>& now, const Slab<float>& before, double plateau, const Comm& comm) {
  const auto half = static_cast<float>(plateau / 2);
  const auto nx = now.grid.size[0];
  const auto over_rows = [&](auto&& value) {
    return parallel::sum_rows(now, comm, [&](std::int64_t j, std::int64_t k) {
      const float *a = now.row(j, k), *b = before.row(j, k);
      double sum = 0;
      for (std::int64_t i = 0; i < nx; ++i) sum += static_cast<double>(value(a[i], b[i]));
      return sum;
    });
  };
  const double change = over_rows([](float a, float b) { return std::abs(a - b); });
  const double object = over_rows([half](float a, float) { return a > half ? a : 0.0F; });
  return object > 0 ? change / object : 1;
}

/// A free circle of ten voxels' radius vanishes in this time, R² / 2.
double check_time(const Grid& grid) {
  const double h = smallest_spacing(grid);
  return 50 * h * h;
}

void clear_border(Volume<float>& volume) {
  const auto& size = volume.grid.size;
  const auto at_end = [&](std::size_t axis, std::int64_t n) {
    return size[axis] > 1 && (n == 0 || n == size[axis] - 1);
  };
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i)
        if (at_end(0, i) || at_end(1, j) || at_end(2, k)) volume(i, j, k) = 0;
}

}  // namespace

Volume<float> point_of_view(const Grid& grid, std::span<const Vec3> points_mm) {
  Volume<float> start = balls(grid, points_mm, 1);  // distance to the points, minus 1 mm
  for (float& v : start.voxels) v = 1 / (2 + v);
  clear_border(start);
  return start;
}

SubjectiveResult subjective_surface(const Slab<float>& start, const Slab<float>& h, std::span<const Vec3> points_mm,
                                    const SubjectiveSettings& settings, const Comm& comm) {
  if (settings.max_iterations < 0) throw UserError("iterations must not be negative", "subjective surface", "");
  if (points_mm.empty()) throw UserError("no seed", "subjective surface", "give a point inside the object");
  SubjectiveResult result{start, lowest_at(start, points_mm, comm), 0, 0, false};
  const double step = stable_step(h, flow, comm);
  const int interval = static_cast<int>(std::ceil(check_time(start.grid) / step));
  while (!result.steady && result.iterations < settings.max_iterations) {
    const Slab<float> before = result.surface;
    const int steps = std::min(interval, settings.max_iterations - result.iterations);
    move_level_sets(result.surface, h, flow, step, steps, Border::held, comm);
    result.iterations += steps;
    result.time = result.iterations * step;
    result.plateau = lowest_at(result.surface, points_mm, comm);
    result.steady = relative_change(result.surface, before, result.plateau, comm) < settings.tolerance;
  }
  return result;
}

SubjectiveVolume subjective_surface(const Volume<float>& image_on_root, std::span<const Vec3> points_mm,
                                    const EdgeSettings& edges, const SubjectiveSettings& settings, const Comm& comm) {
  const auto start = parallel::run_on_root(comm, [&] { return point_of_view(image_on_root.grid, points_mm); });
  const auto h = edge_function(parallel::scatter(image_on_root, comm), edges, comm);
  const auto found = subjective_surface(parallel::scatter(start, comm), h, points_mm, settings, comm);
  return {parallel::gather(found.surface, comm), found.plateau, found.time, found.iterations, found.steady};
}

Mask object_of(const SubjectiveVolume& result, std::span<const Vec3> points_mm, double share) {
  Mask above(result.surface.grid), object(result.surface.grid);
  std::ranges::transform(result.surface.voxels, above.voxels.begin(),
                         [&](float v) { return static_cast<std::uint8_t>(v > share * result.plateau); });
  for (const Vec3& point : points_mm)
    object = image::unite(object, image::component_of(above, voxel_of(above.grid, point)));
  return object;
}

}  // namespace heartgen::pde
