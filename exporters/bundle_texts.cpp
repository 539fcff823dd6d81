// SPDX-License-Identifier: GPL-3.0-or-later
#include "exporters/bundle_texts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <nlohmann/json.hpp>

namespace heartgen::exporters {
namespace {

using Json = nlohmann::ordered_json;

std::string quoted(const std::string& text) {
  return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);  // a JSON string is a YAML string too
}

bool is_spdx(const std::string& license) {
  constexpr std::array known = {
      "CC-BY-4.0",       "CC-BY-SA-4.0", "CC-BY-NC-4.0", "CC-BY-NC-SA-4.0", "CC0-1.0",
      "Apache-2.0",      "MIT",          "BSD-3-Clause", "MPL-2.0",         "ODbL-1.0",
      "CC-BY-NC-ND-4.0", "CC-BY-ND-4.0", "CC-BY-3.0",    "PDDL-1.0",        "GPL-3.0-or-later"};
  return std::find(known.begin(), known.end(), license) != known.end();
}

std::string license_url(const std::string& license) { return "https://spdx.org/licenses/" + license + ".html"; }

/// The recipe's authors, separated by ';'.
std::vector<std::string> authors_of(const Manifest& manifest) {
  std::vector<std::string> authors;
  std::string rest = manifest.author;
  while (!rest.empty()) {
    const auto end = std::min(rest.find(';'), rest.size());
    std::string name = rest.substr(0, end);
    rest.erase(0, end + 1);
    name.erase(0, std::min(name.find_first_not_of(' '), name.size()));
    name.erase(name.find_last_not_of(' ') + 1);
    if (!name.empty()) authors.push_back(name);
  }
  if (authors.empty()) authors.push_back("author not stated in the recipe");
  return authors;
}

bool is_date(const std::string& text) {
  if (text.size() != 10 || text[4] != '-' || text[7] != '-') return false;
  return std::count_if(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; }) == 8;
}

std::string tag_table(const std::map<std::string, std::int32_t>& tags, const std::string& head) {
  std::vector<std::pair<std::int32_t, std::string>> rows;
  rows.reserve(tags.size());
  for (const auto& [name, tag] : tags) rows.emplace_back(tag, name);
  std::sort(rows.begin(), rows.end());
  std::string text = "| tag | " + head + " |\n|---:|---|\n";
  for (const auto& [tag, name] : rows) text += fmt::format("| {} | `{}` |\n", tag, name);
  return rows.empty() ? "none\n" : text;
}

std::string mesh_table(const Manifest& manifest) {
  std::string text = "| mesh | nodes | tetrahedra | faces | regions |\n|---|---:|---:|---:|---|\n";
  for (const auto& [name, mesh] : manifest.meshes) {
    std::string regions;
    for (const auto& [region, cells] : mesh.regions) regions += (regions.empty() ? "`" : ", `") + region + "`";
    text += fmt::format("| `{}` | {} | {} | {} | {} |\n", name, mesh.nodes, mesh.cells, mesh.faces, regions);
  }
  return text;
}

/// What a user must know before anything else.
std::string trust_text(const Manifest& manifest) {
  std::string text;
  if (!manifest.uses.empty()) text += "## What it is fit for\n\n| use | | why |\n|---|---|---|\n";
  for (const auto& use : manifest.uses) {
    std::string why = fmt::format("{}", fmt::join(use.reasons, " "));
    if (!use.remedy.empty()) why += (why.empty() ? "" : " ") + use.remedy;
    text += fmt::format("| {} | {} | {} |\n", use.use, fitness_names.at(static_cast<std::size_t>(use.fitness)), why);
  }
  if (!manifest.uses.empty()) text += "\n";
  if (!manifest.warnings.empty()) text += "## Warnings and notes\n\n";
  for (const auto& warning : manifest.warnings)
    text += fmt::format("- **{}** {} (`{}`)\n", warning_level_names.at(static_cast<std::size_t>(warning.level)),
                        warning.text, warning.code);
  return text.empty() ? "" : text + "\n";
}

std::string cavity_text(const Manifest& manifest) {
  if (manifest.caps.empty()) return "";
  std::string text = "## Cavities\n\n| mesh | cavity | ml | caps |\n|---|---|---:|---|\n";
  for (const auto& [name, mesh] : manifest.meshes)
    for (const auto& [cavity, entry] : mesh.cavities)
      text +=
          fmt::format("| `{}` | `{}` | {:.1f} | {} |\n", name, cavity, entry.volume_ml, fmt::join(entry.caps, ", "));
  return text + "\nCaps are triangles between the nodes of rims alone; they are no faces of the mesh.\n\n" +
         tag_table(manifest.caps, "cap") + "\n";
}

constexpr const char* readme_files = R"(## Files

| path | what |
|---|---|
| `meshes/NAME.vtu` | tetrahedra with regions and fibres |
| `surfaces/NAME.vtp` | outer faces and region interfaces of that mesh, each face once, each with one label; its rims |
| `cavities/NAME.vtp` | the closed surface of each pool of blood: the mesh's faces around it, and a cap over every opening |
| `curves/NAME.vtp` | the mesh's edges at which surfaces meet: rims of orifices and ends, lines between walls |
| `images/labels.nii.gz` | label map on the grid of the CT, values are the region tags below |
| `validation/metrics.json`, `validation/report.html` | the certificate: every figure and its bound; the same to look at |
| `recipe.toml` | the recipe with every setting written out: build it again with `heartgen build recipe.toml` |
| `manifest.json` | tags, counts and the SHA-256 of every file; check with `heartgen verify` |
| `ro-crate-metadata.json`, `CITATION.cff`, `LICENSE` | for catalogues, for citing, the terms |

The content id in `manifest.json` is the SHA-256 of its text without the keys `content_id`, `inputs`, `tools` and
`manifest_sha256`: it covers every file but `logs/*.log`, and names, tags, counts, unit and frame. Equal ids mean equal
models.

## Frame, units, arrays

Coordinates are millimetres in the frame of the scanned patient, LPS: x to the patient's left, y to the back, z to the
head. Many codes want metres, centimetres or micrometres: `heartgen export` converts.

| where | array | type | meaning |
|---|---|---|---|
| `.vtu` cells | `region` | int32 | tag of the tissue, see below |
| `.vtu` cells and points | `fiber`, `sheet`, `sheet_normal` | 3 float64 | orthonormal axes; their signs mean nothing; zero where there is no muscle |
| `.vtu` points | `fiber_source` | uint8 | 0 none, 1 atlas, 2 inpainted, 3 rule |
| `.vtu` cells | `rule_difference_deg` | float32 | angle between `fiber` and the axis of rule-based fibres; -1 outside the ventricles |
| `.vtu` points, cells | `parent_node`, `parent_cell` | int32 | 0-based ids in the larger mesh that holds this one (the torso), where there is one |
| `.vtu` cells | `user_region` | int32 | the user's own region that the cell counts for, 0: none |
| `.vtu` cells | `fraction_NAME` | float32 | the part of the cell in that region of the user's own, 0 to 1 |
| `.vtp` cells | `surface` | int32 | label of the face, see below |
| `.vtp` points | `GlobalNodeID` | int32 | **1-based** node of the point in the `.vtu` |
| `.vtp` points | one per rim, with the rim's name | uint8 | 1 on the rim: the curve where that surface ends |
| `.vtp` field | `rim_tag` | int32 | tags of the rims, in the order of their arrays |
| `cavities/` cells | `cavity` | int32 | tag of the blood; normals look out of it |
| `cavities/` cells | `surface` | int32 | of the mesh's face, or the tag of the cap |
| `curves/` cells | `curve` | int32 | 0-based number of the edge's curve |
| `curves/` field | `curve_name` | string | the curves' names: the surfaces that meet there, joined by `+` |

)";

constexpr const char* readme_loading = R"(## Loading

ParaView: open the `.vtu` and the `.vtp`, colour by `region` and `surface`; filter *Glyph* on `fiber`. Python:

```python
import meshio
mesh = meshio.read("meshes/{0}.vtu")
nodes, cells = mesh.points, mesh.cells_dict["tetra"]
region = mesh.cell_data_dict["region"]["tetra"]
fiber = mesh.point_data["fiber"]
```

The faces with VTK (`pip install vtk`):

```python
from vtk import vtkXMLPolyDataReader as Reader
from vtk.util.numpy_support import vtk_to_numpy
reader = Reader(); reader.SetFileName("surfaces/{0}.vtp"); reader.Update(); faces = reader.GetOutput()
surface = vtk_to_numpy(faces.GetCellData().GetArray("surface"))
node = vtk_to_numpy(faces.GetPointData().GetArray("GlobalNodeID")) - 1
```

)";

Json crate_files(const std::vector<ManifestFile>& files) {
  const auto media_type = [](const std::string& path) -> std::string {
    const auto ends_with = [&](const std::string& end) {
      return path.size() >= end.size() && path.compare(path.size() - end.size(), end.size(), end) == 0;
    };
    if (ends_with(".vtu") || ends_with(".vtp")) return "application/x-vtk";
    if (ends_with(".nii.gz")) return "application/gzip";
    if (ends_with(".json")) return "application/json";
    if (ends_with(".html")) return "text/html";
    if (ends_with(".toml")) return "application/toml";
    if (ends_with(".md")) return "text/markdown";
    return "text/plain";
  };
  Json entities = Json::array();
  for (const auto& file : files)
    entities.push_back({{"@id", file.path},
                        {"@type", "File"},
                        {"name", file.path},
                        {"contentSize", std::to_string(file.bytes)},
                        {"encodingFormat", media_type(file.path)}});
  return entities;
}

Json references(const Json& entities) {
  Json result = Json::array();
  for (const auto& entity : entities) result.push_back({{"@id", entity.at("@id")}});
  return result;
}

Json crate_inputs(const Manifest& manifest) {
  Json entities = Json::array();
  for (const auto& input : manifest.inputs)
    entities.push_back({{"@id", "#input-" + sha256_of_text(input.name).substr(0, 12)},
                        {"@type", "CreativeWork"},
                        {"name", input.name},
                        {"identifier", "sha256:" + input.sha256}});
  return entities;
}

Json crate_authors(const Manifest& manifest) {
  Json entities = Json::array();
  for (const auto& author : authors_of(manifest))
    entities.push_back(
        {{"@id", "#author-" + sha256_of_text(author).substr(0, 12)}, {"@type", "Person"}, {"name", author}});
  return entities;
}

Json crate_root(const Manifest& manifest, const Json& files, const Json& authors) {
  std::string description = fmt::format(
      "Simulation-ready heart model {} {}: labelled tetrahedral meshes with fibres, made by heartgen from a CT.",
      manifest.name, manifest.version);
  if (!manifest.atlas.empty()) description += " Fibres: " + manifest.atlas;
  Json root{{"@id", "./"},
            {"@type", "Dataset"},
            {"name", manifest.name},
            {"description", description},
            {"version", manifest.version}};
  // RO-Crate wants a date, but a wrong one is worse than none: whoever publishes gives it in the recipe.
  if (is_date(manifest.date_published)) root["datePublished"] = manifest.date_published;
  if (!manifest.attribution.empty()) root["creditText"] = manifest.attribution;
  root.update({{"license", {{"@id", license_url(manifest.license)}}},
               {"author", references(authors)},
               {"hasPart", references(files)},
               {"mentions", {{"@id", "#build"}}}});
  return root;
}

}  // namespace

std::string readme_text(const Manifest& manifest) {
  std::string text = fmt::format("# {} {}\n\n", manifest.name, manifest.version);
  text += "Heart model for simulation, made by heartgen. Not for diagnosis or treatment.\n\n";
  text += trust_text(manifest) + "## Meshes\n\n" + mesh_table(manifest) + "\n" + readme_files;
  text += "## Regions\n\n" + tag_table(manifest.regions, "region");
  text += "\n## Surfaces\n\n" + tag_table(manifest.surfaces, "surface");
  text += "\n## Rims\n\n" + tag_table(manifest.rims, "rim") + "\n";
  if (!manifest.user_regions.empty())
    text += "## Regions of the user's own\n\n" + tag_table(manifest.user_regions, "region") + "\n";
  text += cavity_text(manifest);
  if (!manifest.meshes.empty())
    text +=
        fmt::format(fmt::runtime(readme_loading),
                    manifest.meshes.count("myocardium") ? std::string("myocardium") : manifest.meshes.begin()->first);
  text += "## Fibres\n\n" + (manifest.atlas.empty() ? std::string("No atlas is named.") : manifest.atlas) + "\n\n";
  if (!manifest.attribution.empty()) text += "## Made from\n\n" + manifest.attribution + "\n\n";
  text += fmt::format("## Licence\n\n{}, see `LICENSE`. How to cite: `CITATION.cff`.\n", manifest.license);
  return text;
}

std::string license_text(const Manifest& manifest) {
  std::string owners;
  for (const auto& author : authors_of(manifest)) owners += (owners.empty() ? "" : ", ") + author;
  std::string text = fmt::format("{} {}\nAuthor: {}\nSPDX-License-Identifier: {}\n", manifest.name, manifest.version,
                                 owners, manifest.license);
  if (is_spdx(manifest.license)) text += "Full text: " + license_url(manifest.license) + "\n";
  if (!manifest.attribution.empty()) text += "\nMade from: " + manifest.attribution + "\n";
  text += "\nThe terms of the scan and of the atlas that the model was made from apply beside this licence.\n";
  return text;
}

std::string citation_text(const Manifest& manifest) {
  std::string text =
      "cff-version: 1.2.0\nmessage: \"If you use this model, please cite it as below.\"\ntype: dataset\n";
  text += "title: " + quoted(manifest.name) + "\nversion: " + quoted(manifest.version) + "\nauthors:\n";
  for (const auto& author : authors_of(manifest)) text += "  - name: " + quoted(author) + "\n";
  if (is_spdx(manifest.license)) text += "license: " + manifest.license + "\n";
  if (is_date(manifest.date_published)) text += "date-released: " + manifest.date_published + "\n";
  return text;
}

std::string ro_crate_text(const Manifest& manifest, const std::vector<ManifestFile>& files) {
  const Json file_entities = crate_files(files);
  const Json authors = crate_authors(manifest), inputs = crate_inputs(manifest);
  Json graph = Json::array();
  graph.push_back({{"@id", "ro-crate-metadata.json"},
                   {"@type", "CreativeWork"},
                   {"conformsTo", {{"@id", "https://w3id.org/ro/crate/1.1"}}},
                   {"about", {{"@id", "./"}}}});
  graph.push_back(crate_root(manifest, file_entities, authors));
  graph.push_back({{"@id", license_url(manifest.license)}, {"@type", "CreativeWork"}, {"name", manifest.license}});
  graph.push_back({{"@id", "#heartgen"}, {"@type", "SoftwareApplication"}, {"name", "heartgen"}});
  graph.push_back({{"@id", "#build"},
                   {"@type", "CreateAction"},
                   {"name", "heartgen build recipe.toml"},
                   {"instrument", {{"@id", "#heartgen"}}},
                   {"object", references(inputs)},
                   {"result", {{"@id", "./"}}}});
  for (const auto* group : {&authors, &inputs, &file_entities})
    for (const auto& entity : *group) graph.push_back(entity);
  const Json crate = {{"@context", "https://w3id.org/ro/crate/1.1/context"}, {"@graph", graph}};
  return crate.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace heartgen::exporters
