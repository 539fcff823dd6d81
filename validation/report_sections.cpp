#include "validation/report_sections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "model/labels.hpp"
#include "validation/cell_quality.hpp"
#include "validation/fiber_checks.hpp"
#include "validation/heart_frame.hpp"
#include "validation/html_text.hpp"
#include "validation/palette.hpp"
#include "validation/pictures.hpp"
#include "validation/quantiles.hpp"
#include "validation/viewer_data.hpp"
#include "web_assets.hpp"

namespace heart::validation {
namespace {

std::string figure(const PngBytes& png, const std::string& caption, bool on_white) {
  return fmt::format("<figure><img{} alt=\"{}\" src=\"{}\"><figcaption>{}</figcaption></figure>\n",
                     on_white ? " class=\"on-white\"" : "", escaped(caption), png_source(png), escaped(caption));
}

std::string region_words(std::int32_t region) {
  std::string name = region_name(region);
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::string legend(const std::vector<std::int32_t>& regions) {
  std::string html = "<div class=\"legend\">";
  for (const auto region : regions) {
    const Rgb c = region_color(region);
    html += fmt::format("<span><i style=\"background:rgb({},{},{})\"></i>{}</span>", c.r, c.g, c.b,
                        escaped(region_words(region)));
  }
  return html + "</div>\n";
}

const TetMesh* mesh_named(const ReportInput& input, const std::string& name) {
  if (!input.meshes) return nullptr;
  const auto at = input.meshes->find(name);
  return at == input.meshes->end() || at->second.cells.empty() ? nullptr : &at->second;
}

bool is_chamber_or_wall(std::uint8_t label) {
  const auto r = static_cast<Region>(label);
  return is_myocardium(r) || (is_blood(r) && r != Region::aorta && r != Region::pulmonary_artery);
}

struct Extent {
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  bool empty() const { return low.x > high.x; }
};

/// LPS box of the labelled heart, or of everything labelled where there is no heart.
Extent heart_extent(const LabelVolume& labels) {
  Extent heart, all;
  std::size_t v = 0;
  for (std::int64_t k = 0; k < labels.grid.size[2]; ++k)
    for (std::int64_t j = 0; j < labels.grid.size[1]; ++j)
      for (std::int64_t i = 0; i < labels.grid.size[0]; ++i, ++v) {
        if (labels.voxels[v] == 0) continue;
        const Vec3 p =
            lps_from_index(labels.grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        for (Extent* e : {&all, &heart}) {
          if (e == &heart && !is_chamber_or_wall(labels.voxels[v])) continue;
          for (int a = 0; a < 3; ++a) e->low[a] = std::min(e->low[a], p[a]), e->high[a] = std::max(e->high[a], p[a]);
        }
      }
  return heart.empty() ? all : heart;
}

/// Index of the slice through a point, along the grid axis that runs nearest to a patient axis.
std::int64_t slice_through(const Grid& grid, const Vec3& p, int patient_axis) {
  std::size_t axis = 0;
  for (std::size_t a = 1; a < 3; ++a)
    if (std::abs(grid.direction[patient_axis][static_cast<int>(a)]) >
        std::abs(grid.direction[patient_axis][static_cast<int>(axis)]))
      axis = a;
  const Vec3 index = index_from_lps(grid, p);
  return std::clamp<std::int64_t>(std::lround(index[static_cast<int>(axis)]), 0, grid.size[axis] - 1);
}

/// Fat to a little above the brightest common blood, so that contrast shows its structure in any protocol.
GreyWindow grey_window(const ReportInput& input) {
  if (!input.ct || !(input.ct->grid == input.labels->grid)) return {};
  std::vector<double> blood;
  for (std::size_t v = 0; v < input.labels->voxels.size(); ++v)
    if (is_blood(static_cast<Region>(input.labels->voxels[v]))) blood.push_back(input.ct->voxels[v]);
  if (blood.empty()) return {};
  constexpr double low_hu = -180, least_high_hu = 300, most_high_hu = 1200;
  const double high_hu = std::clamp(1.1 * quantile(std::move(blood), 0.9), least_high_hu, most_high_hu);
  return {(low_hu + high_hu) / 2, high_hu - low_hu};
}

struct PlaneRow {
  SlicePlane plane;
  const char* name;
  int patient_axis;
  std::vector<double> shares;  ///< of the heart's extent along the axis
};

std::string slice_row(const ReportInput& input, const PlaneRow& row, const Extent& heart, const GreyWindow& window) {
  const Grid& grid = input.ct ? input.ct->grid : input.labels->grid;
  const Vec3 size = heart.high - heart.low;
  std::string html = fmt::format("<div class=\"row {}\">\n", row.shares.size() == 3 ? "three" : "two");
  for (const double share : row.shares) {
    Vec3 at = 0.5 * (heart.low + heart.high);
    at[row.patient_axis] = heart.low[row.patient_axis] + share * size[row.patient_axis];
    SliceOptions options;
    options.legend = false;
    options.window = window;
    options.width_px = row.shares.size() == 3 ? input.picture_width_px * 5 / 6 : input.picture_width_px;
    options.center_mm = at;
    options.field_mm = 1.22 * std::max({size.x, size.y, size.z});
    const std::int64_t index = slice_through(grid, at, row.patient_axis);
    const char axis = "xyz"[row.patient_axis];
    html += figure(slice_picture(input.ct, input.labels, row.plane, index, options),
                   fmt::format("{}, {} = {:.0f} mm", row.name, axis, at[row.patient_axis]), false);
  }
  return html + "</div>\n";
}

std::vector<std::int32_t> regions_of(const std::vector<std::int32_t>& tags) {
  std::vector<std::int32_t> regions = tags;
  std::sort(regions.begin(), regions.end());
  regions.erase(std::unique(regions.begin(), regions.end()), regions.end());
  return regions;
}

std::vector<double> dihedral_angles(const TetMesh& mesh) {
  std::vector<double> angles;
  angles.reserve(mesh.cells.size() * 6);
  for (const Cell& cell : mesh.cells) {
    std::array<Vec3, 4> corners;
    for (std::size_t k = 0; k < 4; ++k) corners[k] = mesh.nodes_mm[static_cast<std::size_t>(cell[k])];
    for (const double angle : cell_quality(corners).dihedral_deg) angles.push_back(angle);
  }
  return angles;
}

std::string mesh_charts(const ReportInput& input) {
  std::string html = fmt::format("<div class=\"row {}\">\n", input.meshes->size() > 2 ? "three" : "two");
  for (const auto& [name, mesh] : *input.meshes)
    if (!mesh.cells.empty())
      html += "<div class=\"card\"><h3>" + escaped(name) + "</h3>" +
              histogram_svg({"dihedral angles", dihedral_angles(mesh)}, 0, 180, 60, "degrees") + "</div>\n";
  return html + "</div>\n";
}

MeshPictureOptions mesh_options(int width_px) {
  MeshPictureOptions options;
  options.width_px = width_px;
  options.height_px = width_px * 30 / 31;
  return options;
}

std::string heart_pictures(const TetMesh& walls, int width_px) {
  MeshPictureOptions options = mesh_options(width_px);
  std::string html = "<div class=\"row two\">\n";
  html +=
      figure(mesh_picture(walls, View::front, options), "From the front. The patient's left is on the right.", true);
  html += figure(mesh_picture(walls, View::back, options), "From behind.", true);
  options.cut = CutPlane{heart_frame(walls).center_mm, {0, -1, 0}};
  html += figure(mesh_picture(walls, View::front, options),
                 "Cut open in front, cell by cell, through the left ventricle.", true);
  options.cut = CutPlane{heart_frame(walls).center_mm, {0, 0, -1}};
  html += figure(mesh_picture(walls, View::below, options), "Cut across, seen from below.", true);
  html += "</div>\n" + legend(regions_of(walls.region));
  return html;
}

std::string torso_pictures(const TetMesh& torso, const TetMesh* walls, int width_px) {
  Vec3 center;
  for (const Vec3& p : torso.nodes_mm) center += p / static_cast<double>(torso.nodes_mm.size());
  if (walls) center = heart_frame(*walls).center_mm;
  MeshPictureOptions options = mesh_options(width_px);
  options.cut = CutPlane{center, {0, -1, 0}};
  std::string html = "<div class=\"row two\">\n";
  html += figure(mesh_picture(torso, View::front, options), "Torso, cut in front through the heart.", true);
  options.cut = CutPlane{center, {0, 0, -1}};
  html +=
      figure(mesh_picture(torso, View::below, options), "Torso, cut across through the heart, seen from below.", true);
  return html + "</div>\n" + legend(regions_of(torso.region));
}

std::string vessel_picture(const TetMesh& mesh, const std::string& name, int width_px) {
  MeshPictureOptions options = mesh_options(width_px);
  options.color = MeshColor::surface;
  return figure(mesh_picture(mesh, View::front, options), name + ", coloured by labelled surface.", true);
}

ProfileSeries profile_series(const TetMesh& walls, Region ventricle, const std::string& name) {
  const HelixProfile p = helix_profile(walls, ventricle);
  return {name, p.depth, p.median_deg, p.p10_deg, p.p90_deg};
}

}  // namespace

std::string viewer_section(const ReportInput& input) {
  if (!input.meshes) return "";
  const ViewerData data = viewer_data(*input.meshes);
  if (data.empty) return "";
  std::string html =
      "<h2 id=\"view\">The model in 3D</h2>\n<div id=\"viewer\"><div class=\"stage\"><canvas tabindex=\"0\" "
      "aria-label=\"3D view\"></canvas><p class=\"failed\">This browser shows no WebGL 2. The pictures below show the "
      "same model.</p></div>\n<div class=\"panel\">"
      "<label>Colour<select name=\"color\"><option value=\"region\">by region</option>";
  if (data.has_fibers) html += "<option value=\"helix\">by helix angle</option>";
  html += "</select></label>\n";
  if (data.has_fibers) html += "<label class=\"check\"><input type=\"checkbox\" name=\"fibers\">fibres</label>\n";
  html +=
      "<div class=\"ramp\" hidden><span>-75\u00B0</span><span>0\u00B0</span><span>+75\u00B0</span></div>\n"
      "<label>Cut<select name=\"cut\"><option value=\"none\">none</option><option value=\"chambers\">four chambers"
      "</option><option value=\"coronal\">coronal</option><option value=\"sagittal\">sagittal</option>"
      "<option value=\"axial\">axial</option><option value=\"screen\">facing you</option></select>"
      "<input type=\"range\" name=\"share\" min=\"0\" max=\"1000\" value=\"500\" aria-label=\"depth of the "
      "cut\"></label>\n"
      "<div class=\"views\"><button type=\"button\" data-view=\"front\">front</button><button type=\"button\" "
      "data-view=\"back\">back</button><button type=\"button\" data-view=\"left\">left</button><button type=\"button\" "
      "data-view=\"below\">below</button></div>\n<div class=\"parts\"></div>\n"
      "<p class=\"hint\">Drag to turn, shift-drag to move. Click, then use the wheel to zoom.</p></div></div>\n";
  html += "<script type=\"application/json\" id=\"model-index\">" + data.index_json + "</script>\n";
  html += "<script type=\"text/plain\" id=\"model-data\">" + data.data_base64 + "</script>\n";
  return html;
}

std::string slices_section(const ReportInput& input) {
  if (!input.labels) return "";
  const Extent heart = heart_extent(*input.labels);
  if (heart.empty()) return "";
  std::string html = "<h2 id=\"image\">Contours on the image</h2>\n<p class=\"lead\">";
  html +=
      input.ct
          ? "The label map's outlines on the CT, through the heart. The patient's left is on the right side of axial "
            "and coronal pictures."
          : "The label map through the heart. The CT itself is not part of a bundle, so a report that is made "
            "from the bundle alone shows the labels without it.";
  html += "</p>\n";
  std::array<std::uint8_t, 256> present{};
  for (const auto label : input.labels->voxels) present[label] = 1;
  std::vector<std::int32_t> regions;
  for (std::size_t r = 1; r < present.size(); ++r)
    if (present[r]) regions.push_back(static_cast<std::int32_t>(r));
  html += legend(regions);
  const GreyWindow window = grey_window(input);
  html += slice_row(input, {SlicePlane::axial, "axial", 2, {0.72, 0.5, 0.28}}, heart, window);
  html += slice_row(input, {SlicePlane::coronal, "coronal", 1, {0.36, 0.56}}, heart, window);
  html += slice_row(input, {SlicePlane::sagittal, "sagittal", 0, {0.4, 0.62}}, heart, window);
  return html;
}

std::string meshes_section(const ReportInput& input) {
  if (!input.meshes || input.meshes->empty()) return "";
  std::string html = "<h2 id=\"meshes\">Meshes</h2>\n";
  const TetMesh* walls = mesh_named(input, "myocardium");
  if (walls) html += heart_pictures(*walls, input.picture_width_px);
  if (const TetMesh* torso = mesh_named(input, "torso"))
    html += "<h3>Torso</h3>\n" + torso_pictures(*torso, walls, input.picture_width_px);
  std::string vessels;
  for (const char* name : {"trachea", "carotid"})
    if (const TetMesh* mesh = mesh_named(input, name)) vessels += vessel_picture(*mesh, name, input.picture_width_px);
  if (!vessels.empty()) html += "<h3>Vessels and airways</h3>\n<div class=\"row two\">\n" + vessels + "</div>\n";
  return html + "<h3>Dihedral angles</h3>\n" + mesh_charts(input);
}

std::string fibers_section(const ReportInput& input) {
  const TetMesh* walls = mesh_named(input, "myocardium");
  if (!walls || walls->node_fibers.fiber.size() != walls->nodes_mm.size()) return "";
  std::string html = "<h2 id=\"fibres\">Fibres</h2>\n<p class=\"lead\">";
  html +=
      "Lines along the muscle fibres, coloured by helix angle: red climbs to the base counter-clockwise (seen from the "
      "base), as inside the left ventricle; blue the other way, as outside; white runs around.";
  if (!input.atlas_name.empty()) html += " Source: " + escaped(input.atlas_name) + ".";
  html += "</p>\n<div class=\"row two\">\n";
  FiberPictureOptions options;
  options.width_px = input.picture_width_px, options.height_px = input.picture_width_px * 30 / 31;
  html += figure(fiber_picture(*walls, options), "Cut along the long axis of the left ventricle.", true);
  options.cut = false;
  html += figure(fiber_picture(*walls, options), "The outside, from the front.", true);
  html += "</div>\n<div class=\"row two\"><div class=\"card\"><h3>Helix angle through the wall</h3>";
  html += helix_profile_svg({profile_series(*walls, Region::lv_myocardium, "left ventricle"),
                             profile_series(*walls, Region::rv_myocardium, "right ventricle")});
  html += "</div><div class=\"card\"><h3>Helix angles of all nodes</h3>";
  std::vector<double> angles;
  for (const double a : helix_angle_per_node(*walls))
    if (std::isfinite(a)) angles.push_back(a);
  html += histogram_svg({"helix angle", angles}, -90, 90, 60, "degrees") + "</div></div>\n";
  return html;
}

}  // namespace heart::validation
