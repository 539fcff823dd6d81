// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/adapters/vtk_io.hpp"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>
#include <vtkTypeInt32Array.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkUnstructuredGridWriter.h>
#include <vtkVersion.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <type_traits>

#include "generator/adapters/vtk_guard.hpp"
#include "model/new_file.hpp"
#include "model/sort_unique.hpp"

namespace heartgen::adapters {
namespace {

static_assert(sizeof(Mat3) == 9 * sizeof(double));
static_assert(sizeof(Vec3) == 3 * sizeof(double), "arrays of Vec3 are handed to VTK as they lie in memory");
static_assert(sizeof(Cell) == 4 * sizeof(std::int32_t) && sizeof(Face) == 3 * sizeof(std::int32_t));

const std::string user_fraction_prefix = "fraction_";

// VTK only reads through the pointers that these arrays borrow.
template <class Array, class T>
vtkSmartPointer<Array> borrow_as(const char* name, const T* values, std::size_t tuples, int components) {
  auto array = vtkSmartPointer<Array>::New();
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetArray(const_cast<T*>(values), components * static_cast<vtkIdType>(tuples), 1);
  return array;
}

auto borrow(const char* name, const std::vector<double>& values) {
  return borrow_as<vtkDoubleArray>(name, values.data(), values.size(), 1);
}
auto borrow(const char* name, const std::vector<float>& values) {
  return borrow_as<vtkFloatArray>(name, values.data(), values.size(), 1);
}
auto borrow(const char* name, const std::vector<Vec3>& values) {
  return borrow_as<vtkDoubleArray>(name, values.empty() ? nullptr : &values.front().x, values.size(), 3);
}
auto borrow(const char* name, const std::vector<Mat3>& values) {
  return borrow_as<vtkDoubleArray>(name, values.empty() ? nullptr : &values.front().rows[0].x, values.size(), 9);
}
auto borrow(const char* name, const std::vector<std::int32_t>& values) {
  return borrow_as<vtkIntArray>(name, values.data(), values.size(), 1);
}
auto borrow(const char* name, const std::vector<std::uint8_t>& values) {
  return borrow_as<vtkUnsignedCharArray>(name, values.data(), values.size(), 1);
}

template <class Values>
void add(vtkFieldData* data, const char* name, const Values& values) {
  if (!values.empty()) data->AddArray(borrow(name, values));
}

void add_user_regions(vtkUnstructuredGrid* grid, const TetMesh& mesh) {
  std::vector<std::int32_t> tags;
  for (const auto& region : mesh.user_regions) {
    add(grid->GetCellData(), (user_fraction_prefix + region.name).c_str(), region.fraction);
    tags.push_back(region.tag);
  }
  add(grid->GetCellData(), "user_region", mesh.user_region);
  if (tags.empty()) return;
  vtkNew<vtkIntArray> copy;  // the grid outlives `tags`
  copy->DeepCopy(borrow("user_region_tag", tags));
  copy->SetName("user_region_tag");
  grid->GetFieldData()->AddArray(copy);
}

void add_fibers(vtkFieldData* data, const FiberField& fibers) {
  add(data, "fiber", fibers.fiber);
  add(data, "sheet", fibers.sheet);
  add(data, "sheet_normal", fibers.sheet_normal);
}

/// Cells of N nodes each with 32-bit ids.
template <std::size_t N>
vtkSmartPointer<vtkCellArray> cell_array(const std::vector<std::array<std::int32_t, N>>& cells) {
  vtkNew<vtkTypeInt32Array> offsets, ids;
  offsets->SetNumberOfValues(static_cast<vtkIdType>(cells.size()) + 1);
  for (std::size_t c = 0; c <= cells.size(); ++c)
    offsets->SetValue(static_cast<vtkIdType>(c), static_cast<std::int32_t>(N * c));
  const auto corners = static_cast<vtkIdType>(N);
  ids->SetNumberOfValues(corners * static_cast<vtkIdType>(cells.size()));
  for (std::size_t c = 0; c < cells.size(); ++c)
    std::copy(cells[c].begin(), cells[c].end(), ids->GetPointer(corners * static_cast<vtkIdType>(c)));
  auto result = vtkSmartPointer<vtkCellArray>::New();
  result->SetData(offsets, ids);
  return result;
}

vtkSmartPointer<vtkPoints> borrow_points(const std::vector<Vec3>& points) {
  auto result = vtkSmartPointer<vtkPoints>::New();
  result->SetData(borrow("Points", points));
  return result;
}

/// All settings that decide the bytes of an XML file are fixed here.
template <class Writer>
void write_xml(const std::filesystem::path& path, vtkDataObject* data) {
  NewFile whole(path);
  run_guarded(path, "cannot write", [&] {
    vtkNew<Writer> writer;
    writer->SetFileName(whole.partial.c_str());
    writer->SetInputData(data);
    writer->SetDataModeToAppended();
    writer->EncodeAppendedDataOff();
    writer->SetCompressorTypeToZLib();
    writer->SetCompressionLevel(3);
    writer->SetByteOrderToLittleEndian();
    writer->SetHeaderTypeToUInt64();
    writer->SetBlockSize(1 << 18);
    return writer->Write() == 1;
  });
  whole.finish();
}

/// Some faces on their own points.
struct FacePatch {
  std::vector<std::int32_t> nodes;  ///< ascending node ids of the mesh: the patch's points
  std::vector<Face> faces;          ///< in patch numbering
  std::vector<std::int32_t> surface;
};

FacePatch face_patch(const TetMesh& mesh, const std::vector<std::size_t>& faces, const std::vector<Rim>& rims) {
  std::vector<std::int32_t> patch_id(mesh.nodes_mm.size(), -1);
  FacePatch patch;
  for (const auto f : faces) {
    patch.faces.push_back(mesh.faces[f]);
    patch.surface.push_back(mesh.surface[f]);
    for (const auto node : mesh.faces[f]) patch_id[static_cast<std::size_t>(node)] = 0;
  }
  for (const auto& rim : rims)
    for (const auto node : rim.nodes) patch_id[static_cast<std::size_t>(node)] = 0;
  for (std::size_t n = 0; n < patch_id.size(); ++n) {
    if (patch_id[n] < 0) continue;
    patch_id[n] = static_cast<std::int32_t>(patch.nodes.size());
    patch.nodes.push_back(static_cast<std::int32_t>(n));
  }
  for (auto& face : patch.faces)
    for (auto& node : face) node = patch_id[static_cast<std::size_t>(node)];
  return patch;
}

/// 1 at the points of a patch that lie on the rim.
std::vector<std::uint8_t> rim_flags(const FacePatch& patch, const Rim& rim) {
  std::vector<std::uint8_t> flags(patch.nodes.size());
  for (std::size_t n = 0; n < flags.size(); ++n)
    flags[n] = std::binary_search(rim.nodes.begin(), rim.nodes.end(), patch.nodes[n]) ? 1 : 0;
  return flags;
}

void write_patch(const std::filesystem::path& path, const TetMesh& mesh, const FacePatch& patch,
                 const std::vector<Rim>& rims, const IntArrays& on_faces) {
  std::vector<Vec3> points;
  std::vector<std::int32_t> global_ids, rim_tags;
  for (const auto node : patch.nodes) {
    points.push_back(mesh.nodes_mm[static_cast<std::size_t>(node)]);
    global_ids.push_back(node + 1);
  }
  std::vector<std::vector<std::uint8_t>> flags;
  for (const auto& rim : rims) {
    flags.push_back(rim_flags(patch, rim));
    rim_tags.push_back(rim.tag);
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(borrow_points(points));
  data->SetPolys(cell_array(patch.faces));
  data->GetCellData()->AddArray(borrow("surface", patch.surface));
  for (const auto& [name, values] : on_faces) add(data->GetCellData(), name.c_str(), values);
  data->GetPointData()->AddArray(borrow("GlobalNodeID", global_ids));
  for (std::size_t r = 0; r < rims.size(); ++r) add(data->GetPointData(), rims[r].name.c_str(), flags[r]);
  add(data->GetFieldData(), "rim_tag", rim_tags);
  write_xml<vtkXMLPolyDataWriter>(path, data);
}

/// Triangles, then tetrahedra.
void set_cells(vtkUnstructuredGrid* grid, const UnstructuredData& data) {
  if (data.faces.empty()) {
    grid->SetCells(VTK_TETRA, cell_array(data.tets));
    return;
  }
  const auto cells = cell_array(data.faces);
  cells->Append(cell_array(data.tets), 0);
  vtkNew<vtkUnsignedCharArray> types;
  for (std::size_t f = 0; f < data.faces.size(); ++f) types->InsertNextValue(VTK_TRIANGLE);
  for (std::size_t c = 0; c < data.tets.size(); ++c) types->InsertNextValue(VTK_TETRA);
  grid->SetCells(types, cells);
}

bool are_int32(const std::vector<double>& values) {
  constexpr double most = std::numeric_limits<std::int32_t>::max();
  return std::all_of(values.begin(), values.end(), [](double v) { return v == std::round(v) && std::abs(v) <= most; });
}

/// An array of its own, so that the values may go.
template <class T>
void add_copy(vtkFieldData* target, const UnstructuredData& data, const std::string& name,
              const std::vector<T>& values) {
  vtkSmartPointer<vtkDataArray> array = vtkSmartPointer<vtkDoubleArray>::New();
  if constexpr (std::is_same_v<T, double>)
    if (data.integers.contains(name) && are_int32(values)) array = vtkSmartPointer<vtkIntArray>::New();
  array->SetName(name.c_str());
  array->DeepCopy(borrow(name.c_str(), values));  // keeps the type of its own
  target->AddArray(array);
}

template <class T>
void add_copies(vtkFieldData* target, const UnstructuredData& data,
                const std::map<std::string, std::vector<T>>& arrays) {
  for (const auto& [name, values] : arrays)
    if (!values.empty()) add_copy(target, data, name, values);
}

void add_points_arrays(vtkUnstructuredGrid* grid, const UnstructuredData& data) {
  add_copies(grid->GetPointData(), data, data.point_scalars);
  add_copies(grid->GetPointData(), data, data.point_vectors);
  add_copies(grid->GetPointData(), data, data.point_tensors);
}

/// Arrays of triangles and of tetrahedra with the same name, one behind the other.
template <class T>
std::map<std::string, std::vector<T>> joined(const std::map<std::string, std::vector<T>>& faces,
                                             const std::map<std::string, std::vector<T>>& cells,
                                             const UnstructuredData& data) {
  T zero{};
  if constexpr (std::is_same_v<T, Mat3>) zero = Mat3{{Vec3{}, Vec3{}, Vec3{}}};
  std::map<std::string, std::vector<T>> all = faces;
  for (const auto& [name, values] : cells) all[name].resize(data.faces.size(), zero);
  for (auto& [name, values] : all) {
    const auto found = cells.find(name);
    if (found == cells.end())
      values.resize(data.faces.size() + data.tets.size(), zero);
    else
      values.insert(values.end(), found->second.begin(), found->second.end());
  }
  return all;
}

void add_cell_arrays(vtkUnstructuredGrid* grid, const UnstructuredData& data) {
  add_copies(grid->GetCellData(), data, joined(data.face_scalars, data.cell_scalars, data));
  add_copies(grid->GetCellData(), data, joined(data.face_vectors, data.cell_vectors, data));
  add_copies(grid->GetCellData(), data, joined(data.face_tensors, data.cell_tensors, data));
}

}  // namespace

void write_vtu(const std::filesystem::path& path, const TetMesh& mesh) {
  vtkNew<vtkUnstructuredGrid> grid;
  grid->SetPoints(borrow_points(mesh.nodes_mm));
  grid->SetCells(VTK_TETRA, cell_array(mesh.cells));
  add(grid->GetCellData(), "region", mesh.region);
  add_fibers(grid->GetCellData(), mesh.cell_fibers);
  add(grid->GetCellData(), "rule_difference_deg", mesh.rule_difference_deg);
  add_user_regions(grid, mesh);
  add(grid->GetCellData(), "parent_cell", mesh.parent_cell);
  add_fibers(grid->GetPointData(), mesh.node_fibers);
  add(grid->GetPointData(), "fiber_source", mesh.fiber_source);
  add(grid->GetPointData(), "parent_node", mesh.parent_node);
  write_xml<vtkXMLUnstructuredGridWriter>(path, grid);
}

void write_vtp(const std::filesystem::path& path, const TetMesh& mesh) {
  std::vector<std::size_t> all(mesh.faces.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  write_patch(path, mesh, face_patch(mesh, all, mesh.rims), mesh.rims, {});
}

void write_curves(const std::filesystem::path& path, const TetMesh& mesh,
                  const std::vector<mesh_queries::FeatureCurve>& curves) {
  std::vector<std::int32_t> nodes, number;
  std::vector<mesh_queries::NodePair> lines;
  vtkNew<vtkStringArray> names;
  names->SetName("curve_name");
  for (std::size_t c = 0; c < curves.size(); ++c) {
    names->InsertNextValue(mesh_queries::curve_name(curves[c]));
    for (const auto& edge : curves[c].edges) {
      lines.push_back(edge);
      number.push_back(static_cast<std::int32_t>(c));
      nodes.insert(nodes.end(), edge.begin(), edge.end());
    }
  }
  sort_unique(nodes);
  for (auto& line : lines)
    for (auto& node : line) node = static_cast<std::int32_t>(std::ranges::lower_bound(nodes, node) - nodes.begin());
  std::vector<Vec3> points;
  std::vector<std::int32_t> global_ids;
  for (const auto node : nodes) {
    points.push_back(mesh.nodes_mm[static_cast<std::size_t>(node)]);
    global_ids.push_back(node + 1);
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(borrow_points(points));
  data->SetLines(cell_array(lines));
  data->GetCellData()->AddArray(borrow("curve", number));
  data->GetPointData()->AddArray(borrow("GlobalNodeID", global_ids));
  data->GetFieldData()->AddArray(names);
  write_xml<vtkXMLPolyDataWriter>(path, data);
}

void write_cavities(const std::filesystem::path& path, const TetMesh& mesh) {
  std::vector<std::int32_t> nodes, cavity, surface, global_ids;
  std::vector<Face> faces;
  std::vector<Vec3> points;
  vtkNew<vtkStringArray> names;
  names->SetName("cavity_name");
  for (const auto& one : mesh.cavities) {
    names->InsertNextValue(one.name);
    faces.insert(faces.end(), one.faces.begin(), one.faces.end());
    surface.insert(surface.end(), one.surface.begin(), one.surface.end());
    cavity.insert(cavity.end(), one.faces.size(), one.region);
    for (const auto& face : one.faces) nodes.insert(nodes.end(), face.begin(), face.end());
  }
  sort_unique(nodes);
  for (auto& face : faces)
    for (auto& node : face) node = static_cast<std::int32_t>(std::ranges::lower_bound(nodes, node) - nodes.begin());
  for (const auto node : nodes) {
    points.push_back(mesh.nodes_mm[static_cast<std::size_t>(node)]);
    global_ids.push_back(node + 1);
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(borrow_points(points));
  data->SetPolys(cell_array(faces));
  data->GetCellData()->AddArray(borrow("cavity", cavity));
  data->GetCellData()->AddArray(borrow("surface", surface));
  data->GetPointData()->AddArray(borrow("GlobalNodeID", global_ids));
  data->GetFieldData()->AddArray(names);
  write_xml<vtkXMLPolyDataWriter>(path, data);
}

void write_vtp(const std::filesystem::path& path, const TetMesh& mesh, const std::vector<std::size_t>& faces,
               const IntArrays& on_faces) {
  write_patch(path, mesh, face_patch(mesh, faces, {}), {}, on_faces);
}

void write_vtu(const std::filesystem::path& path, const TetMesh& mesh, const IntArrays& on_cells,
               const IntArrays& on_points) {
  vtkNew<vtkUnstructuredGrid> grid;
  grid->SetPoints(borrow_points(mesh.nodes_mm));
  grid->SetCells(VTK_TETRA, cell_array(mesh.cells));
  for (const auto& [name, values] : on_cells) add(grid->GetCellData(), name.c_str(), values);
  for (const auto& [name, values] : on_points) add(grid->GetPointData(), name.c_str(), values);
  write_xml<vtkXMLUnstructuredGridWriter>(path, grid);
}

void write_vtu(const std::filesystem::path& path, const TriMesh& mesh) {
  vtkNew<vtkUnstructuredGrid> grid;
  grid->SetPoints(borrow_points(mesh.nodes_mm));
  grid->SetCells(VTK_TRIANGLE, cell_array(mesh.triangles));
  add(grid->GetCellData(), "region", mesh.region);
  write_xml<vtkXMLUnstructuredGridWriter>(path, grid);
}

void write_vtp(const std::filesystem::path& path, const TriMesh& mesh) {
  vtkNew<vtkPolyData> data;
  data->SetPoints(borrow_points(mesh.nodes_mm));
  data->SetLines(cell_array(mesh.edges));
  data->GetCellData()->AddArray(borrow("curve", mesh.curve));
  write_xml<vtkXMLPolyDataWriter>(path, data);
}

void write_unstructured(const std::filesystem::path& path, const UnstructuredData& data) {
  vtkNew<vtkUnstructuredGrid> grid;
  grid->SetPoints(borrow_points(data.points));
  set_cells(grid, data);
  add_points_arrays(grid, data);
  add_cell_arrays(grid, data);
  if (path.extension() == ".vtu") {
    write_xml<vtkXMLUnstructuredGridWriter>(path, grid);
    return;
  }
  NewFile whole(path);
  run_guarded(path, "cannot write", [&] {
    vtkNew<vtkUnstructuredGridWriter> writer;
    writer->SetFileName(whole.partial.c_str());
    writer->SetInputData(grid);
    writer->SetFileVersion(vtkUnstructuredGridWriter::VTK_LEGACY_READER_VERSION_4_2);
    writer->SetHeader("heartgen");
    writer->SetFileTypeToBinary();
    return writer->Write() == 1;
  });
  whole.finish();
}

std::string vtk_version() { return vtkVersion::GetVTKVersion(); }

}  // namespace heartgen::adapters
