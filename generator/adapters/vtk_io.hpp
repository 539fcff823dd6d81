// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Meshes as VTK files, VTK itself hidden. Written files are deterministic: appended zlib blocks, fixed settings, no
/// time stamps. Points in LPS mm. Not collective; call on one rank.
///
/// NAME.vtu: points float64; cell arrays `region` int32, `fiber` `sheet` `sheet_normal` float64×3,
///   `rule_difference_deg` float32, `parent_cell` int32, of the user's regions `user_region` int32 and `fraction_NAME`
///   float32; point arrays `fiber` `sheet` `sheet_normal`, `fiber_source` uint8, `parent_node` int32; field array
///   `user_region_tag` int32, in the order of the fractions. Empty arrays are left out.
/// NAME.vtp: the points that faces or rims use; cell array `surface` int32; point array `GlobalNodeID` int32, the
///   1-based node in NAME.vtu; per rim one uint8 point array with the rim's name (1 on the rim), because a node may
///   lie on several rims; field array `rim_tag` int32 with the rims' tags in the order of these arrays.
///
/// Readers throw UserError naming the file when it is missing, truncated, inconsistent or of another kind; VTK's own
/// messages are captured into the error, nothing is printed.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <tuple>
#include <vector>

#include "model/mesh_queries/feature_curves.hpp"
#include "model/tet_mesh.hpp"
#include "model/tri_mesh.hpp"
#include "model/unstructured_data.hpp"

namespace heartgen::adapters {

/// Nodes, cells, regions, fibres and parent ids of a mesh; not its faces and rims.
void write_vtu(const std::filesystem::path& path, const TetMesh& mesh);

/// Faces, surface tags and rims of a mesh.
void write_vtp(const std::filesystem::path& path, const TetMesh& mesh);

/// Nodes and edges of the curves where surfaces meet: cell array `curve` int32, the number of the edge's curve; field
/// array `curve_name`, their names in order; point array `GlobalNodeID` int32 as in NAME.vtp.
void write_curves(const std::filesystem::path& path, const TetMesh& mesh,
                  const std::vector<mesh_queries::FeatureCurve>& curves);

/// int32 arrays by name, for codes that look for names of their own.
using IntArrays = std::map<std::string, std::vector<std::int32_t>>;

/// Nodes and cells of a mesh with these arrays alone.
void write_vtu(const std::filesystem::path& path, const TetMesh& mesh, const IntArrays& on_cells,
               const IntArrays& on_points);

/// Some faces (ids, ascending) with the points they use: `surface` and GlobalNodeID, and arrays with a value per listed
/// face.
void write_vtp(const std::filesystem::path& path, const TetMesh& mesh, const std::vector<std::size_t>& faces,
               const IntArrays& on_faces);

/// Triangles with their `region`.
void write_vtu(const std::filesystem::path& path, const TriMesh& mesh);

/// All nodes and the labelled edges: cell array `curve` int32.
void write_vtp(const std::filesystem::path& path, const TriMesh& mesh);

/// The inverse of write_vtu: faces, surface and rims are empty.
TetMesh read_vtu(const std::filesystem::path& path);

/// The inverse of write_vtp: fills faces, surface and rims of a mesh that read_vtu returned.
void read_surface(const std::filesystem::path& path, TetMesh& mesh);

using heartgen::UnstructuredData;

/// Legacy .vtk (ASCII or binary) or .vtu, told apart by the content. Arrays of 1, 3, 6 (symmetric: xx yy zz xy yz xz)
/// and 9 components are kept, as double, those of cells on tetrahedra and triangles. Throws UserError, also for volumes
/// that are no linear tetrahedra, without tetrahedra, and for a coordinate that is not finite.
UnstructuredData read_unstructured(const std::filesystem::path& path);

/// Triangles without anything else.
struct TriangleSurface {
  std::vector<Vec3> points;  ///< in the file's own unit and frame
  std::vector<Face> faces;
};
inline auto members(TriangleSurface& s) { return std::tie(s.points, s.faces); }

/// The triangles of a .vtp or legacy .vtk file of polygons. Throws UserError, also for polygons of more corners.
TriangleSurface read_triangles(const std::filesystem::path& path);

/// Closed surfaces of blood pools, each with its triangles: cell arrays `cavity` int32, the region of the blood, and
/// `surface` int32, that of the mesh's face or the cap's tag; point array `GlobalNodeID` as in NAME.vtp; field array
/// `cavity_name`, their names in order of `cavity`'s first occurrence.
void write_cavities(const std::filesystem::path& path, const TetMesh& mesh);

/// The inverse: fills the cavities of a mesh that read_vtu returned.
void read_cavities(const std::filesystem::path& path, TetMesh& mesh);

/// .vtu like write_vtu, or (any other extension) binary legacy .vtk of file version 4.2, which older readers know too.
/// Triangles stand before tetrahedra; where an array has no values on the ones or the others, they are 0. Arrays are
/// float64, those of `integers` int32. Throws UserError.
void write_unstructured(const std::filesystem::path& path, const UnstructuredData& data);

/// e.g. "9.1.0"
std::string vtk_version();

}  // namespace heartgen::adapters
