// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/fibers/frame.hpp"

#include "generator/parallel/threads.hpp"
#include "model/contract.hpp"

namespace heartgen::fibers {
namespace {

Vec3 any_orthogonal(const Vec3& unit) {
  return normalized(cross(unit, std::abs(unit.x) < 0.8 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
}

void resize(FiberField& field, std::size_t count) {
  field.fiber.resize(count);
  field.sheet.resize(count);
  field.sheet_normal.resize(count);
}

void set(FiberField& field, std::size_t n, const MaterialAxes& axes) {
  field.fiber[n] = axes.fiber;
  field.sheet[n] = axes.sheet;
  field.sheet_normal[n] = axes.sheet_normal;
}

}  // namespace

MaterialAxes material_axes(const Vec3& fiber, const Vec3& transmural) {
  HEARTGEN_EXPECTS(dot(fiber, fiber) > 0);
  constexpr double nearly_parallel = 1e-3;
  MaterialAxes axes;
  axes.fiber = normalized(fiber);
  const Vec3 across = normalized(transmural);
  Vec3 sheet = across - dot(across, axes.fiber) * axes.fiber;
  if (norm(sheet) < nearly_parallel) sheet = any_orthogonal(axes.fiber);
  sheet = normalized(sheet);
  axes.sheet = normalized(sheet - dot(sheet, axes.fiber) * axes.fiber);
  axes.sheet_normal = normalized(cross(axes.fiber, axes.sheet));
  return axes;
}

FiberField node_frames(const std::vector<Vec3>& fiber, const std::vector<Vec3>& transmural) {
  HEARTGEN_EXPECTS(fiber.size() == transmural.size());
  FiberField field;
  resize(field, fiber.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(fiber.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n)
      set(field, n, material_axes(fiber[n], transmural[n]));
  });
  return field;
}

FiberField cell_frames(const TetMesh& mesh, const FiberField& node) {
  FiberField field;
  resize(field, mesh.cells.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(mesh.cells.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto c = static_cast<std::size_t>(begin); c < static_cast<std::size_t>(end); ++c) {
      AxisTensor fiber, sheet;
      for (const auto n : mesh.cells[c]) {
        fiber += axis_tensor(node.fiber[static_cast<std::size_t>(n)]);
        sheet += axis_tensor(node.sheet[static_cast<std::size_t>(n)]);
      }
      set(field, c, material_axes(leading_axis(fiber), leading_axis(sheet)));
    }
  });
  return field;
}

}  // namespace heartgen::fibers
