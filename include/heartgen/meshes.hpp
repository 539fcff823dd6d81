// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Meshes of tetrahedra and triangles, and their files. A `TetMesh` holds nodes (LPS mm), cells with a region, labelled
/// faces, rims and fibres; an `UnstructuredData` holds what any file holds, with arrays by name. Not collective;
/// everything throws UserError.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "exporters/cut.hpp"
#include "generator/mesh_files/any_mesh.hpp"
#include "model/error.hpp"
#include "model/tet_mesh.hpp"
#include "model/tri_mesh.hpp"
#include "model/unstructured_data.hpp"

namespace heartgen {

using exporters::only_regions;
using exporters::regions_named;
using mesh_files::cell_labels;
using mesh_files::check_mesh_output;
using mesh_files::find_labels;
using mesh_files::is_mesh_name;
using mesh_files::read_any_mesh;
using mesh_files::write_any_mesh;

struct MeshFile {
  std::string name;  ///< of its file, without folder and ending
  TetMesh mesh;      ///< in mm; `names` holds every tag that occurs
  std::vector<std::string> remarks;
};

/// A mesh of anybody's: .vtu, .vtk, .msh, openCARP's .pts, TetGen's .node, Medit's .mesh. Faces: the file's triangles,
/// and what it does not label of the outer boundary and of interfaces, with numbers of their own. Fibres: vectors per
/// cell, or else per point, with a known name; where the file has no sheets they are any directions across the fibres.
/// `region` names the array of regions (empty: a known name), `unit` is the file's: mm, um, cm or m (empty: um for
/// openCARP's files, else mm).
MeshFile read_mesh(const std::filesystem::path& path, const std::string& region = "", const std::string& unit = "");

/// .vtu, .vtk or .msh (gmsh 4.1), by the ending; labelled faces and curves stand beside it where the format has no
/// place for them. Returns the files, the mesh first. check_mesh_output, before long work, throws where it cannot.
std::vector<std::filesystem::path> write_mesh(const std::filesystem::path& path, const TetMesh& mesh);

}  // namespace heartgen
