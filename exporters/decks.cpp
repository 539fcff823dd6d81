// SPDX-License-Identifier: GPL-3.0-or-later
#include "exporters/decks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <stdexcept>

#include "exporters/adjacency.hpp"
#include "exporters/formats.hpp"
#include "model/labels.hpp"
#include "model/priors.hpp"
#include "model/text.hpp"

namespace heartgen::exporters {
namespace {

struct DeckFile {
  std::string_view folder;  ///< of exporters/decks
  std::string_view path;    ///< in it
  std::string_view text;
};

constexpr DeckFile deck_files[] = {
#include "exporters/deck_files.inc"
};

/// Formats that share a folder of decks.
std::string_view folder_of(std::string_view format) {
  if (format.starts_with("opencarp")) return "opencarp";
  if (format.starts_with("msh")) return "msh";
  if (format == "vtk" || format == "vtk-ascii" || format == "vtu") return "vtk";
  if (format == "stl" || format == "ply" || format == "obj" || format == "vtp") return "surfaces";
  return format;
}

bool has_muscle(const TetMesh& mesh) {
  return has_fibers(mesh) &&
         std::find(mesh.region.begin(), mesh.region.end(), tag(Region::lv_myocardium)) != mesh.region.end();
}

bool has_other_tissue(const TetMesh& mesh) {
  return std::any_of(mesh.region.begin(), mesh.region.end(),
                     [](std::int32_t region) { return !is_myocardium(static_cast<Region>(region)); });
}

using Values = std::map<std::string, std::string>;

/// Every "{{key}}" is replaced by its value.
std::string filled(std::string_view text, const Values& values, std::string_view file) {
  std::string result;
  while (true) {
    const auto begin = text.find("{{");
    result += text.substr(0, begin);
    if (begin == std::string_view::npos) return result;
    const auto end = text.find("}}", begin);
    const auto value = values.find(std::string(text.substr(begin + 2, end - begin - 2)));
    if (value == values.end())
      throw std::logic_error(fmt::format("deck {} asks for {}", file, text.substr(begin, end - begin)));
    result += value->second;
    text.remove_prefix(end + 2);
  }
}

template <class Groups>
std::string table(const std::map<std::int32_t, std::string>& names, const Groups& groups, const char* what,
                  const char* of) {
  std::string text = fmt::format("| {} | tag | {} |\n|---|---:|---:|\n", what, of);
  for (const auto& [tag, members] : groups)
    text += fmt::format("| `{}` | {} | {} |\n", names.at(tag), tag, members.size());
  return text;
}

std::string cavities_text(const TetMesh& mesh) {
  if (mesh.cavities.empty()) return "";
  std::string text =
      "\nCavities: closed surfaces out of the blood, the mesh's faces and a cap of triangles over every opening, whose "
      "nodes are those of the rim (NAME_cavities.csv, and in the format's own way where it has one).\n\n"
      "| cavity | triangles | caps |\n|---|---:|---|\n";
  for (const auto& cavity : mesh.cavities) {
    std::set<std::string> caps;
    for (const auto tag : cavity.surface)
      if (is_cap(tag)) caps.insert(surface_name(tag));
    text += fmt::format("| `{}` | {} | {} |\n", cavity.name, cavity.faces.size(), fmt::join(caps, ", "));
  }
  return text;
}

std::string user_regions_text(const TetMesh& mesh) {
  if (mesh.user_regions.empty()) return "";
  std::string text =
      "\nRegions of the user's own: the tag in `user_region` where a cell counts for one, its part in each as "
      "`fraction_NAME`. Where this format has no place for these, they stand in NAME_user_regions.csv.\n\n"
      "| user region | tag | tetrahedra |\n|---|---:|---:|\n";
  const auto cells = cells_by_user_region(mesh);
  for (const auto& region : mesh.user_regions) {
    const auto found = cells.find(region.name);
    text +=
        fmt::format("| `{}` | {} | {} |\n", region.name, region.tag, found == cells.end() ? 0 : found->second.size());
  }
  return text;
}

std::vector<std::int32_t> tags_where(const TetMesh& mesh, bool (*accept)(Region)) {
  std::vector<std::int32_t> tags;
  for (const auto& [tag, name] : regions_of(mesh))
    if (accept(static_cast<Region>(tag))) tags.push_back(tag);
  return tags;
}

bool is_atrium(Region r) { return r == Region::la_wall || r == Region::ra_wall; }
bool is_ventricle(Region r) { return is_myocardium(r) && !is_atrium(r) && !is_annulus(r); }
bool is_muscle(Region r) { return is_atrium(r) || is_ventricle(r); }
bool is_passive(Region r) { return !is_muscle(r); }
bool is_bath(Region r) { return !is_myocardium(r); }

/// "PREFIX.num_IDs = 2", "PREFIX.ID[0] = 4" ...
std::string id_lines(const std::string& prefix, const std::vector<std::int32_t>& tags) {
  std::string text = fmt::format("{}.num_IDs = {}\n", prefix, tags.size());
  for (std::size_t i = 0; i < tags.size(); ++i) text += fmt::format("{}.ID[{}] = {}\n", prefix, i, tags[i]);
  return text;
}

/// Conductivity of tissue without fibres, S/m at 10 Hz: Gabriel et al., Phys Med Biol 41:2271 (1996).
double conductivity_S_per_m(Region r) {
  if (is_blood(r)) return 0.7;
  if (r == Region::lung) return 0.039;
  if (r == Region::bone) return 0.02;
  if (r == Region::liver) return 0.028;
  if (r == Region::trachea) return 1e-4;  // air
  return 0.2;
}

/// A conductivity region of openCARP.
struct Gregion {
  std::string name;
  std::vector<std::int32_t> tags;
  std::vector<std::string> settings;  ///< "g_il = 0.17" ...
};

/// Muscle: Clerc, J Physiol 255:335 (1976).
std::vector<Gregion> gregions_of(const TetMesh& mesh) {
  std::vector<Gregion> groups = {
      {"ventricles",
       tags_where(mesh, &is_ventricle),
       {"g_il = 0.17", "g_it = 0.019", "g_in = 0.019", "g_el = 0.62", "g_et = 0.24", "g_en = 0.24"}},
      {"atria",
       tags_where(mesh, &is_atrium),
       {"g_il = 1e-6", "g_it = 1e-6", "g_in = 1e-6", "g_el = 0.62", "g_et = 0.24", "g_en = 0.24"}}};
  for (const auto tag : tags_where(mesh, &is_passive))
    groups.push_back(
        {region_name(tag), {tag}, {fmt::format("g_bath = {}", conductivity_S_per_m(static_cast<Region>(tag)))}});
  std::erase_if(groups, [](const Gregion& group) { return group.tags.empty(); });
  return groups;
}

std::string opencarp_gregions(const TetMesh& mesh) {
  const auto groups = gregions_of(mesh);
  std::string text = fmt::format("num_gregions = {}\n", groups.size());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto prefix = fmt::format("gregion[{}]", g);
    text += fmt::format("{}.name = {}\n{}", prefix, groups[g].name, id_lines(prefix, groups[g].tags));
    for (const auto& setting : groups[g].settings) text += fmt::format("{}.{}\n", prefix, setting);
  }
  return text;
}

std::string python_conductivities(const TetMesh& mesh) {
  std::string text;
  for (const auto tag : tags_where(mesh, &is_passive))
    text += fmt::format("    {}: {},  # {}\n", tag, conductivity_S_per_m(static_cast<Region>(tag)), region_name(tag));
  return text;
}

void add_opencarp(const TetMesh& mesh, Values& values) {
  const auto muscle = tags_where(mesh, &is_muscle), passive = tags_where(mesh, &is_passive);
  auto everything = muscle;
  everything.insert(everything.end(), passive.begin(), passive.end());
  values["opencarp_cells"] = id_lines("imp_region[0]", muscle);
  values["opencarp_gregions"] = opencarp_gregions(mesh);
  values["opencarp_bidomain"] = tags_where(mesh, &is_bath).empty() ? "0" : "2";
  values["opencarp_intra"] = id_lines("phys_region[0]", muscle);
  values["opencarp_extra"] = id_lines("phys_region[1]", everything);
}

std::string svmultiphysics_domain(std::int32_t tag, bool conducts, const char* stimulus) {
  return fmt::format(
      "    <Domain id=\"{}\">\n      <Electrophysiology_model> TTP </Electrophysiology_model>\n"
      "      <Myocardial_zone> epicardium </Myocardial_zone>\n"
      "      <Isotropic_conductivity> {} </Isotropic_conductivity>\n"
      "      <Anisotropic_conductivity> {} </Anisotropic_conductivity>\n{}"
      "      <ODE_solver> RK4 </ODE_solver>\n    </Domain>\n",
      tag, conducts ? 0.012571 : 1e-9, conducts ? 0.082715 : 0, stimulus);
}

void add_svmultiphysics(const ExportTask& task, Values& values) {
  std::string faces, domains;
  for (const auto& [tag, name] : surfaces_of(task.mesh))
    faces += fmt::format(
        "    <Add_face name=\"{}\">\n      <Face_file_path> {}-mesh-complete/mesh-surfaces/{}.vtp </Face_file_path>\n"
        "    </Add_face>\n",
        name, task.mesh_name, name);
  for (const auto tag : tags_where(task.mesh, &is_myocardium))
    domains += svmultiphysics_domain(tag, is_ventricle(static_cast<Region>(tag)), "");
  domains += svmultiphysics_domain(stimulus_domain, true,
                                   "      <Stimulus type=\"Istim\">\n        <Amplitude> -35.714 </Amplitude>\n"
                                   "        <Start_time> 0.0 </Start_time>\n        <Duration> 2.0 </Duration>\n"
                                   "        <Cycle_length> 10000.0 </Cycle_length>\n      </Stimulus>\n");
  values["svmultiphysics_faces"] = faces;
  values["svmultiphysics_domains"] = domains;
  values["stimulus_domain"] = fmt::format("{}", stimulus_domain);
}

/// The surface whose nodes a filled heart is held by.
std::string held_surface(const TetMesh& mesh) {
  const auto names = surfaces_of(mesh);
  for (const char* name : {"base", "atrioventricular_junction", "epicardium"})
    if (names.contains(*surface_from_name(name))) return name;
  return names.empty() ? "none" : names.begin()->second;
}

/// Stress in the unit that goes with N and the mesh's unit of length: MPa for mm, Pa for m.
std::string stress(double kPa, double mm) { return fmt::format("{:g}", kPa * 1e-3 / (mm * mm)); }

void add_mechanics(const TetMesh& mesh, double mm, Values& values) {
  std::string domains;
  for (const auto& [tag, name] : regions_of(mesh))
    domains += fmt::format("    <SolidDomain name=\"{}\" mat=\"muscle\"/>\n", name);
  values["febio_domains"] = domains;
  values["held_surface"] = held_surface(mesh);
  values["held_nodes"] = "N_" + held_surface(mesh);
  values["pressure"] = stress(1, mm);
  values["c1"] = stress(1, mm);
  values["c3"] = stress(0.5, mm);
  values["c5"] = stress(50, mm);
  values["bulk"] = stress(100, mm);
  const auto along = stress(20, mm), across = stress(10, mm), shear = stress(4, mm);
  values["stiffness"] =
      fmt::format("{}, {}, {}, 0.4, 0.4, 0.4, {}, {}\n{}", along, across, across, shear, shear, shear);
}

Values values_of(const ExportFormat& format, const ExportTask& task) {
  const TetMesh& mesh = task.mesh;
  const Vec3 site = septal_site(mesh);
  const double mm = unit_scale(task.unit), radius = priors::stimulus_radius_mm * mm;
  Values values = {{"mesh", task.mesh_name},
                   {"format", std::string(format.name)},
                   {"unit", task.unit},
                   {"mm", fmt::format("{}", mm)},
                   {"to_mm", fmt::format("{}", 1 / mm)},
                   {"nodes", fmt::format("{}", mesh.nodes_mm.size())},
                   {"cells", fmt::format("{}", mesh.cells.size())},
                   {"x", fmt::format("{}", site.x)},
                   {"y", fmt::format("{}", site.y)},
                   {"z", fmt::format("{}", site.z)},
                   {"radius", fmt::format("{:g}", radius)},
                   {"box_low", fmt::format("{} {} {}", site.x - radius, site.y - radius, site.z - radius)},
                   {"box_high", fmt::format("{} {} {}", site.x + radius, site.y + radius, site.z + radius)},
                   {"ventricles", fmt::format("{}", fmt::join(tags_where(mesh, &is_ventricle), ", "))},
                   {"muscle", fmt::format("{}", fmt::join(tags_where(mesh, &is_muscle), ", "))},
                   {"bath", fmt::format("{}", fmt::join(tags_where(mesh, &is_passive), ", "))},
                   {"regions", table(regions_of(mesh), cells_by_region(mesh), "region", "tetrahedra")},
                   {"surfaces", table(surfaces_of(mesh), faces_by_surface(mesh), "surface", "triangles")},
                   {"user_regions", user_regions_text(mesh)},
                   {"cavities", cavities_text(mesh)},
                   {"python_conductivities", python_conductivities(mesh)}};
  add_opencarp(mesh, values);
  add_svmultiphysics(task, values);
  add_mechanics(mesh, mm, values);
  return values;
}

bool applies(std::string_view path, const TetMesh& mesh) {
  if (path.starts_with("muscle/")) return has_muscle(mesh);
  if (path.starts_with("torso/")) return has_muscle(mesh) && has_other_tissue(mesh);
  if (path.starts_with("heart/")) return has_muscle(mesh) && !has_other_tissue(mesh);
  return true;
}

/// Where a deck's file goes: without its condition, NAME replaced by the mesh's.
std::string place_of(std::string_view path, const std::string& mesh_name) {
  for (const std::string_view condition : {"muscle/", "torso/", "heart/"})
    if (path.starts_with(condition)) path.remove_prefix(condition.size());
  if (path == "README.md") return mesh_name + "_README.md";
  std::string place(path);
  const auto at = place.find("NAME");
  return at == std::string::npos ? place : place.replace(at, 4, mesh_name);
}

constexpr std::string_view readme_head = R"(# {{mesh}}: {{format}}

{{nodes}} nodes, {{cells}} tetrahedra, in {{unit}}. Frame LPS: x to the patient's left, y to the back, z to the head.
Made by heartgen. Not for diagnosis or treatment.

)";
constexpr std::string_view readme_tail = "\n## Tags\n\n{{regions}}\n{{surfaces}}{{user_regions}}{{cavities}}";

}  // namespace

Vec3 septal_site(const TetMesh& mesh) {
  const auto right = *surface_from_name("rv_endocardium"), left = *surface_from_name("lv_endocardium");
  const auto sides = cells_of_faces(mesh);
  Vec3 middle;
  double count = 0;
  std::vector<std::int32_t> candidates;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (mesh.surface[f] == left) candidates.insert(candidates.end(), mesh.faces[f].begin(), mesh.faces[f].end());
    const bool is_septum = mesh.surface[f] == right && std::any_of(sides[f].begin(), sides[f].end(), [&](auto c) {
                             return c >= 0 && mesh.region[static_cast<std::size_t>(c)] == tag(Region::lv_myocardium);
                           });
    if (!is_septum) continue;
    for (const auto node : mesh.faces[f]) middle += mesh.nodes_mm[static_cast<std::size_t>(node)];
    count += 3;
  }
  if (candidates.empty()) candidates = {mesh.cells[0][0]};
  const auto at = [&](std::int32_t node) { return mesh.nodes_mm[static_cast<std::size_t>(node)]; };
  if (count == 0) return at(candidates.front());
  middle *= 1 / count;
  return at(*std::min_element(candidates.begin(), candidates.end(),
                              [&](auto a, auto b) { return norm(at(a) - middle) < norm(at(b) - middle); }));
}

Files write_deck(const ExportFormat& format, const ExportTask& task) {
  const Values values = values_of(format, task);
  Files files;
  for (const auto& deck : deck_files) {
    if (deck.folder != folder_of(format.name) || !applies(deck.path, task.mesh)) continue;
    files.push_back(task.folder / place_of(deck.path, task.mesh_name));
    const bool is_readme = deck.path.ends_with("README.md");
    const std::string text = is_readme ? std::string(readme_head) + std::string(deck.text) + std::string(readme_tail)
                                       : std::string(deck.text);
    write_text(files.back(), filled(text, values, deck.path));
  }
  return files;
}

}  // namespace heartgen::exporters
