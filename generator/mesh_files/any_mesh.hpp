// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// One door for the meshes of others, whatever program wrote them.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "model/unstructured_data.hpp"

namespace heartgen::mesh_files {

/// Whether the name is that of a mesh file: .vtu .vtk .msh .pts .elem .lon .bpts .belem .blon .node .ele .mesh .meshb
bool is_mesh_name(const std::filesystem::path& path);

/// Tetrahedra, triangles and their arrays, as they stand in the file or in the files of one name. Throws UserError for
/// other names, and as the readers do.
UnstructuredData read_any_mesh(const std::filesystem::path& path);

/// Throws UserError for other names than .vtu, .vtk and .msh, and where nothing can be written.
void check_mesh_output(const std::filesystem::path& path);

/// `labels`: the scalar array with regions and surfaces, which .msh writes as groups. Returns what the kind of file has
/// no place for, one sentence each. Throws UserError.
std::vector<std::string> write_any_mesh(const std::filesystem::path& path, const UnstructuredData& mesh,
                                        const std::string& labels);

/// The array of tetrahedra with their regions: `wanted`, or else the first of the names that programs give to it; empty
/// where there is none. Throws UserError where `wanted` is not there, or holds other than whole numbers.
std::string find_labels(const UnstructuredData& mesh, const std::string& wanted, const std::string& file);

/// The values of find_labels' array as whole numbers; empty without a name.
std::vector<std::int32_t> cell_labels(const UnstructuredData& mesh, const std::string& labels);
/// The same of triangles; 0 without such an array.
std::vector<std::int32_t> face_labels(const UnstructuredData& mesh, const std::string& labels);

/// mm per unit of the file as its readers take it: 0.001 for openCARP's files, 1 for the others.
double typical_unit_mm(const std::filesystem::path& path);

}  // namespace heartgen::mesh_files
