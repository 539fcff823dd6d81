// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/label_measures.hpp"

#include <fmt/format.h>

#include <cmath>

#include "benchmarks/mesh_measures.hpp"
#include "generator/parallel/threads.hpp"
#include "model/labels.hpp"
#include "validation/label_fidelity.hpp"

namespace heartgen::benchmarks {
namespace {

bool is_inside(const Grid& grid, const Vec3& index) {
  for (int axis = 0; axis < 3; ++axis)
    if (const auto size = static_cast<double>(grid.size[static_cast<std::size_t>(axis)]);
        std::abs(index[axis] + 0.5 - 0.5 * size) > 0.5 * size)
      return false;
  return true;
}

}  // namespace

void add_quality(Table& table, const char* bench, const TetMesh& mesh, const mesh::LatticeReport& report,
                 const std::array<const char*, 2>& bounds) {
  for (const auto& [step, taken] : report.seconds)
    table.push_back({bench, "  of it, lattice: " + step, taken, "s", ""});
  const auto angles = angles_of(mesh.nodes_mm, mesh.cells, [](std::size_t) { return true; });
  table.push_back({bench, "least dihedral angle", angles.least, "degrees", bounds[0]});
  table.push_back({bench, "greatest dihedral angle", angles.greatest, "degrees", bounds[1]});
}

void add_found_distances(Table& table, const char* bench, const TetMesh& mesh, const LabelVolume& labels,
                         const LabelAt& label_at) {
  const auto label_inside = [&](const Vec3& lps_mm) {
    return is_inside(labels.grid, index_from_lps(labels.grid, lps_mm)) ? label_at(lps_mm) : 0;
  };
  const auto rows = validation::check_against_level_sets("heart", mesh, validation::mesh_faces(mesh), labels.grid,
                                                         label_inside, ValidationSettings{});
  for (const auto& row : rows) {
    if (!row.metric.starts_with("to_level_set_") || !row.metric.ends_with("_in_edges")) continue;
    const bool is_p99 = row.metric.find("p99") != std::string::npos;
    table.push_back({bench, fmt::format("{} to its level set, {}", row.scope, is_p99 ? "p99" : "greatest"), row.value,
                     "edges", is_p99 ? "at most 0.1; centres and nodes of faces" : "at most 0.3"});
  }
}

Volumes volumes_of(const Grid& grid, const LabelAt& label_at) {
  constexpr int parts = 5;  // of a voxel, along each axis
  const auto& size = grid.size;
  const auto label_of = [&](double i, double j, double k) {
    return static_cast<std::uint8_t>(label_at(lps_from_index(grid, {i, j, k})));
  };
  LabelVolume centers(grid);
  std::vector<Volumes> of_slice(static_cast<std::size_t>(size[2]), Volumes{});
  const auto each_voxel = [&](const auto& visit) {
    parallel::parallel_for(0, size[2], [&](std::int64_t begin, std::int64_t end) {
      for (auto k = begin; k < end; ++k)
        for (std::int64_t j = 0; j < size[1]; ++j)
          for (std::int64_t i = 0; i < size[0]; ++i) visit(Index3{i, j, k});
    });
  };
  const auto is_inside_one = [&](const Index3& at) {
    for (int step = 0; step < 27; ++step) {
      const Index3 other{at[0] + step % 3 - 1, at[1] + step / 3 % 3 - 1, at[2] + step / 9 - 1};
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (other[axis] < 0 || other[axis] >= size[axis]) return false;
      if (centers(other[0], other[1], other[2]) != centers(at[0], at[1], at[2])) return false;
    }
    return true;
  };
  each_voxel([&](const Index3& at) {
    centers(at[0], at[1], at[2]) =
        label_of(static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2]));
  });
  each_voxel([&](const Index3& at) {
    auto& volumes = of_slice[static_cast<std::size_t>(at[2])];
    if (is_inside_one(at)) {
      volumes[centers(at[0], at[1], at[2])] += grid.voxel_volume_mm3();
      return;
    }
    const auto place = [&](std::size_t axis, int part) {
      return static_cast<double>(at[axis]) + (part + 0.5) / parts - 0.5;
    };
    for (int c = 0; c < parts; ++c)
      for (int b = 0; b < parts; ++b)
        for (int a = 0; a < parts; ++a)
          volumes[label_of(place(0, a), place(1, b), place(2, c))] += grid.voxel_volume_mm3() / (parts * parts * parts);
  });
  Volumes volumes{};
  for (const auto& slice : of_slice)
    for (std::size_t r = 0; r < volumes.size(); ++r) volumes[r] += slice[r];
  return volumes;
}

void add_regions(Table& table, const char* bench, const TetMesh& mesh, const Volumes& level_set) {
  Volumes volume{};
  std::array<std::int64_t, 256> count{};
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const auto at = static_cast<std::size_t>(mesh.region[c]);
    volume[at] += cell_volume_mm3(mesh, mesh.cells[c]);
    ++count[at];
  }
  for (std::size_t r = 1; r < count.size(); ++r)
    if (level_set[r] > 0)
      table.push_back({bench, fmt::format("{}: cells", region_name(static_cast<std::int32_t>(r))),
                       static_cast<double>(count[r]) / 1e3, "k",
                       fmt::format("volume {:+.2f} % of its level set's", 100 * (volume[r] / level_set[r] - 1))});
}

}  // namespace heartgen::benchmarks
