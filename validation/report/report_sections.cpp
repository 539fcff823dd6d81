// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/report/report_sections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "generator/parallel/tasks.hpp"
#include "model/labels.hpp"
#include "validation/cell_quality.hpp"
#include "validation/report/html_text.hpp"
#include "validation/report/pictures.hpp"
#include "validation/report/slice_data.hpp"
#include "validation/report/viewer_data.hpp"

namespace heartgen::report {
namespace {

const TetMesh* mesh_named(const ReportInput& input, const std::string& name) {
  if (!input.meshes) return nullptr;
  const auto at = input.meshes->find(name);
  return at == input.meshes->end() || at->second.cells.empty() ? nullptr : &at->second;
}

/// What a script of the page unpacks (pageData in web/data.js).
std::string page_data(const std::string& name, const std::string& index_json, const std::string& data_base64) {
  return fmt::format(
      "<script type=\"application/json\" id=\"{0}-index\">{1}</script>\n<script type=\"text/plain\" "
      "id=\"{0}-data\">{2}</script>\n",
      name, index_json, data_base64);
}

std::string viewer_html(const ReportInput& input, const Shared& shared) {
  const ViewerData data = viewer_data(*input.meshes, shared.all_faces(), shared.fields);
  if (data.empty) return "";
  return "<h2 id=\"view\">The heart in 3D</h2>\n<div id=\"viewer\"><div class=\"stage\"><canvas tabindex=\"0\" "
         "aria-label=\"3D view of the model\"></canvas><div class=\"failed\"><p>This browser cannot show the model in "
         "3D: that needs JavaScript, WebGL 2 and DecompressionStream.</p></div></div>\n<div "
         "class=\"panel\"></div></div>\n" +
         page_data("model", data.index_json, data.data_base64);
}

std::string slices_html(const ReportInput& input) {
  const SliceData data = slice_data(input.ct, *input.labels);
  if (data.empty) return "";
  const char* lead =
      data.has_ct ? "The label map's contours on the CT around the heart. Click to move all three planes; the place "
                    "shows in 3D as well."
                  : "The label map around the heart. The CT itself is not part of a bundle: a report made from the "
                    "bundle alone shows the labels without it.";
  return fmt::format("<h2 id=\"image\">Slices</h2>\n<p class=\"lead\">{}</p>\n<div id=\"slices\"></div>\n", lead) +
         page_data("image", data.index_json, data.data_base64);
}

std::vector<double> dihedral_angles(const TetMesh& mesh) {
  std::vector<double> angles;
  angles.reserve(mesh.cells.size() * 6);
  for (const Cell& cell : mesh.cells) {
    std::array<Vec3, 4> corners;
    for (std::size_t k = 0; k < 4; ++k) corners[k] = mesh.nodes_mm[static_cast<std::size_t>(cell[k])];
    for (const double angle : validation::cell_quality(corners).dihedral_deg) angles.push_back(angle);
  }
  return angles;
}

std::string card(const std::string& title, const std::string& svg) {
  return "<div class=\"card\"><h3>" + escaped(title) + "</h3>" + svg + "</div>\n";
}

ProfileSeries profile_series(const validation::HelixProfile& p, const std::string& name) {
  return {name, p.depth, p.median_deg, p.p10_deg, p.p90_deg};
}

std::string helix_profiles(const ReportInput& input, const TetMesh& walls) {
  std::vector<ProfileSeries> series = {
      profile_series(validation::helix_profile(walls, Region::lv_myocardium), "left ventricle"),
      profile_series(validation::helix_profile(walls, Region::rv_myocardium), "right ventricle")};
  if (!input.atlas_lv.depth.empty()) series.push_back(profile_series(input.atlas_lv, "atlas, left"));
  if (!input.atlas_rv.depth.empty()) series.push_back(profile_series(input.atlas_rv, "atlas, right"));
  return card("Helix angle through the wall", helix_profile_svg(series));
}

std::string helix_histogram(const std::vector<double>& helix_deg) {
  std::vector<double> angles;
  for (const double a : helix_deg)
    if (std::isfinite(a)) angles.push_back(a);
  return card("Helix angles of all nodes", histogram_svg({"helix angle", angles}, -90, 90, 60, "degrees"));
}

}  // namespace

const std::vector<double>* Shared::helix_deg() const {
  const auto at =
      std::find_if(fields.begin(), fields.end(), [](const validation::WallField& f) { return f.id == "helix"; });
  return at == fields.end() ? nullptr : &at->values;
}

std::string joined(const Pieces& pieces) {
  std::vector<std::string> texts(pieces.size());
  std::vector<std::function<void()>> tasks;
  for (std::size_t p = 0; p < pieces.size(); ++p) tasks.emplace_back([&, p] { texts[p] = pieces[p](); });
  parallel::run_tasks(tasks);
  std::string all;
  for (const auto& text : texts) all += text;
  return all;
}

Shared shared_by_pieces(const ReportInput& input) {
  Shared shared;
  shared.given_faces = input.faces;
  if (!input.meshes) return shared;
  if (!shared.given_faces) shared.own_faces = validation::faces_of_meshes(*input.meshes);
  if (const TetMesh* walls = mesh_named(input, "myocardium"))
    shared.fields = validation::wall_fields(*walls, helix_angle_per_node(*walls, shared.all_faces().at("myocardium")));
  return shared;
}

Pieces viewer_section(const ReportInput& input, const Shared& shared) {
  if (!input.meshes) return {};
  return {[&input, &shared] { return viewer_html(input, shared); }};
}

Pieces slices_section(const ReportInput& input, const Shared&) {
  if (!input.labels) return {};
  return {[&input] { return slices_html(input); }};
}

Pieces charts_section(const ReportInput& input, const Shared& shared) {
  if (!input.meshes || input.meshes->empty()) return {};
  Pieces pieces;
  const auto add = [&](std::string text) { pieces.emplace_back([text = std::move(text)] { return text; }); };
  add("<h2 id=\"charts\">Charts</h2>\n<details><summary>Fibres through the wall, angles of the "
      "elements</summary>\n<div "
      "class=\"row\">\n");
  const TetMesh* walls = mesh_named(input, "myocardium");
  if (walls && shared.helix_deg()) {
    pieces.emplace_back([&input, walls] { return helix_profiles(input, *walls); });
    pieces.emplace_back([&shared] { return helix_histogram(*shared.helix_deg()); });
  }
  for (const char* name : {"myocardium", "chambers"})
    if (const TetMesh* mesh = mesh_named(input, name))
      pieces.emplace_back([name, mesh] {
        return card(std::string("Dihedral angles, ") + name,
                    histogram_svg({"dihedral angle", dihedral_angles(*mesh)}, 0, 180, 60, "degrees"));
      });
  add("</div></details>\n");
  return pieces;
}

}  // namespace heartgen::report
