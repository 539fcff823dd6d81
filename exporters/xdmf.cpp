// SPDX-License-Identifier: GPL-3.0-or-later
// XDMF + HDF5. NAME.xdmf holds the tetrahedra with `cell_tags`, NAME_facets.xdmf the labelled triangles with
// `facet_tags` on the same nodes: one topology a file, as dolfinx and meshio want it. dolfinx opens the .h5 file that
// is named as the .xdmf file is, so each has its own:
//   NAME.h5         /mesh/geometry float64 N×3, /mesh/topology int32 M×4, /mesh/cell_tags int32 M,
//                   /rims/NAME int32 (0-based nodes), /nodes/{fiber,sheet,sheet_normal} float64 N×3,
//                   /nodes/fiber_source uint8 N, /cells/{fiber,sheet,sheet_normal} float64 M×3,
//                   /cells/user_region int32 M, /cells/fraction_NAME float32 M,
//                   /cavities/NAME/topology int32 C×3 (normals out of the blood), /cavities/NAME/surface int32 C
//   NAME_facets.h5  /facets/topology int32 K×3, /facets/facet_tags int32 K
// Integers are compressed (shuffled, deflated), and zero fibres take no room. The files keep no time stamps, so equal
// meshes give equal bytes.
#include <hdf5.h>

#include <algorithm>
#include <string>

#include "exporters/formats.hpp"
#include "exporters/out_file.hpp"
#include "model/error.hpp"

namespace heartgen::exporters {
namespace {

/// An HDF5 identifier that closes itself.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

class H5File {
 public:
  explicit H5File(const std::filesystem::path& path) : whole_(path) {
    H5dont_atexit();                              // its exit handler writes again what a full disk has refused
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors are returned, not printed
    file_ = H5Fcreate(whole_.partial.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    require(file_ >= 0);
  }
  ~H5File() {
    if (file_ >= 0) H5Fclose(file_);
  }
  H5File(const H5File&) = delete;
  H5File& operator=(const H5File&) = delete;

  /// `name` is an absolute path; missing groups are made. One column makes a one-dimensional data set.
  void write(const std::string& name, hid_t stored_type, hid_t memory_type, const void* data, std::size_t rows,
             std::size_t columns) {
    const hsize_t shape[2] = {rows, columns};
    const int rank = columns == 1 ? 1 : 2;
    const Handle space(H5Screate_simple(rank, shape, nullptr), &H5Sclose);
    const Handle creation(H5Pcreate(H5P_DATASET_CREATE), &H5Pclose);
    if (rows > 0) compress(creation, rank, rows, columns);
    const Handle links(H5Pcreate(H5P_LINK_CREATE), &H5Pclose);
    require(H5Pset_obj_track_times(creation, false) >= 0 && H5Pset_create_intermediate_group(links, 1) >= 0);
    const Handle set(H5Dcreate2(file_, name.c_str(), stored_type, space, links, creation, H5P_DEFAULT), &H5Dclose);
    require(set >= 0);
    if (rows > 0) require(H5Dwrite(set, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0);
  }

  void write(const std::string& name, const std::vector<Vec3>& values) {
    write(name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values.data(), values.size(), 3);
  }
  void write(const std::string& name, const std::vector<float>& values) {
    write(name, H5T_IEEE_F32LE, H5T_NATIVE_FLOAT, values.data(), values.size(), 1);
  }
  void write(const std::string& name, const std::vector<std::int32_t>& values) {
    write(name, H5T_STD_I32LE, H5T_NATIVE_INT32, values.data(), values.size(), 1);
  }
  void write(const std::string& name, const std::vector<std::uint8_t>& values) {
    write(name, H5T_STD_U8LE, H5T_NATIVE_UINT8, values.data(), values.size(), 1);
  }
  template <std::size_t N>
  void write(const std::string& name, const std::vector<std::array<std::int32_t, N>>& values) {
    write(name, H5T_STD_I32LE, H5T_NATIVE_INT32, values.data(), values.size(), N);
  }

  void close() {
    const herr_t status = H5Fclose(file_);
    file_ = -1;
    require(status >= 0);
    whole_.finish();
  }

 private:
  void compress(hid_t creation, int rank, std::size_t rows, std::size_t columns) const {
    const hsize_t chunk[2] = {std::min<hsize_t>(rows, rows_per_chunk), columns};
    require(H5Pset_chunk(creation, rank, chunk) >= 0 && H5Pset_shuffle(creation) >= 0 &&
            H5Pset_deflate(creation, fastest) >= 0);
  }
  void require(bool done) const {
    if (!done)
      throw UserError("cannot be written", whole_.path.string(), "is there room, and the right to write there?");
  }
  static constexpr hsize_t rows_per_chunk = 1 << 15;
  static constexpr unsigned fastest = 1;
  NewFile whole_;
  hid_t file_ = -1;
};

void write_axes(H5File& file, const std::string& group, const FiberField& fibers) {
  if (fibers.fiber.empty()) return;
  file.write(group + "/fiber", fibers.fiber);
  file.write(group + "/sheet", fibers.sheet);
  file.write(group + "/sheet_normal", fibers.sheet_normal);
}

std::filesystem::path write_h5(const ExportTask& task) {
  auto path = task.folder / (task.mesh_name + ".h5");
  const TetMesh& mesh = task.mesh;
  H5File file(path);
  file.write("/mesh/geometry", mesh.nodes_mm);
  file.write("/mesh/topology", mesh.cells);
  file.write("/mesh/cell_tags", mesh.region);
  for (const auto& rim : mesh.rims) file.write("/rims/" + rim.name, rim.nodes);
  write_axes(file, "/nodes", mesh.node_fibers);
  if (!mesh.fiber_source.empty()) file.write("/nodes/fiber_source", mesh.fiber_source);
  for (const auto& cavity : mesh.cavities) {
    file.write("/cavities/" + cavity.name + "/topology", cavity.faces);
    file.write("/cavities/" + cavity.name + "/surface", cavity.surface);
  }
  write_axes(file, "/cells", mesh.cell_fibers);
  if (!mesh.user_region.empty()) file.write("/cells/user_region", mesh.user_region);
  for (const auto& region : mesh.user_regions) file.write("/cells/" + fraction_name(region), region.fraction);
  file.close();
  return path;
}

std::filesystem::path write_facets_h5(const ExportTask& task) {
  auto path = task.folder / (task.mesh_name + "_facets.h5");
  H5File file(path);
  file.write("/facets/topology", task.mesh.faces);
  file.write("/facets/facet_tags", task.mesh.surface);
  file.close();
  return path;
}

struct XdmfGrid {
  std::string name;      ///< of the grid
  std::string topology;  ///< Tetrahedron, Triangle
  std::string group;     ///< /mesh, /facets
  std::string tags;      ///< cell_tags, facet_tags
  int nodes_per_cell = 0;
  std::size_t cells = 0;
};

class XdmfFile {
 public:
  /// `path` is NAME.xdmf or NAME_facets.xdmf; its data lie in the .h5 file of the same name, the nodes in NAME.h5.
  XdmfFile(const ExportTask& task, const std::filesystem::path& path)
      : out_(path), h5_(path.stem().string() + ".h5"), nodes_h5_(task.mesh_name + ".h5") {}

  void item(std::size_t rows, int columns, const char* type, int bytes, const std::string& data_set) {
    item_in(h5_, rows, columns, type, bytes, data_set);
  }

  void item_in(const std::string& h5, std::size_t rows, int columns, const char* type, int bytes,
               const std::string& data_set) {
    const std::string shape = columns == 1 ? std::to_string(rows) : fmt::format("{} {}", rows, columns);
    out_.print(FMT_COMPILE("<DataItem Dimensions=\"{}\" NumberType=\"{}\" Precision=\"{}\" Format=\"HDF\">{}:{}"
                           "</DataItem>"),
               shape, type, bytes, h5, data_set);
  }

  void attribute(const char* name, const char* center, std::size_t rows, int columns, const char* type, int bytes,
                 const std::string& data_set) {
    out_.print(FMT_COMPILE("      <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"{}\">"), name,
               columns == 3 ? "Vector" : "Scalar", center);
    item(rows, columns, type, bytes, data_set);
    out_.print(FMT_COMPILE("</Attribute>\n"));
  }

  void axes(const char* center, const std::string& group, const FiberField& fibers) {
    if (fibers.fiber.empty()) return;
    for (const char* name : {"fiber", "sheet", "sheet_normal"})
      attribute(name, center, fibers.fiber.size(), 3, "Float", 8, group + "/" + name);
  }

  /// meshio reads names and tags from here; other readers pass it over.
  void names(const std::map<std::int32_t, std::string>& names, int dimension) {
    out_.print(FMT_COMPILE("      <Information Name=\"main\"><![CDATA[<main>"));
    for (const auto& [tag, name] : names)
      out_.print(FMT_COMPILE("<map key=\"{}\" dim=\"{}\">{}</map>"), name, dimension, tag);
    out_.print(FMT_COMPILE("</main>]]></Information>\n"));
  }

  void begin(const XdmfGrid& grid, std::size_t nodes) {
    out_.print(FMT_COMPILE("<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n  <Domain>\n"
                           "    <Grid Name=\"{}\" GridType=\"Uniform\">\n"),
               grid.name);
    out_.print(FMT_COMPILE("      <Topology TopologyType=\"{}\" NumberOfElements=\"{}\" NodesPerElement=\"{}\">"),
               grid.topology, grid.cells, grid.nodes_per_cell);
    item(grid.cells, grid.nodes_per_cell, "Int", 4, grid.group + "/topology");
    out_.print(FMT_COMPILE("</Topology>\n      <Geometry GeometryType=\"XYZ\">"));
    item_in(nodes_h5_, nodes, 3, "Float", 8, "/mesh/geometry");
    out_.print(FMT_COMPILE("</Geometry>\n"));
    attribute(grid.tags.c_str(), "Cell", grid.cells, 1, "Int", 4, grid.group + "/" + grid.tags);
  }

  std::filesystem::path end() {
    out_.print(FMT_COMPILE("    </Grid>\n  </Domain>\n</Xdmf>\n"));
    return out_.close();
  }

 private:
  OutFile out_;
  std::string h5_, nodes_h5_;
};

std::filesystem::path write_volume_xdmf(const ExportTask& task) {
  const TetMesh& mesh = task.mesh;
  XdmfFile file(task, task.folder / (task.mesh_name + ".xdmf"));
  file.begin({"mesh", "Tetrahedron", "/mesh", "cell_tags", 4, mesh.cells.size()}, mesh.nodes_mm.size());
  file.axes("Cell", "/cells", mesh.cell_fibers);
  file.axes("Node", "/nodes", mesh.node_fibers);
  if (!mesh.fiber_source.empty())
    file.attribute("fiber_source", "Node", mesh.fiber_source.size(), 1, "UChar", 1, "/nodes/fiber_source");
  if (!mesh.user_region.empty())
    file.attribute("user_region", "Cell", mesh.cells.size(), 1, "Int", 4, "/cells/user_region");
  for (const auto& region : mesh.user_regions)
    file.attribute(fraction_name(region).c_str(), "Cell", mesh.cells.size(), 1, "Float", 4,
                   "/cells/" + fraction_name(region));
  file.names(regions_of(mesh), 3);
  return file.end();
}

std::filesystem::path write_facets_xdmf(const ExportTask& task) {
  const TetMesh& mesh = task.mesh;
  XdmfFile file(task, task.folder / (task.mesh_name + "_facets.xdmf"));
  file.begin({"facets", "Triangle", "/facets", "facet_tags", 3, mesh.faces.size()}, mesh.nodes_mm.size());
  file.names(surfaces_of(mesh), 2);
  return file.end();
}

}  // namespace

Files export_xdmf(const ExportTask& task) {
  return {write_h5(task), write_facets_h5(task), write_volume_xdmf(task), write_facets_xdmf(task), write_markers(task)};
}

}  // namespace heartgen::exporters
