// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/atlas/register.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "generator/adapters/itk_registration.hpp"
#include "generator/image/isotropic_distance.hpp"
#include "generator/image/resample.hpp"
#include "generator/parallel/threads.hpp"

namespace heartgen::atlas {
namespace {

// Values per Part (outside, lv_wall, rv_wall, lv_cavity, rv_cavity): neighbouring parts differ enough for every surface
// to pull, and the two cavities pull in opposite directions.
constexpr std::array<float, 5> part_value{0, 2, 1.2F, 4, -2};

Volume<float> part_image(const Volume<std::uint8_t>& cut) {
  Volume<float> image(cut.grid);
  for (std::size_t v = 0; v < image.voxels.size(); ++v) image.voxels[v] = part_value[cut.voxels[v]];
  return image;
}

Grid registration_grid(const Grid& fine, double spacing_mm) {
  Grid grid;
  grid.spacing_mm = {spacing_mm, spacing_mm, spacing_mm};
  grid.origin_mm = fine.origin_mm;
  for (std::size_t axis = 0; axis < 3; ++axis)
    grid.size[axis] = static_cast<std::int64_t>(
                          std::floor(static_cast<double>(fine.size[axis] - 1) * fine.spacing_mm.x / spacing_mm)) +
                      1;
  return grid;
}

Vec3 point_of(const Grid& grid, std::int64_t i, std::int64_t j, std::int64_t k) {
  return lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
}

template <class Value>
Volume<float> filled(const Grid& grid, Value&& value_at) {
  Volume<float> result(grid);
  parallel::parallel_for(0, grid.size[2], [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < grid.size[1]; ++j)
        for (std::int64_t i = 0; i < grid.size[0]; ++i)
          result(i, j, k) = static_cast<float>(value_at(point_of(grid, i, j, k)));
  });
  return result;
}

/// Linear value at a point, 0 off the grid.
double value_or_zero(const Volume<float>& image, const Vec3& point_mm) {
  const Vec3 index = index_from_lps(image.grid, point_mm);
  for (int axis = 0; axis < 3; ++axis)
    if (index[axis] < 0 || index[axis] > static_cast<double>(image.grid.size[static_cast<std::size_t>(axis)] - 1))
      return 0;
  return sample_linear(image, index);
}

/// Trilinear displacement and its gradient; the border is continued.
struct Warp {
  Vec3 displacement;
  Mat3 gradient;  ///< row r, column c: derivative of component r along axis c
};

Warp warp_at(const Volume<Vec3>& field, const Vec3& point_mm) {
  const Vec3 index = index_from_lps(field.grid, point_mm);
  std::int64_t base[3];
  double t[3];
  for (int axis = 0; axis < 3; ++axis) {
    const auto last = field.grid.size[static_cast<std::size_t>(axis)] - 1;
    const double clamped = std::clamp(index[axis], 0.0, static_cast<double>(last));
    base[axis] = std::min<std::int64_t>(static_cast<std::int64_t>(clamped), last - 1);
    t[axis] = clamped - static_cast<double>(base[axis]);
  }
  Warp warp;
  warp.gradient = {{Vec3{}, Vec3{}, Vec3{}}};
  for (int corner = 0; corner < 8; ++corner) {
    const int u[3] = {corner & 1, (corner >> 1) & 1, (corner >> 2) & 1};
    double w[3], s[3];
    for (int axis = 0; axis < 3; ++axis) {
      w[axis] = u[axis] ? t[axis] : 1 - t[axis];
      s[axis] = (u[axis] ? 1 : -1) / field.grid.spacing_mm[axis];
    }
    const Vec3 d = field(base[0] + u[0], base[1] + u[1], base[2] + u[2]);
    warp.displacement += w[0] * w[1] * w[2] * d;
    for (int r = 0; r < 3; ++r)
      warp.gradient[r] += d[r] * Vec3{s[0] * w[1] * w[2], w[0] * s[1] * w[2], w[0] * w[1] * s[2]};
  }
  return warp;
}

Mat3 plus_identity(Mat3 m) {
  for (int axis = 0; axis < 3; ++axis) m[axis][axis] += 1;
  return m;
}

double smallest_jacobian(const Volume<Vec3>& field) {
  const Grid& g = field.grid;
  std::vector<double> least(static_cast<std::size_t>(g.size[2]), std::numeric_limits<double>::infinity());
  parallel::parallel_for(0, g.size[2], [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < g.size[1]; ++j)
        for (std::int64_t i = 0; i < g.size[0]; ++i) {
          Mat3 columns;
          const std::array<std::int64_t, 3> at{i, j, k};
          for (std::size_t axis = 0; axis < 3; ++axis) {
            auto low = at, high = at;
            low[axis] = std::max<std::int64_t>(at[axis] - 1, 0);
            high[axis] = std::min(at[axis] + 1, g.size[axis] - 1);
            columns[static_cast<int>(axis)] = (field(high[0], high[1], high[2]) - field(low[0], low[1], low[2])) /
                                              (static_cast<double>(high[axis] - low[axis]) * g.spacing_mm.x);
          }
          auto& slot = least[static_cast<std::size_t>(k)];
          slot = std::min(slot, determinant(plus_identity(columns)));
        }
  });
  return *std::min_element(least.begin(), least.end());
}

double wall_overlap(const Registration& registration, const Volume<std::uint8_t>& patient,
                    const Volume<std::uint8_t>& atlas) {
  const Grid& g = registration.displacement_mm.grid;
  const auto part_at = [](const Volume<std::uint8_t>& parts, const Vec3& p) {
    const Vec3 index = index_from_lps(parts.grid, p);
    const auto i = std::llround(index.x), j = std::llround(index.y), k = std::llround(index.z);
    return parts.grid.contains(i, j, k) ? parts(i, j, k) : ventricles::tag(ventricles::Part::outside);
  };
  double both = 0, sum = 0;
  for (std::int64_t k = 0; k < g.size[2]; ++k)
    for (std::int64_t j = 0; j < g.size[1]; ++j)
      for (std::int64_t i = 0; i < g.size[0]; ++i) {
        const Vec3 x = point_of(g, i, j, k);
        const bool here = ventricles::is_wall(part_at(patient, x));
        const bool there = ventricles::is_wall(part_at(atlas, atlas_position(registration, x)));
        both += here && there;
        sum += static_cast<int>(here) + static_cast<int>(there);
      }
  return sum > 0 ? 2 * both / sum : 0;
}

}  // namespace

// Orthogonal factor of the polar decomposition (Higham, SIAM J Sci Stat Comput 7, 1986): Newton's steps to the mean of
// the matrix and its inverse transposed, which is that of its cofactors over its determinant.
Mat3 nearest_rotation(Mat3 matrix) {
  constexpr int steps = 30;  // it converges quadratically, after halving what is far from unit length
  for (int step = 0; step < steps; ++step) {
    const double volume = determinant(matrix);
    const Mat3 cofactors{{cross(matrix[1], matrix[2]), cross(matrix[2], matrix[0]), cross(matrix[0], matrix[1])}};
    for (int row = 0; row < 3; ++row) matrix[row] = 0.5 * (matrix[row] + cofactors[row] / volume);
  }
  return matrix;
}

Registration register_atlas(const ventricles::Ventricles& patient, const ventricles::Ventricles& atlas,
                            const FiberSettings& settings) {
  Registration result;
  result.pose = fit_atlas_pose(patient, atlas);
  result.rotation = nearest_rotation(result.pose.atlas_from_patient.matrix);
  const auto [patient_cut, atlas_cut] = common_parts(patient, atlas, result.pose.atlas_from_patient);
  const Grid grid = registration_grid(patient.parts.grid, settings.grid_mm);
  const double blur = 0.5 * settings.grid_mm / patient.parts.grid.spacing_mm.x;
  const auto fixed_fine = image::smoothed(part_image(patient_cut), blur),
             moving_fine = image::smoothed(part_image(atlas_cut), blur);
  const auto fixed = filled(grid, [&](const Vec3& x) { return value_or_zero(fixed_fine, x); });
  const auto moving =
      filled(grid, [&](const Vec3& x) { return value_or_zero(moving_fine, result.pose.atlas_from_patient(x)); });
  adapters::DemonsSettings demons;
  demons.sigma_mm = settings.demons_sigma_mm;
  demons.iterations = settings.demons_iterations;
  demons.threads = parallel::thread_count();
  result.displacement_mm = adapters::diffeomorphic_demons(fixed, moving, demons);
  result.min_jacobian = smallest_jacobian(result.displacement_mm);
  result.wall_overlap = wall_overlap(result, patient_cut, atlas_cut);
  return result;
}

Vec3 atlas_position(const Registration& registration, const Vec3& patient_mm) {
  return registration.pose.atlas_from_patient(patient_mm +
                                              warp_at(registration.displacement_mm, patient_mm).displacement);
}

Mat3 atlas_jacobian(const Registration& registration, const Vec3& patient_mm) {
  return registration.pose.atlas_from_patient.matrix *
         plus_identity(warp_at(registration.displacement_mm, patient_mm).gradient);
}

}  // namespace heartgen::atlas
