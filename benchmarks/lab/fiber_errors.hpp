// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// How far carried fibre axes are from a phantom's.
#pragma once
#include <cstdint>
#include <vector>

#include "benchmarks/lab/fiber_cases.hpp"
#include "datasets/phantom/phantom.hpp"
#include "generator/fibers/registered_pair.hpp"
#include "model/axis_tensor.hpp"

namespace heartgen::lab {

using phantom::HelixField;

/// Variant 0 as an atlas.
ventricles::AtlasImage phantom_atlas(double spacing_mm, HelixField field);

/// Places in both walls where the phantom has fibres.
struct KnownAxes {
  std::vector<Vec3> points_mm, axis;
  std::vector<std::uint8_t> left;
  std::vector<std::size_t> source;  ///< voxel, node or cell
};

bool is_ventricular(std::int32_t region);

/// Adds a place of a ventricle's wall where the phantom has a fibre.
void add_known(const FiberCase& patient, HelixField field, const Vec3& point_mm, std::int32_t region,
               std::size_t source, KnownAxes& known);

KnownAxes known_at_voxels(const FiberCase& patient, HelixField field);

struct Errors {
  std::size_t places = 0;
  double mean_deg = 0, p95_deg = 0, cover = 0;
};

/// Angles between known and carried axes in one of the walls.
Errors errors_of(const KnownAxes& known, const std::vector<AxisTensor>& carried, bool left);

}  // namespace heartgen::lab
