// SPDX-License-Identifier: GPL-3.0-or-later
#include "fuzz/readers.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>

#include "exporters/bundle.hpp"
#include "exporters/manifest.hpp"
#include "generator/adapters/itk_io.hpp"
#include "generator/adapters/vtk_io.hpp"
#include "generator/atlas/exnode_text.hpp"
#include "generator/labels/names_file.hpp"
#include "generator/mesh_files/any_mesh.hpp"
#include "generator/painting/region_masks.hpp"
#include "model/error.hpp"
#include "model/landmarks.hpp"
#include "model/memory.hpp"
#include "model/recipe.hpp"
#include "support/files.hpp"

namespace heartgen::fuzz {
namespace {

namespace fs = std::filesystem;

/// The rest of a mesh that lies in several files: four points and a cell.
constexpr const char* points_of_carp = "4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
constexpr const char* cell_of_carp = "1\nTt 0 1 2 3 1\n";
constexpr const char* nodes_of_tetgen = "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n";
constexpr const char* cell_of_tetgen = "1 4 1\n1 1 2 3 4 1\n";

template <class Read>
void refusable(const Read& read) {
  try {
    read();
  } catch (const UserError&) {  // a right answer
  }
}

void read_images(const fs::path& path) {
  refusable([&] { adapters::read_image(path.string()); });
  refusable([&] { adapters::read_label_image(path.string()); });
}

void read_vectors(const fs::path& path) {
  read_images(path);
  refusable([&] { adapters::read_components(path.string()); });
}

/// A folder with this one slice, and what a series of it would be.
void read_slice(const fs::path& path) {
  refusable([&] { adapters::read_image(path.parent_path().string()); });
}

void read_mesh(const fs::path& path) {
  refusable([&] { mesh_files::read_any_mesh(path); });
}

void read_ours(const fs::path& path) {
  read_mesh(path);
  refusable([&] { adapters::read_vtu(path); });
}

void read_faces(const fs::path& path) {
  TetMesh mesh;
  mesh.nodes_mm.resize(100);
  refusable([&] { adapters::read_surface(path, mesh); });
  refusable([&] { adapters::read_cavities(path, mesh); });
}

void read_region(const fs::path& path) {
  refusable([&] { painting::read_regions({{path.string(), {}}}); });
}

void read_text(const fs::path& path) {
  refusable([&] { read_recipe(path.string()); });
}
void read_places(const fs::path& path) {
  refusable([&] { read_landmarks(path.string()); });
}
void read_names(const fs::path& path) {
  refusable([&] { labels::read_label_names(path.string()); });
}
/// A manifest as whoever means harm would write it: with its own hash.
std::string sealed(const std::string& text) {
  auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object()) return text;
  const auto dumped = [&] { return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace); };
  json.erase("manifest_sha256");
  json["manifest_sha256"] = exporters::sha256_of_text(dumped());
  return dumped() + "\n";
}

void read_contents(const fs::path& path) {
  const auto text = testing::bytes_of(path);
  for (const auto& written : {text, sealed(text)})
    refusable([&] { exporters::parse_manifest(written, path.string()); });
}
void read_pack(const fs::path& path) {
  const auto folder = path.parent_path() / "bundle";
  refusable([&] { exporters::unpack_bundle(path, folder); });
  fs::remove_all(folder);
}
void read_nodes(const fs::path& path) {
  refusable([&] { atlas::exnode::read_nodes(path.string()); });
}
void read_elements(const fs::path& path) {
  refusable([&] { atlas::exnode::read_elements(path.string()); });
}

struct Kind {
  std::string_view folder;
  const char* file;
  void (*read)(const fs::path& path);
  const char* other_file = nullptr;  ///< lies beside it
  const char* other_text = nullptr;
};

constexpr std::array<Kind, 24> table{{{"nii", "a.nii", &read_images},
                                      {"nii.gz", "a.nii.gz", &read_images},
                                      {"nrrd", "a.nrrd", &read_vectors},
                                      {"mha", "a.mha", &read_vectors},
                                      {"dcm", "slice/a.dcm", &read_slice},
                                      {"vtk", "a.vtk", &read_mesh},
                                      {"vtu", "a.vtu", &read_ours},
                                      {"vtp", "a.vtp", &read_faces},
                                      {"stl", "a.stl", &read_region},
                                      {"surface", "a.vtk", &read_region},
                                      {"msh", "a.msh", &read_mesh},
                                      {"mesh", "a.mesh", &read_mesh},
                                      {"meshb", "a.meshb", &read_mesh},
                                      {"pts", "a.pts", &read_mesh, "a.elem", cell_of_carp},
                                      {"elem", "a.elem", &read_mesh, "a.pts", points_of_carp},
                                      {"node", "a.node", &read_mesh, "a.ele", cell_of_tetgen},
                                      {"ele", "a.ele", &read_mesh, "a.node", nodes_of_tetgen},
                                      {"toml", "a.toml", &read_text},
                                      {"landmarks", "a.json", &read_places},
                                      {"names", "a.json", &read_names},
                                      {"manifest", "manifest.json", &read_contents},
                                      {"pack", "a.tar.zst", &read_pack},
                                      {"exnode", "a.exnode", &read_nodes},
                                      {"exelem", "a.exelem", &read_elements}}};

}  // namespace

std::vector<std::string> kinds() {
  std::vector<std::string> names;
  for (const auto& kind : table) names.emplace_back(kind.folder);
  return names;
}

void feed(const std::string& kind, const std::string& bytes, const std::string& folder) {
  const auto* found = std::find_if(table.begin(), table.end(), [&](const Kind& k) { return k.folder == kind; });
  if (found == table.end()) throw UserError("is no kind of file", kind, "see tests/fuzz/readers.cpp");
  const fs::path path = fs::path(folder) / kind / found->file;
  fs::create_directories(path.parent_path());
  testing::write_bytes(path, bytes);
  if (found->other_file) testing::write_bytes(path.parent_path() / found->other_file, found->other_text);
  found->read(path);
}

void limit_memory() {
  constexpr double gib = 1 << 30;
  set_memory_limit(gib);
}

}  // namespace heartgen::fuzz
