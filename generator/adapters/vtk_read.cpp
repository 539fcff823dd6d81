// SPDX-License-Identifier: GPL-3.0-or-later
// The reading half of vtk_io.hpp.
#include <SMP/Common/vtkSMPToolsAPI.h>
#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkGenericCell.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataReader.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkUnstructuredGridReader.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <numeric>
#include <string_view>

#include "generator/adapters/behind_wall.hpp"
#include "generator/adapters/vtk_counts.hpp"
#include "generator/adapters/vtk_guard.hpp"
#include "generator/adapters/vtk_io.hpp"
#include "model/error.hpp"
#include "model/input_file.hpp"

namespace heartgen::adapters {
namespace {

[[noreturn]] void fail_reading(const std::filesystem::path& path, const std::string& problem) {
  throw UserError(problem, path.string(), "is the file complete and of the kind its name says?");
}

/// An array by name with its shape checked, or nullptr when there is none.
vtkDataArray* find_array(const std::filesystem::path& path, vtkFieldData* data, const char* name, int components,
                         std::size_t tuples) {
  vtkDataArray* array = data->GetArray(name);
  if (!array) return nullptr;
  if (array->GetNumberOfComponents() != components || array->GetNumberOfTuples() != static_cast<vtkIdType>(tuples))
    fail_reading(path, fmt::format("array '{}' has {} tuples of {} components instead of {} of {}", name,
                                   array->GetNumberOfTuples(), array->GetNumberOfComponents(), tuples, components));
  return array;
}

std::vector<Vec3> vectors_of(vtkDataArray* array) {
  std::vector<Vec3> result(array ? static_cast<std::size_t>(array->GetNumberOfTuples()) : 0);
  for (std::size_t i = 0; i < result.size(); ++i) array->GetTuple(static_cast<vtkIdType>(i), &result[i].x);
  return result;
}

template <class T>
std::vector<T> scalars_of(vtkDataArray* array) {
  std::vector<T> result(array ? static_cast<std::size_t>(array->GetNumberOfTuples()) : 0);
  for (std::size_t i = 0; i < result.size(); ++i)
    result[i] = static_cast<T>(array->GetComponent(static_cast<vtkIdType>(i), 0));
  return result;
}

FiberField read_fibers(const std::filesystem::path& path, vtkFieldData* data, std::size_t tuples) {
  return {vectors_of(find_array(path, data, "fiber", 3, tuples)),
          vectors_of(find_array(path, data, "sheet", 3, tuples)),
          vectors_of(find_array(path, data, "sheet_normal", 3, tuples))};
}

std::vector<Vec3> read_points(const std::filesystem::path& path, vtkPointSet* data) {
  auto points = data->GetPoints() ? vectors_of(data->GetPoints()->GetData()) : std::vector<Vec3>{};
  for (const auto& p : points)
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      fail_reading(path, "a coordinate is not a finite number");
  return points;
}

/// One cell of N nodes; ids checked against the number of points.
template <std::size_t N>
std::array<std::int32_t, N> read_cell(const std::filesystem::path& path, vtkCellArray* cells, vtkIdType index,
                                      std::size_t point_count) {
  vtkIdType count = 0;
  const vtkIdType* ids = nullptr;
  cells->GetCellAtId(index, count, ids);
  if (count != static_cast<vtkIdType>(N))
    fail_reading(path, fmt::format("cell {} has {} nodes instead of {}", index, count, N));
  std::array<std::int32_t, N> result;
  for (std::size_t n = 0; n < N; ++n) {
    if (ids[n] < 0 || ids[n] >= static_cast<vtkIdType>(point_count))
      fail_reading(path, fmt::format("cell {} names node {}, but there are {} points", index, ids[n], point_count));
    result[n] = static_cast<std::int32_t>(ids[n]);
  }
  return result;
}

/// What `read` makes of a file by VTK, in a process of its own, once the file's own claims hold.
template <class T, class Read>
T read_by_vtk(const std::filesystem::path& path, const Read& read) {
  constexpr double values_per_byte = 10;  // of text, or compressed; each of 8 bytes
  require_input_file(path);
  refuse_absurd_counts(path);
  const auto bytes = static_cast<double>(std::filesystem::file_size(path));
  return read_behind_wall<T>(path.string(), allowance_for(bytes, values_per_byte * sizeof(double) * bytes), [&] {
    vtk::detail::smp::vtkSMPToolsAPI::GetInstance().SetBackend("Sequential");
    return read();
  });
}

template <class Reader, class Data>
vtkSmartPointer<Data> read_with(const std::filesystem::path& path, const std::function<void(Reader*)>& set_up = {}) {
  vtkNew<Reader> reader;
  if (set_up) set_up(reader);
  run_guarded(path, "cannot read", [&] {
    reader->SetFileName(path.c_str());
    reader->Update();
    return reader->GetErrorCode() == 0 && reader->GetOutput() != nullptr;
  });
  return reader->GetOutput();
}

Vec3 vector_of(vtkDataArray* array, vtkIdType index) {
  Vec3 value;
  array->GetTuple(index, &value.x);
  return value;
}

Mat3 tensor_of(vtkDataArray* array, vtkIdType index) {
  double t[9];
  array->GetTuple(index, t);
  if (array->GetNumberOfComponents() == 6)
    return {{Vec3{t[0], t[3], t[5]}, Vec3{t[3], t[1], t[4]}, Vec3{t[5], t[4], t[2]}}};
  return {{Vec3{t[0], t[1], t[2]}, Vec3{t[3], t[4], t[5]}, Vec3{t[6], t[7], t[8]}}};
}

/// The arrays of the points, tetrahedra or triangles: of `kept` of the `total` tuples.
struct NamedArrays {
  std::map<std::string, std::vector<double>>& scalars;
  std::map<std::string, std::vector<Vec3>>& vectors;
  std::map<std::string, std::vector<Mat3>>& tensors;
};

std::string name_of(vtkDataSetAttributes* data, int array) {
  const char* name = data->GetArrayName(array);
  return name ? name : fmt::format("array_{}", array);
}

void read_arrays(const std::filesystem::path& path, vtkDataSetAttributes* data, const std::vector<vtkIdType>& kept,
                 vtkIdType total, NamedArrays arrays) {
  for (int a = 0; a < data->GetNumberOfArrays(); ++a) {
    vtkDataArray* array = data->GetArray(a);
    if (!array) continue;  // strings
    const std::string name = name_of(data, a);
    if (array->GetNumberOfTuples() != total)
      fail_reading(path,
                   fmt::format("array '{}' has {} values instead of {}", name, array->GetNumberOfTuples(), total));
    const auto append = [&](auto& values, auto value_at) {
      values.reserve(values.size() + kept.size());
      for (const auto i : kept) values.push_back(value_at(i));
    };
    if (kept.empty()) continue;
    const int components = array->GetNumberOfComponents();
    if (components == 1) append(arrays.scalars[name], [&](vtkIdType i) { return array->GetComponent(i, 0); });
    if (components == 3) append(arrays.vectors[name], [&](vtkIdType i) { return vector_of(array, i); });
    if (components == 6 || components == 9)
      append(arrays.tensors[name], [&](vtkIdType i) { return tensor_of(array, i); });
  }
}

/// Which arrays hold whole numbers that fit int32, and which cannot be kept.
void note_kinds(vtkDataSetAttributes* data, UnstructuredData& mesh) {
  for (int a = 0; a < data->GetNumberOfArrays(); ++a) {
    vtkDataArray* array = data->GetArray(a);
    const int components = array ? array->GetNumberOfComponents() : 0;
    if (array && components == 1) {
      constexpr double most = std::numeric_limits<std::int32_t>::max();
      const double* range = array->GetRange();
      const bool is_whole = array->GetDataType() != VTK_FLOAT && array->GetDataType() != VTK_DOUBLE;
      if (is_whole && range[0] >= -most && range[1] <= most) mesh.integers.insert(name_of(data, a));
    } else if (components != 3 && components != 6 && components != 9) {
      mesh.remarks.push_back(
          array ? fmt::format("left out: the array \"{}\" of {} components", name_of(data, a), components)
                : fmt::format("left out: the texts \"{}\"", name_of(data, a)));
    }
  }
}

/// Cells that are neither tetrahedra nor triangles.
void count_other(vtkUnstructuredGrid* grid, vtkIdType cell, OtherCells& other) {
  static const std::map<int, const char*> plurals{{VTK_VERTEX, "points"},
                                                  {VTK_POLY_VERTEX, "groups of points"},
                                                  {VTK_LINE, "lines"},
                                                  {VTK_POLY_LINE, "polylines"},
                                                  {VTK_TRIANGLE_STRIP, "strips of triangles"},
                                                  {VTK_POLYGON, "polygons"},
                                                  {VTK_QUAD, "quadrilaterals"},
                                                  {VTK_VOXEL, "voxels"},
                                                  {VTK_HEXAHEDRON, "hexahedra"},
                                                  {VTK_WEDGE, "prisms"},
                                                  {VTK_PYRAMID, "pyramids"},
                                                  {VTK_QUADRATIC_EDGE, "quadratic lines"},
                                                  {VTK_QUADRATIC_TRIANGLE, "quadratic triangles"},
                                                  {VTK_QUADRATIC_TETRA, "quadratic tetrahedra"},
                                                  {VTK_QUADRATIC_HEXAHEDRON, "quadratic hexahedra"},
                                                  {VTK_LAGRANGE_TETRAHEDRON, "tetrahedra of higher order"},
                                                  {VTK_LAGRANGE_TRIANGLE, "triangles of higher order"}};
  const int type = grid->GetCellType(cell);
  const auto known = plurals.find(type);
  const std::string plural = known != plurals.end() ? known->second : fmt::format("cells of VTK's type {}", type);
  const auto prototype = vtkSmartPointer<vtkCell>::Take(vtkGenericCell::InstantiateCell(type));
  ++(!prototype || prototype->GetCellDimension() == 3 ? other.volumes : other.lower)[plural];
}

vtkSmartPointer<vtkUnstructuredGrid> read_grid(const std::filesystem::path& path) {
  require_input_file(path);
  std::string start(256, '\0');
  std::ifstream stream(path, std::ios::binary);
  stream.read(start.data(), static_cast<std::streamsize>(start.size()));
  if (start.rfind("# vtk DataFile", 0) == 0)
    return read_with<vtkUnstructuredGridReader, vtkUnstructuredGrid>(path, [](vtkUnstructuredGridReader* reader) {
      reader->ReadAllScalarsOn();
      reader->ReadAllVectorsOn();
      reader->ReadAllNormalsOn();
      reader->ReadAllTensorsOn();
      reader->ReadAllFieldsOn();
    });
  if (start.find("<VTKFile") != std::string::npos && start.find("\"UnstructuredGrid\"") != std::string::npos)
    return read_with<vtkXMLUnstructuredGridReader, vtkUnstructuredGrid>(path);
  fail_reading(path, "neither a legacy .vtk nor a .vtu file with an unstructured grid");
}

void read_user_regions(const std::filesystem::path& path, vtkUnstructuredGrid* grid, TetMesh& mesh) {
  constexpr std::string_view prefix = "fraction_";
  vtkFieldData* on_cells = grid->GetCellData();
  mesh.user_region = scalars_of<std::int32_t>(find_array(path, on_cells, "user_region", 1, mesh.cells.size()));
  const auto tags = scalars_of<std::int32_t>(grid->GetFieldData()->GetArray("user_region_tag"));
  for (int a = 0; a < on_cells->GetNumberOfArrays() && mesh.user_regions.size() < tags.size(); ++a) {
    const char* name = on_cells->GetArrayName(a);
    if (name == nullptr || !std::string_view(name).starts_with(prefix)) continue;
    mesh.user_regions.push_back({name + prefix.size(), tags[mesh.user_regions.size()],
                                 scalars_of<float>(find_array(path, on_cells, name, 1, mesh.cells.size()))});
  }
  if (mesh.user_regions.size() != tags.size()) fail_reading(path, "a region of 'user_region_tag' has no fractions");
}

TetMesh tet_mesh_of(const std::filesystem::path& path) {
  const auto grid = read_with<vtkXMLUnstructuredGridReader, vtkUnstructuredGrid>(path);
  TetMesh mesh;
  mesh.nodes_mm = read_points(path, grid);
  const auto cells = static_cast<std::size_t>(grid->GetNumberOfCells());
  const auto nodes = mesh.nodes_mm.size();
  for (std::size_t c = 0; c < cells; ++c)
    mesh.cells.push_back(read_cell<4>(path, grid->GetCells(), static_cast<vtkIdType>(c), nodes));
  vtkFieldData* on_cells = grid->GetCellData();
  vtkFieldData* on_nodes = grid->GetPointData();
  mesh.region = scalars_of<std::int32_t>(find_array(path, on_cells, "region", 1, cells));
  if (mesh.region.size() != cells) fail_reading(path, "cell array 'region' is missing");
  mesh.cell_fibers = read_fibers(path, on_cells, cells);
  mesh.node_fibers = read_fibers(path, on_nodes, nodes);
  mesh.fiber_source = scalars_of<std::uint8_t>(find_array(path, on_nodes, "fiber_source", 1, nodes));
  mesh.rule_difference_deg = scalars_of<float>(find_array(path, on_cells, "rule_difference_deg", 1, cells));
  mesh.parent_node = scalars_of<std::int32_t>(find_array(path, on_nodes, "parent_node", 1, nodes));
  mesh.parent_cell = scalars_of<std::int32_t>(find_array(path, on_cells, "parent_cell", 1, cells));
  read_user_regions(path, grid, mesh);
  return mesh;
}

/// 0-based nodes of a mesh with so many, per point of a surface.
std::vector<std::int32_t> nodes_of_points(const std::filesystem::path& path, vtkPolyData* data, std::size_t nodes) {
  const auto points = static_cast<std::size_t>(data->GetNumberOfPoints());
  auto node = scalars_of<std::int32_t>(find_array(path, data->GetPointData(), "GlobalNodeID", 1, points));
  if (node.size() != points) fail_reading(path, "point array 'GlobalNodeID' is missing");
  for (auto& id : node)
    if (--id < 0 || static_cast<std::size_t>(id) >= nodes)
      fail_reading(path, fmt::format("GlobalNodeID {} is not a node of the mesh", id + 1));
  return node;
}

std::vector<Face> triangles_of(const std::filesystem::path& path, vtkPolyData* data) {
  const auto points = static_cast<std::size_t>(data->GetNumberOfPoints());
  std::vector<Face> faces;
  for (vtkIdType f = 0; f < data->GetNumberOfPolys(); ++f)
    faces.push_back(read_cell<3>(path, data->GetPolys(), f, points));
  return faces;
}

/// One array of int32 per face that must be there.
std::vector<std::int32_t> required_tags(const std::filesystem::path& path, vtkPolyData* data, const char* name) {
  const auto faces = static_cast<std::size_t>(data->GetNumberOfPolys());
  auto tags = scalars_of<std::int32_t>(find_array(path, data->GetCellData(), name, 1, faces));
  if (tags.size() != faces) fail_reading(path, fmt::format("cell array '{}' is missing", name));
  return tags;
}

/// Cavities of a mesh of so many nodes.
TetMesh cavities_of(const std::filesystem::path& path, std::size_t nodes) {
  TetMesh mesh;
  const auto data = read_with<vtkXMLPolyDataReader, vtkPolyData>(path);
  const auto node = nodes_of_points(path, data, nodes);
  auto faces = triangles_of(path, data);
  const auto region = required_tags(path, data, "cavity"), surface = required_tags(path, data, "surface");
  auto* names = vtkStringArray::SafeDownCast(data->GetFieldData()->GetAbstractArray("cavity_name"));
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (mesh.cavities.empty() || mesh.cavities.back().region != region[f]) {
      const auto next = static_cast<vtkIdType>(mesh.cavities.size());
      if (names == nullptr || next >= names->GetNumberOfValues()) fail_reading(path, "a cavity has no name");
      mesh.cavities.push_back({names->GetValue(next), region[f], {}, {}});
    }
    for (auto& id : faces[f]) id = node[static_cast<std::size_t>(id)];
    mesh.cavities.back().faces.push_back(faces[f]);
    mesh.cavities.back().surface.push_back(surface[f]);
  }
  return mesh;
}

vtkSmartPointer<vtkPolyData> read_poly_data(const std::filesystem::path& path) {
  if (path.extension() == ".vtk") return read_with<vtkPolyDataReader, vtkPolyData>(path);
  return read_with<vtkXMLPolyDataReader, vtkPolyData>(path);
}

TriangleSurface triangle_surface_of(const std::filesystem::path& path) {
  const auto data = read_poly_data(path);
  if (data->GetNumberOfStrips() > 0) fail_reading(path, "it holds strips of triangles, which are not read");
  return {read_points(path, data), triangles_of(path, data)};
}

/// Faces, surfaces and rims of a mesh of so many nodes.
TetMesh surface_of(const std::filesystem::path& path, std::size_t nodes) {
  TetMesh mesh;
  const auto data = read_with<vtkXMLPolyDataReader, vtkPolyData>(path);
  const auto points = static_cast<std::size_t>(data->GetNumberOfPoints());
  const auto node = nodes_of_points(path, data, nodes);
  mesh.faces = triangles_of(path, data);
  for (auto& face : mesh.faces)
    for (auto& id : face) id = node[static_cast<std::size_t>(id)];
  mesh.surface = required_tags(path, data, "surface");
  const auto rim_tags = scalars_of<std::int32_t>(data->GetFieldData()->GetArray("rim_tag"));
  for (int a = 0; a < data->GetPointData()->GetNumberOfArrays() && mesh.rims.size() < rim_tags.size(); ++a) {
    const std::string name = data->GetPointData()->GetArrayName(a);
    if (name == "GlobalNodeID") continue;
    Rim rim{name, rim_tags[mesh.rims.size()], {}};
    const auto flags = scalars_of<std::uint8_t>(find_array(path, data->GetPointData(), name.c_str(), 1, points));
    for (std::size_t p = 0; p < flags.size(); ++p)
      if (flags[p]) rim.nodes.push_back(node[p]);
    mesh.rims.push_back(std::move(rim));
  }
  if (mesh.rims.size() != rim_tags.size()) fail_reading(path, "a rim of 'rim_tag' has no point array");
  return mesh;
}

UnstructuredData unstructured_of(const std::filesystem::path& path) {
  const auto grid = read_grid(path);
  UnstructuredData result;
  result.points = read_points(path, grid);
  std::vector<vtkIdType> tets, triangles, nodes(result.points.size());
  OtherCells other;
  tets.reserve(static_cast<std::size_t>(grid->GetNumberOfCells()));
  result.tets.reserve(tets.capacity());
  for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c) {
    const int type = grid->GetCellType(c);
    if (type == VTK_TETRA) {
      tets.push_back(c);
      result.tets.push_back(read_cell<4>(path, grid->GetCells(), c, result.points.size()));
    } else if (type == VTK_TRIANGLE) {
      triangles.push_back(c);
      result.faces.push_back(read_cell<3>(path, grid->GetCells(), c, result.points.size()));
    } else if (type != VTK_EMPTY_CELL) {
      count_other(grid, c, other);
    }
  }
  settle_other_cells(result, other, path);
  std::iota(nodes.begin(), nodes.end(), vtkIdType{0});
  read_arrays(path, grid->GetPointData(), nodes, grid->GetNumberOfPoints(),
              {result.point_scalars, result.point_vectors, result.point_tensors});
  read_arrays(path, grid->GetCellData(), tets, grid->GetNumberOfCells(),
              {result.cell_scalars, result.cell_vectors, result.cell_tensors});
  read_arrays(path, grid->GetCellData(), triangles, grid->GetNumberOfCells(),
              {result.face_scalars, result.face_vectors, result.face_tensors});
  note_kinds(grid->GetPointData(), result);
  note_kinds(grid->GetCellData(), result);
  for (int a = 0; a < grid->GetFieldData()->GetNumberOfArrays(); ++a)
    if (const char* name = grid->GetFieldData()->GetArrayName(a))
      result.remarks.push_back(fmt::format("left out: the field data \"{}\"", name));
  return result;
}

/// What comes from behind the wall may have been damaged there.
template <class Nodes>
void check_ids(const std::filesystem::path& path, const Nodes& cells, std::size_t nodes) {
  for (const auto& cell : cells)
    for (const auto id : cell)
      if (id < 0 || static_cast<std::size_t>(id) >= nodes)
        fail_reading(path, fmt::format("names node {} of {}", id, nodes));
}

template <class T>
void check_lengths(const std::filesystem::path& path, const std::map<std::string, std::vector<T>>& arrays,
                   std::size_t length) {
  for (const auto& [name, values] : arrays)
    if (values.size() != length)
      fail_reading(path, fmt::format("array '{}' has {} values instead of {}", name, values.size(), length));
}

}  // namespace

TetMesh read_vtu(const std::filesystem::path& path) {
  TetMesh mesh = read_by_vtk<TetMesh>(path, [&] { return tet_mesh_of(path); });
  check_ids(path, mesh.cells, mesh.nodes_mm.size());
  return mesh;
}

void read_surface(const std::filesystem::path& path, TetMesh& mesh) {
  const std::size_t nodes = mesh.nodes_mm.size();
  TetMesh surface = read_by_vtk<TetMesh>(path, [&] { return surface_of(path, nodes); });
  check_ids(path, surface.faces, nodes);
  mesh.faces = std::move(surface.faces);
  mesh.surface = std::move(surface.surface);
  mesh.rims = std::move(surface.rims);
}

void read_cavities(const std::filesystem::path& path, TetMesh& mesh) {
  const std::size_t nodes = mesh.nodes_mm.size();
  TetMesh read = read_by_vtk<TetMesh>(path, [&] { return cavities_of(path, nodes); });
  for (const auto& cavity : read.cavities) check_ids(path, cavity.faces, nodes);
  mesh.cavities = std::move(read.cavities);
}

TriangleSurface read_triangles(const std::filesystem::path& path) {
  TriangleSurface surface = read_by_vtk<TriangleSurface>(path, [&] { return triangle_surface_of(path); });
  check_ids(path, surface.faces, surface.points.size());
  return surface;
}

UnstructuredData read_unstructured(const std::filesystem::path& path) {
  UnstructuredData data = read_by_vtk<UnstructuredData>(path, [&] { return unstructured_of(path); });
  check_ids(path, data.tets, data.points.size());
  check_ids(path, data.faces, data.points.size());
  const auto check = [&](const auto& scalars, const auto& vectors, const auto& tensors, std::size_t length) {
    check_lengths(path, scalars, length);
    check_lengths(path, vectors, length);
    check_lengths(path, tensors, length);
  };
  check(data.point_scalars, data.point_vectors, data.point_tensors, data.points.size());
  check(data.cell_scalars, data.cell_vectors, data.cell_tensors, data.tets.size());
  check(data.face_scalars, data.face_vectors, data.face_tensors, data.faces.size());
  return data;
}

}  // namespace heartgen::adapters
