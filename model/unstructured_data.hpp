// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A tetrahedral mesh as another program wrote it: cells, triangles, arrays of any name. Plain data.
#pragma once
#include <cstddef>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen {

/// Arrays have one value per point, per tetrahedron or per triangle. In most files the array that says the region of a
/// tetrahedron says the surface of a triangle: both have it under the same name.
struct UnstructuredData {
  std::vector<Vec3> points;  ///< in the file's own unit and frame
  std::vector<Cell> tets;    ///< node ids as in the file: the orientation may be either
  std::map<std::string, std::vector<double>> point_scalars, cell_scalars;
  std::map<std::string, std::vector<Vec3>> point_vectors, cell_vectors;
  std::map<std::string, std::vector<Mat3>> point_tensors, cell_tensors;

  std::vector<Face> faces;  ///< the file's triangles
  std::map<std::string, std::vector<double>> face_scalars;
  std::map<std::string, std::vector<Vec3>> face_vectors;
  std::map<std::string, std::vector<Mat3>> face_tensors;

  std::set<std::string> integers;    ///< names of scalar arrays that are written as int32
  GroupNames names;                  ///< of the labels, where the file has names
  std::vector<std::string> remarks;  ///< what the reader left out or had to choose, one sentence each
};

/// Cells that are neither tetrahedra nor triangles of straight edges, counted by the plural of their name.
struct OtherCells {
  std::map<std::string, std::size_t> volumes, lower;
};

/// Refuses what cannot be carried and remarks on what is left out. Throws UserError for volumes that are not linear
/// tetrahedra, and without any tetrahedron.
void settle_other_cells(UnstructuredData& data, const OtherCells& other, const std::filesystem::path& path);

}  // namespace heartgen
