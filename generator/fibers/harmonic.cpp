// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/fibers/harmonic.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include "generator/parallel/tasks.hpp"
#include "model/priors.hpp"
#include "model/quantile.hpp"

namespace heartgen::fibers {
namespace {

Rows rows_where(const std::vector<std::uint8_t>& chosen) {
  Rows rows;
  for (std::size_t r = 0; r < chosen.size(); ++r)
    if (chosen[r]) rows.push_back(static_cast<std::int32_t>(r));
  return rows;
}

}  // namespace

Wall make_wall(const TetMesh& mesh, const std::vector<Region>& regions) {
  std::vector<std::int32_t> cells;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (std::any_of(regions.begin(), regions.end(), [&](Region region) { return mesh.region[c] == tag(region); }))
      cells.push_back(static_cast<std::int32_t>(c));
  Wall wall{&mesh, mesh_queries::make_stiffness(mesh, cells), std::vector<std::int32_t>(mesh.nodes_mm.size(), -1)};
  for (std::size_t r = 0; r < wall.matrix.nodes.size(); ++r)
    wall.row[static_cast<std::size_t>(wall.matrix.nodes[r])] = static_cast<std::int32_t>(r);
  return wall;
}

Rows rows_on(const Wall& wall, const std::vector<std::string_view>& surfaces) {
  std::vector<std::uint8_t> on(wall.matrix.nodes.size());
  for (const auto name : surfaces) {
    const auto surface = surface_from_name(name);
    for (std::size_t f = 0; f < wall.mesh->faces.size(); ++f)
      if (surface && wall.mesh->surface[f] == *surface)
        for (const auto n : wall.mesh->faces[f])
          if (const auto r = wall.row[static_cast<std::size_t>(n)]; r >= 0) on[static_cast<std::size_t>(r)] = 1;
  }
  return rows_where(on);
}

Rows rows_of_valve(const Wall& wall, const std::string& valve) {
  std::vector<std::uint8_t> on(wall.matrix.nodes.size());
  std::vector<Vec3> curve;
  for (const Rim& rim : wall.mesh->rims) {
    if (rim.name != valve + "_orifice_rim") continue;
    for (const auto n : rim.nodes) {
      curve.push_back(wall.mesh->nodes_mm[static_cast<std::size_t>(n)]);
      if (const auto r = wall.row[static_cast<std::size_t>(n)]; r >= 0) on[static_cast<std::size_t>(r)] = 1;
    }
  }
  for (const auto r : rows_on(wall, {"atrioventricular_junction", "aorta_wall", "pulmonary_artery_wall"})) {
    const auto near = [&](const Vec3& p) { return norm(p - wall.at(r)) < priors::annulus_mm; };
    if (std::any_of(curve.begin(), curve.end(), near)) on[static_cast<std::size_t>(r)] = 1;
  }
  return rows_where(on);
}

Rows farthest_rows(const Wall& wall, const Rows& among, const Vec3& direction, double share) {
  if (among.empty()) return {};
  std::vector<double> along;
  along.reserve(among.size());
  for (const auto r : among) along.push_back(dot(wall.at(r), direction));
  auto sorted = along;
  const double limit = quantile(sorted, 1 - share);
  Rows rows;
  for (std::size_t n = 0; n < among.size(); ++n)
    if (along[n] >= limit) rows.push_back(among[n]);
  return rows;
}

Rows all_rows(const Wall& wall) {
  Rows rows(wall.matrix.nodes.size());
  std::iota(rows.begin(), rows.end(), 0);
  return rows;
}

Rows joined(const Rows& a, const Rows& b) {
  Rows rows;
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(rows));
  return rows;
}

Vec3 middle_of(const Wall& wall, const Rows& rows) {
  Vec3 sum;
  for (const auto r : rows) sum += wall.at(r);
  return rows.empty() ? sum : sum / static_cast<double>(rows.size());
}

std::vector<Harmonic> harmonics(const Wall& wall, const std::vector<std::vector<Held>>& held) {
  std::vector<Harmonic> result(held.size());
  std::vector<std::function<void()>> tasks;
  tasks.reserve(held.size());
  for (std::size_t p = 0; p < held.size(); ++p)
    tasks.emplace_back([&, p] {
      mesh_queries::FixedValues fixed(wall.matrix.nodes.size(), std::numeric_limits<double>::quiet_NaN());
      for (const Held& part : held[p])
        for (const auto r : part.rows)
          if (auto& value = fixed[static_cast<std::size_t>(r)]; std::isnan(value)) value = part.value;
      result[p].value = mesh_queries::solve_laplace(wall.matrix, fixed);
      result[p].slope = mesh_queries::node_gradients(*wall.mesh, wall.matrix, result[p].value);
    });
  parallel::run_tasks(tasks);
  return result;
}

}  // namespace heartgen::fibers
