// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/lab/fiber_errors.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "generator/image/resample.hpp"
#include "model/labels.hpp"
#include "model/mathematics.hpp"

namespace heartgen::lab {
namespace {

Vec3 center_of(const Grid& grid, std::size_t v) { return image::voxel_center(grid, static_cast<std::int64_t>(v)); }

}  // namespace

ventricles::AtlasImage phantom_atlas(double spacing_mm, HelixField field) {
  const auto model = phantom::make_heart_model();
  const auto marks = phantom::landmarks_of(model);
  const auto labels = exact_labels(model, marks, {spacing_mm, spacing_mm, spacing_mm});
  return ventricles::image_of_labels(
      labels, [&](const Vec3& p) { return phantom::fiber_at(model, p, field); }, marks, spacing_mm);
}

bool is_ventricular(std::int32_t region) {
  return region == tag(Region::lv_myocardium) || region == tag(Region::rv_myocardium);
}

void add_known(const FiberCase& patient, HelixField field, const Vec3& point_mm, std::int32_t region,
               std::size_t source, KnownAxes& known) {
  if (!is_ventricular(region)) return;
  const Vec3 axis = phantom::fiber_at(patient.model, point_mm, field);
  if (norm(axis) < 0.5) return;
  known.points_mm.push_back(point_mm);
  known.axis.push_back(axis);
  known.left.push_back(region == tag(Region::lv_myocardium));
  known.source.push_back(source);
}

KnownAxes known_at_voxels(const FiberCase& patient, HelixField field) {
  KnownAxes known;
  for (std::size_t v = 0; v < patient.labels.voxels.size(); ++v)
    add_known(patient, field, center_of(patient.labels.grid, v), patient.labels.voxels[v], v, known);
  return known;
}

Errors errors_of(const KnownAxes& known, const std::vector<AxisTensor>& carried, bool left) {
  std::vector<double> angles_deg;
  std::size_t places = 0;
  for (std::size_t n = 0; n < carried.size(); ++n) {
    if ((known.left[n] != 0) != left) continue;
    ++places;
    if (trace(carried[n]) <= 0) continue;
    const double cosine = std::abs(dot(known.axis[n], leading_axis(carried[n])));
    angles_deg.push_back(math::acos(std::min(1.0, cosine)) * 180 / std::numbers::pi);
  }
  if (angles_deg.empty()) return {places, 0, 0, 0};
  double sum = 0;
  for (const double a : angles_deg) sum += a;
  std::sort(angles_deg.begin(), angles_deg.end());
  const auto count = static_cast<double>(angles_deg.size());
  return {places, sum / count, angles_deg[(angles_deg.size() - 1) * 95 / 100], count / static_cast<double>(places)};
}

}  // namespace heartgen::lab
