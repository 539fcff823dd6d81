// SPDX-License-Identifier: GPL-3.0-or-later
// OpenFOAM: the case NAME with
//   constant/polyMesh   points faces owner neighbour boundary; a patch per outer surface; cellZones: the regions;
//                       faceZones: surfaces inside the mesh, a face is flipped where its owner has the higher region
//                       sets/: the regions of the user's own as cellSets
//   0/                  fraction_NAME of each of these, the parts of cells in it, as volScalarFields
//   0/                  fiber, sheet, sheet_normal as volVectorFields, zero where there is no muscle
// All text, in metres unless another unit is asked for.
#include "exporters/files.hpp"
#include "exporters/formats.hpp"
#include "exporters/out_file.hpp"
#include "exporters/poly_faces.hpp"

namespace heartgen::exporters {
namespace {

namespace fs = std::filesystem;

/// OpenFOAM's head of the file `object` in the folder `location` of the case.
void write_head(OutFile& file, const char* kind, const std::string& location, const std::string& object,
                const std::string& note = "") {
  file.print(FMT_COMPILE("FoamFile\n{{\n    version     2.0;\n    format      ascii;\n    class       {};\n"), kind);
  if (!note.empty()) file.print(FMT_COMPILE("    note        \"{}\";\n"), note);
  file.print(FMT_COMPILE("    location    \"{}\";\n    object      {};\n}}\n\n"), location, object);
}

const std::string mesh_folder = "constant/polyMesh";

fs::path write_points(const fs::path& place, const TetMesh& mesh) {
  OutFile file(place / mesh_folder / "points");
  write_head(file, "vectorField", mesh_folder, "points");
  file.print(FMT_COMPILE("{}\n(\n"), mesh.nodes_mm.size());
  for (const auto& p : mesh.nodes_mm) file.print(FMT_COMPILE("({} {} {})\n"), p.x, p.y, p.z);
  file.print(FMT_COMPILE(")\n"));
  return file.close();
}

fs::path write_faces(const fs::path& place, const PolyFaces& faces) {
  OutFile file(place / mesh_folder / "faces");
  write_head(file, "faceList", mesh_folder, "faces");
  file.print(FMT_COMPILE("{}\n(\n"), faces.nodes.size());
  for (const auto& n : faces.nodes) file.print(FMT_COMPILE("3({} {} {})\n"), n[0], n[1], n[2]);
  file.print(FMT_COMPILE(")\n"));
  return file.close();
}

fs::path write_cells_of_faces(const fs::path& place, const char* name, const std::vector<std::int32_t>& cells,
                              const std::string& note) {
  OutFile file(place / mesh_folder / name);
  write_head(file, "labelList", mesh_folder, name, note);
  file.print(FMT_COMPILE("{}\n(\n"), cells.size());
  for (const auto cell : cells) file.print(FMT_COMPILE("{}\n"), cell);
  file.print(FMT_COMPILE(")\n"));
  return file.close();
}

struct Patch {
  std::string name;
  std::size_t start = 0, count = 0;
};

std::vector<Patch> patches_of(const PolyFaces& faces, const std::map<std::int32_t, std::string>& names) {
  std::vector<Patch> patches;
  for (std::size_t f = faces.neighbour.size(); f < faces.nodes.size(); ++f) {
    const bool is_next = f == faces.neighbour.size() || faces.surface[f] != faces.surface[f - 1];
    if (is_next) patches.push_back({faces.surface[f] == 0 ? "unnamed" : names.at(faces.surface[f]), f, 0});
    ++patches.back().count;
  }
  return patches;
}

fs::path write_boundary(const fs::path& place, const std::vector<Patch>& patches) {
  OutFile file(place / mesh_folder / "boundary");
  write_head(file, "polyBoundaryMesh", mesh_folder, "boundary");
  file.print(FMT_COMPILE("{}\n(\n"), patches.size());
  for (const auto& patch : patches)
    file.print(FMT_COMPILE("{}\n{{\n    type patch;\n    nFaces {};\n    startFace {};\n}}\n"), patch.name, patch.count,
               patch.start);
  file.print(FMT_COMPILE(")\n"));
  return file.close();
}

template <class Ids>
void print_list(OutFile& file, const char* key, const char* type, const Ids& ids) {
  file.print(FMT_COMPILE("    {} List<{}>\n{}\n(\n"), key, type, ids.size());
  for (const auto id : ids) file.print(FMT_COMPILE("{}\n"), id);
  file.print(FMT_COMPILE(");\n"));
}

fs::path write_cell_zones(const fs::path& place, const TetMesh& mesh) {
  OutFile file(place / mesh_folder / "cellZones");
  write_head(file, "regIOobject", mesh_folder, "cellZones");
  const auto names = regions_of(mesh);
  file.print(FMT_COMPILE("{}\n(\n"), names.size());
  for (const auto& [tag, cells] : cells_by_region(mesh)) {
    file.print(FMT_COMPILE("{}\n{{\n    type cellZone;\n"), names.at(tag));
    print_list(file, "cellLabels", "label", cells);
    file.print(FMT_COMPILE("}}\n"));
  }
  file.print(FMT_COMPILE(")\n"));
  return file.close();
}

struct FaceZone {
  std::vector<std::size_t> faces;
  std::vector<int> flipped;
};

std::map<std::int32_t, FaceZone> face_zones(const TetMesh& mesh, const PolyFaces& faces) {
  std::map<std::int32_t, FaceZone> zones;
  const auto region = [&](std::int32_t cell) { return mesh.region[static_cast<std::size_t>(cell)]; };
  for (std::size_t f = 0; f < faces.neighbour.size(); ++f) {
    if (faces.surface[f] == 0) continue;
    auto& zone = zones[faces.surface[f]];
    zone.faces.push_back(f);
    zone.flipped.push_back(region(faces.owner[f]) > region(faces.neighbour[f]) ? 1 : 0);
  }
  return zones;
}

fs::path write_face_zones(const fs::path& place, const TetMesh& mesh, const PolyFaces& faces) {
  OutFile file(place / mesh_folder / "faceZones");
  write_head(file, "regIOobject", mesh_folder, "faceZones");
  const auto zones = face_zones(mesh, faces);
  const auto names = surfaces_of(mesh);
  file.print(FMT_COMPILE("{}\n(\n"), zones.size());
  for (const auto& [tag, zone] : zones) {
    file.print(FMT_COMPILE("{}\n{{\n    type faceZone;\n"), names.at(tag));
    print_list(file, "faceLabels", "label", zone.faces);
    print_list(file, "flipMap", "bool", zone.flipped);
    file.print(FMT_COMPILE("}}\n"));
  }
  file.print(FMT_COMPILE(")\n"));
  return file.close();
}

fs::path write_field(const fs::path& place, const char* name, const std::vector<Vec3>& values) {
  OutFile file(place / "0" / name);
  write_head(file, "volVectorField", "0", name);
  file.print(FMT_COMPILE("dimensions [0 0 0 0 0 0 0];\n\ninternalField nonuniform List<vector>\n{}\n(\n"),
             values.size());
  for (const auto& v : values) file.print(FMT_COMPILE("({} {} {})\n"), v.x, v.y, v.z);
  file.print(FMT_COMPILE(");\n\nboundaryField\n{{\n    \".*\"\n    {{\n        type zeroGradient;\n    }}\n}}\n"));
  return file.close();
}

fs::path write_cell_set(const fs::path& place, const std::string& name, const std::vector<std::size_t>& cells) {
  OutFile file(place / mesh_folder / "sets" / in_file_name(name));
  write_head(file, "cellSet", mesh_folder + "/sets", name);
  file.print(FMT_COMPILE("{}\n(\n"), cells.size());
  for (const auto c : cells) file.print(FMT_COMPILE("{}\n"), c);
  file.print(FMT_COMPILE(")\n"));
  return file.close();
}

fs::path write_fraction(const fs::path& place, const UserRegion& region) {
  OutFile file(place / "0" / in_file_name(fraction_name(region)));
  write_head(file, "volScalarField", "0", fraction_name(region));
  file.print(FMT_COMPILE("dimensions [0 0 0 0 0 0 0];\n\ninternalField nonuniform List<scalar>\n{}\n(\n"),
             region.fraction.size());
  for (const auto value : region.fraction) file.print(FMT_COMPILE("{}\n"), value);
  file.print(FMT_COMPILE(");\n\nboundaryField\n{{\n    \".*\"\n    {{\n        type zeroGradient;\n    }}\n}}\n"));
  return file.close();
}

/// Along and across the fibres, S/m: the monodomain values of Niederer et al., Phil Trans R Soc A 369:4331 (2011).
fs::path write_conductivity(const fs::path& place, const std::vector<Vec3>& fibers) {
  constexpr double along = 0.1334, across = 0.0176;
  OutFile file(place / "0" / "conductivity");
  write_head(file, "volTensorField", "0", "conductivity");
  file.print(FMT_COMPILE("dimensions [-1 -3 3 0 0 2 0];\n\ninternalField nonuniform List<tensor>\n{}\n(\n"),
             fibers.size());
  for (const auto& f : fibers) {
    const double own = f == Vec3{} ? 0 : across;
    const Vec3 g = (along - across) * f;
    file.print(FMT_COMPILE("({} {} {} {} {} {} {} {} {})\n"), own + g.x * f.x, g.x * f.y, g.x * f.z, g.y * f.x,
               own + g.y * f.y, g.y * f.z, g.z * f.x, g.z * f.y, own + g.z * f.z);
  }
  file.print(FMT_COMPILE(");\n\nboundaryField\n{{\n    \".*\"\n    {{\n        type zeroGradient;\n    }}\n}}\n"));
  return file.close();
}

}  // namespace

Files export_openfoam(const ExportTask& task) {
  const TetMesh& mesh = task.mesh;
  const fs::path place = task.folder / task.mesh_name;
  const PolyFaces faces = poly_faces(mesh);
  const auto note = fmt::format("nPoints:{} nCells:{} nFaces:{} nInternalFaces:{}", mesh.nodes_mm.size(),
                                mesh.cells.size(), faces.nodes.size(), faces.neighbour.size());
  Files files = {write_points(place, mesh),
                 write_faces(place, faces),
                 write_cells_of_faces(place, "owner", faces.owner, note),
                 write_cells_of_faces(place, "neighbour", faces.neighbour, note),
                 write_boundary(place, patches_of(faces, surfaces_of(mesh))),
                 write_cell_zones(place, mesh),
                 write_face_zones(place, mesh, faces),
                 write_markers(task)};
  for (const auto& [name, cells] : cells_by_user_region(mesh)) files.push_back(write_cell_set(place, name, cells));
  for (const auto& region : mesh.user_regions) files.push_back(write_fraction(place, region));
  if (!has_fibers(mesh)) return files;
  files.push_back(write_field(place, "fiber", mesh.cell_fibers.fiber));
  files.push_back(write_field(place, "sheet", mesh.cell_fibers.sheet));
  files.push_back(write_field(place, "sheet_normal", mesh.cell_fibers.sheet_normal));
  files.push_back(write_conductivity(place, mesh.cell_fibers.fiber));
  return files;
}

}  // namespace heartgen::exporters
