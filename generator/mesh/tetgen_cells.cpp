// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/tetgen_cells.hpp"

#include <algorithm>
#include <chrono>
#include <numeric>
#include <utility>

#include "generator/mesh/surfaces.hpp"
#include "generator/surface_fit/volume_correction.hpp"
#include "generator/tetmesh/repair.hpp"
#include "model/error.hpp"

namespace heartgen::mesh {
namespace {

using tetmesh::Complex;

std::size_t at(std::int32_t id) { return static_cast<std::size_t>(id); }

double six_volumes(const Complex& c, const Cell& cell) {
  const Vec3& p = c.at(cell[0]);
  return dot(c.at(cell[1]) - p, cross(c.at(cell[2]) - p, c.at(cell[3]) - p));
}

std::int32_t piece_of(std::vector<std::int32_t>& parent, std::int32_t cell) {
  while (parent[at(cell)] != cell) cell = parent[at(cell)] = parent[at(parent[at(cell)])];
  return cell;
}

/// The centre of the largest cell of each piece of a label, where pieces hang together by faces.
std::vector<adapters::MaterialSeed> seeds_of(const Complex& complex, const std::vector<CellFace>& faces) {
  std::vector<std::int32_t> parent(complex.cells.size());
  std::iota(parent.begin(), parent.end(), 0);
  for (const auto& face : faces)
    if (face.other >= 0 && complex.label_of(face.cell) == complex.label_of(face.other)) {
      const auto one = piece_of(parent, face.cell), other = piece_of(parent, face.other);
      parent[at(std::max(one, other))] = std::min(one, other);
    }
  std::vector<std::int32_t> largest(complex.cells.size(), -1);
  for (std::int32_t c = 0; at(c) < complex.cells.size(); ++c) {
    auto& best = largest[at(piece_of(parent, c))];
    if (best < 0 || six_volumes(complex, complex.cell(best)) < six_volumes(complex, complex.cell(c))) best = c;
  }
  std::vector<adapters::MaterialSeed> seeds;
  for (const auto c : largest) {
    if (c < 0) continue;
    Vec3 middle;
    for (const auto n : complex.cell(c)) middle += 0.25 * complex.at(n);
    seeds.push_back({middle, complex.label_of(c)});
  }
  return seeds;
}

/// The cells as a complex that repair can work on; nodes of surfaces keep the sides of the box and the spacing that
/// they had.
Complex make_complex(LabelledCells cells, const Complex& old, const std::vector<std::int32_t>& old_node,
                     const tetmesh::Materials& materials) {
  Complex complex;
  complex.nodes_mm = std::move(cells.nodes_mm);
  complex.cells = std::move(cells.cells);
  complex.label.assign(cells.label.begin(), cells.label.end());
  complex.touches.assign(complex.nodes_mm.size(), 0);
  complex.spacing_mm.reserve(complex.nodes_mm.size());
  for (std::size_t n = 0; n < complex.nodes_mm.size(); ++n) {
    if (n >= old_node.size()) {
      complex.spacing_mm.push_back(static_cast<float>(materials.edge_mm(complex.nodes_mm[n])));
      continue;
    }
    const auto bits = old.bits(old_node[n]);
    complex.touches[n] = (bits & tetmesh::side_bits) | ((bits & tetmesh::bit_of(0)) != 0 ? tetmesh::hull_bit : 0);
    complex.spacing_mm.push_back(old.spacing_mm[at(old_node[n])]);
  }
  tetmesh::derive_touches(complex);
  tetmesh::connect(complex);
  return complex;
}

/// The edge lengths in the frame of the complex: mm along the axes of the label map's grid from its first voxel.
Volume<float> along_axes(Volume<float> sizes_mm, const Grid& grid) {
  const Vec3 index = index_from_lps(grid, sizes_mm.grid.origin_mm);
  for (int axis = 0; axis < 3; ++axis) sizes_mm.grid.origin_mm[axis] = index[axis] * grid.spacing_mm[axis];
  sizes_mm.grid.direction = Mat3{};
  return sizes_mm;
}

}  // namespace

adapters::SurfaceComplex surfaces_of(const tetmesh::Complex& complex, std::vector<std::int32_t>& old_node) {
  const auto faces = cell_faces(complex.cells);
  adapters::SurfaceComplex surfaces;
  std::vector<std::int32_t> id(complex.nodes_mm.size(), -1);
  for (const auto& face : faces) {
    if (face.other >= 0 && complex.label_of(face.cell) == complex.label_of(face.other)) continue;
    surfaces.faces.push_back(face.nodes);
    for (const auto n : face.nodes) id[at(n)] = 0;
  }
  old_node.clear();
  for (std::int32_t n = 0; at(n) < id.size(); ++n) {
    if (id[at(n)] < 0) continue;
    id[at(n)] = static_cast<std::int32_t>(old_node.size());
    old_node.push_back(n);
    surfaces.nodes_mm.push_back(complex.at(n));
  }
  for (auto& face : surfaces.faces)
    for (auto& n : face) n = id[at(n)];
  surfaces.seeds = seeds_of(complex, faces);
  return surfaces;
}

LabelledCells tetgen_cells(const MeshDomain& domain, const Volume<float>& sizes_mm,
                           std::span<const LabelSet> manifold_sets, std::int64_t crumb_cells, LatticeReport* report) {
  adapters::find_tetgen();  // refuses before the work
  const auto materials = materials_of(domain, sizes_mm);
  const auto lattice = lattice_complex(materials, manifold_sets, crumb_cells, report);
  const auto start = std::chrono::steady_clock::now();
  std::vector<std::int32_t> old_node;
  const adapters::FillTask task{surfaces_of(lattice, old_node), along_axes(sizes_mm, domain.grid), {}};
  auto complex = make_complex(adapters::fill_surfaces(task), lattice, old_node, materials);
  const auto filled = std::chrono::steady_clock::now();
  const tetmesh::RepairSettings repairing;
  const auto below = tetmesh::repair(complex, materials, repairing);
  surface_fit::correct_surface_volumes(complex, materials, repairing.least);
  tetmesh::compress(complex);
  if (report != nullptr) {
    const auto seconds = [](auto from, auto to) { return std::chrono::duration<double>(to - from).count(); };
    report->add("tetgen", seconds(start, filled));
    report->add("repair", seconds(filled, std::chrono::steady_clock::now()));
    report->cells_below_goal = below;
  }
  return collect(complex, domain.grid);
}

}  // namespace heartgen::mesh
