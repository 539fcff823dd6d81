// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The functions behind the table of registry.hpp; one .cpp per format. All throw UserError when a file cannot be
/// written.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "exporters/registry.hpp"

namespace heartgen::exporters {

using Files = std::vector<std::filesystem::path>;

Files export_vtk_binary(const ExportTask& task);
Files export_vtk_ascii(const ExportTask& task);
Files export_vtu(const ExportTask& task);
Files export_msh41_binary(const ExportTask& task);
Files export_msh41_ascii(const ExportTask& task);
Files export_msh22_ascii(const ExportTask& task);
Files export_dealii(const ExportTask& task);
Files export_xdmf(const ExportTask& task);
Files export_opencarp(const ExportTask& task);
Files export_opencarp_binary(const ExportTask& task);
Files export_chaste(const ExportTask& task);
Files export_svmultiphysics(const ExportTask& task);
Files export_openfoam(const ExportTask& task);
Files export_cardiacfoam(const ExportTask& task);
Files export_medit(const ExportTask& task);
Files export_mfem(const ExportTask& task);
Files export_cardioid(const ExportTask& task);
Files export_abaqus(const ExportTask& task);
Files export_febio(const ExportTask& task);
Files export_stl(const ExportTask& task);
Files export_ply(const ExportTask& task);
Files export_obj(const ExportTask& task);
Files export_vtp(const ExportTask& task);

/// NAME_markers.json: {name: [tag, dimension]} of regions (3), surfaces (2) and rims (0), for formats that have no
/// place for names.
std::filesystem::path write_markers(const ExportTask& task);

/// Of a mesh with regions of the user's own, for formats without numbers of any name per cell: NAME_user_regions.csv, a
/// line for each cell that lies in one: its 0-based id, the tag of the region that it counts for (0: none), and its
/// part in each region. No file without such regions.
Files write_user_regions(const ExportTask& task);

/// Of a mesh with cavities: NAME_cavities.csv, a line for each triangle of their closed surfaces: the cavity's name,
/// that of the mesh's surface or of the cap, and three 0-based nodes; normals look out of the blood. No file without
/// them.
Files write_cavities(const ExportTask& task);

/// Ids of the cells that count for each region of the user's own, ascending, by its name.
std::map<std::string, std::vector<std::size_t>> cells_by_user_region(const TetMesh& mesh);

/// The name of the array with the parts of cells in a region of the user's own.
std::string fraction_name(const UserRegion& region);

/// Tags that occur, ascending, with their names.
std::map<std::int32_t, std::string> regions_of(const TetMesh& mesh);
std::map<std::int32_t, std::string> surfaces_of(const TetMesh& mesh);

/// What a cell without muscle gets: some readers take a zero vector for "no muscle", others refuse it.
enum class WithoutFibers { zero, coordinate_axes };

/// Fibres per cell, also where the mesh has none.
FiberField cell_axes(const TetMesh& mesh, WithoutFibers without);

/// Ids of the faces of each surface, in the mesh's order.
std::map<std::int32_t, std::vector<std::size_t>> faces_by_surface(const TetMesh& mesh);

/// Ids of the cells of each region, in the mesh's order.
std::map<std::int32_t, std::vector<std::size_t>> cells_by_region(const TetMesh& mesh);

inline bool has_fibers(const TetMesh& mesh) { return !mesh.cell_fibers.fiber.empty(); }

inline Files joined(Files files, const Files& more) {
  files.insert(files.end(), more.begin(), more.end());
  return files;
}

/// `files` and, where the mesh has fibres, what `write_axes(task, name, axes of the cells)` makes of fibre and sheet.
template <class WriteAxes>
Files with_axes(Files files, const ExportTask& task, WriteAxes&& write_axes) {
  if (!has_fibers(task.mesh)) return files;
  files.push_back(write_axes(task, "fiber", task.mesh.cell_fibers.fiber));
  files.push_back(write_axes(task, "sheet", task.mesh.cell_fibers.sheet));
  return files;
}

}  // namespace heartgen::exporters
