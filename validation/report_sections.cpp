#include "validation/report_sections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "generator/parallel/tasks.hpp"
#include "model/labels.hpp"
#include "model/sort_unique.hpp"
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

void add(Pieces& pieces, std::string text) {
  pieces.emplace_back([text = std::move(text)] { return text; });
}

void add(Pieces& pieces, Pieces more) {
  for (auto& piece : more) pieces.push_back(std::move(piece));
}

/// A picture that is drawn when the piece is made.
template <class Draw>
void add_figure(Pieces& pieces, const std::string& caption, bool on_white, Draw draw) {
  pieces.emplace_back([=] { return figure(draw(), caption, on_white); });
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

/// LPS box of the voxels that `counts` is true for.
template <class Counts>
Extent extent_of(const LabelVolume& labels, Counts counts) {
  Extent extent;
  const auto [nx, ny, nz] = labels.grid.size;
  for (std::int64_t k = 0; k < nz; ++k)
    for (std::int64_t j = 0; j < ny; ++j) {
      const auto* row = &labels(0, j, k);
      const auto first = std::find_if(row, row + nx, counts);
      if (first == row + nx) continue;
      const auto last = std::find_if(std::reverse_iterator(row + nx), std::reverse_iterator(row), counts).base() - 1;
      for (const auto* voxel : {first, last}) {
        const Vec3 p = lps_from_index(
            labels.grid, {static_cast<double>(voxel - row), static_cast<double>(j), static_cast<double>(k)});
        for (int a = 0; a < 3; ++a)
          extent.low[a] = std::min(extent.low[a], p[a]), extent.high[a] = std::max(extent.high[a], p[a]);
      }
    }
  return extent;
}

/// The labelled heart, or everything labelled where there is no heart.
Extent heart_extent(const LabelVolume& labels) {
  const Extent heart = extent_of(labels, is_chamber_or_wall);
  return heart.empty() ? extent_of(labels, [](std::uint8_t label) { return label != 0; }) : heart;
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

struct Plane {
  SlicePlane plane;
  const char* name;
  int patient_axis;
  std::vector<double> shares;  ///< of the heart's extent along the axis, in the order of the pictures
};

const std::vector<Plane>& planes() {
  static const std::vector<Plane> all = {{SlicePlane::axial, "axial", 2, {0.85, 0.71, 0.57, 0.43, 0.29, 0.15}},
                                         {SlicePlane::coronal, "coronal", 1, {0.25, 0.45, 0.65}},
                                         {SlicePlane::sagittal, "sagittal", 0, {0.3, 0.5, 0.7}}};
  return all;
}

/// One slice: of the heart's surroundings, or with `whole` of the whole image.
void add_slice(Pieces& pieces, const ReportInput& input, const Plane& plane, const Extent& heart,
               const GreyWindow& window, double share, bool whole) {
  const Grid& grid = input.ct ? input.ct->grid : input.labels->grid;
  const int axis = plane.patient_axis;
  const Vec3 size = heart.high - heart.low;
  Vec3 at = 0.5 * (heart.low + heart.high);
  at[axis] = heart.low[axis] + share * size[axis];
  SliceOptions options;
  options.legend = false;
  options.window = window;
  options.width_px = input.picture_width_px * 2 / 3;
  if (!whole) {
    options.center_mm = at;
    options.field_mm = 1.22 * std::max({size.x, size.y, size.z});
  }
  const auto index = slice_through(grid, at, axis);
  add_figure(pieces, fmt::format("{}, {} = {:.0f} mm{}", plane.name, "xyz"[axis], at[axis], whole ? ", whole" : ""),
             false, [&input, kind = plane.plane, index, options] {
               return slice_picture(input.ct, input.labels, kind, index, options);
             });
}

std::vector<std::int32_t> regions_of(const std::vector<std::int32_t>& tags) {
  std::vector<std::int32_t> regions = tags;
  sort_unique(regions);
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

Pieces heart_pictures(const TetMesh& walls, const std::vector<MeshFace>& faces, int width_px) {
  Pieces pieces;
  const MeshPictureOptions whole = mesh_options(width_px);
  MeshPictureOptions front = whole, across = whole;
  const Vec3 center = heart_frame(walls).center_mm;
  front.cut = CutPlane{center, {0, -1, 0}};
  across.cut = CutPlane{center, {0, 0, -1}};
  const auto add_view = [&](View view, const MeshPictureOptions& options, const char* caption) {
    add_figure(pieces, caption, true,
               [&walls, &faces, view, options] { return mesh_picture(walls, faces, view, options); });
  };
  add(pieces, "<div class=\"row two\">\n");
  add_view(View::front, whole, "From the front. The patient's left is on the right.");
  add_view(View::back, whole, "From behind.");
  add_view(View::front, front, "Cut open in front, cell by cell, through the left ventricle.");
  add_view(View::below, across, "Cut across, seen from below.");
  add(pieces, "</div>\n" + legend(regions_of(walls.region)));
  return pieces;
}

/// Where the fibres are those of a rule, and where they are not.
Pieces rule_pictures(const TetMesh& walls, const std::vector<MeshFace>& faces, int width_px) {
  Pieces pieces;
  MeshPictureOptions options = mesh_options(width_px);
  options.color = MeshColor::rule_difference;
  options.edges = false;
  options.regions = {tag(Region::lv_myocardium), tag(Region::rv_myocardium)};
  MeshPictureOptions across = options;
  across.cut = CutPlane{heart_frame(walls).center_mm, {0, 0, -1}};
  add(pieces, "<h3>Against rule-based fibres</h3>\n<div class=\"row two\">\n");
  const char* front = "Angle to rule-based fibres ([fibers.rule]): white 0, red 60 degrees and more.";
  add_figure(pieces, front, true,
             [&walls, &faces, options] { return mesh_picture(walls, faces, View::front, options); });
  add_figure(pieces, "The same, cut across and seen from below.", true,
             [&walls, &faces, across] { return mesh_picture(walls, faces, View::below, across); });
  add(pieces, "</div>\n");
  return pieces;
}

Pieces torso_pictures(const TetMesh& torso, const std::vector<MeshFace>& faces, const TetMesh* walls, int width_px) {
  Vec3 center;
  for (const Vec3& p : torso.nodes_mm) center += p / static_cast<double>(torso.nodes_mm.size());
  if (walls) center = heart_frame(*walls).center_mm;
  Pieces pieces;
  const auto add_view = [&](View view, const Vec3& normal, const char* caption) {
    MeshPictureOptions options = mesh_options(width_px);
    options.cut = CutPlane{center, normal};
    add_figure(pieces, caption, true,
               [&torso, &faces, view, options] { return mesh_picture(torso, faces, view, options); });
  };
  add(pieces, "<h3>Torso</h3>\n<div class=\"row two\">\n");
  add_view(View::front, {0, -1, 0}, "Torso, cut in front through the heart.");
  add_view(View::below, {0, 0, -1}, "Torso, cut across through the heart, seen from below.");
  add(pieces, "</div>\n" + legend(regions_of(torso.region)));
  return pieces;
}

void add_vessel(Pieces& pieces, const TetMesh& mesh, const std::vector<MeshFace>& faces, const std::string& name,
                int width_px) {
  MeshPictureOptions options = mesh_options(width_px);
  options.color = MeshColor::surface;
  add_figure(pieces, name + ", coloured by labelled surface.", true,
             [&mesh, &faces, options] { return mesh_picture(mesh, faces, View::front, options); });
}

ProfileSeries profile_series(const HelixProfile& p, const std::string& name) {
  return {name, p.depth, p.median_deg, p.p10_deg, p.p90_deg};
}

}  // namespace

namespace {

std::string viewer_html(const ReportInput& input, const Shared& shared) {
  const ViewerData data = viewer_data(*input.meshes, shared.all_faces(), shared.helix_deg);
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

std::string slices_lead(const ReportInput& input) {
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
  return html + legend(regions);
}

std::string helix_charts(const ReportInput& input, const TetMesh& walls, const std::vector<double>& helix_deg) {
  std::string html = "<div class=\"row two\"><div class=\"card\"><h3>Helix angle through the wall</h3>";
  std::vector<ProfileSeries> series = {profile_series(helix_profile(walls, Region::lv_myocardium), "left ventricle"),
                                       profile_series(helix_profile(walls, Region::rv_myocardium), "right ventricle")};
  if (!input.atlas_lv.depth.empty()) series.push_back(profile_series(input.atlas_lv, "atlas, left"));
  if (!input.atlas_rv.depth.empty()) series.push_back(profile_series(input.atlas_rv, "atlas, right"));
  html += helix_profile_svg(series);
  html += "</div><div class=\"card\"><h3>Helix angles of all nodes</h3>";
  std::vector<double> angles;
  for (const double a : helix_deg)
    if (std::isfinite(a)) angles.push_back(a);
  return html + histogram_svg({"helix angle", angles}, -90, 90, 60, "degrees") + "</div></div>\n";
}

}  // namespace

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
  if (!shared.given_faces) shared.own_faces = faces_of_meshes(*input.meshes);
  if (const TetMesh* walls = mesh_named(input, "myocardium"))
    shared.helix_deg = helix_angle_per_node(*walls, shared.faces_of("myocardium"));
  return shared;
}

Pieces viewer_section(const ReportInput& input, const Shared& shared) {
  if (!input.meshes) return {};
  return {[&input, &shared] { return viewer_html(input, shared); }};
}

Pieces slices_section(const ReportInput& input, const Shared&) {
  if (!input.labels) return {};
  const Extent heart = heart_extent(*input.labels);
  if (heart.empty()) return {};
  const GreyWindow window = grey_window(input);
  Pieces pieces;
  add(pieces, slices_lead(input) + "<div class=\"row three\">\n");
  for (const Plane& plane : planes()) add_slice(pieces, input, plane, heart, window, 0.5, true);
  for (const Plane& plane : planes()) {
    add(pieces, "</div>\n<div class=\"row three\">\n");
    for (const double share : plane.shares) add_slice(pieces, input, plane, heart, window, share, false);
  }
  add(pieces, "</div>\n");
  return pieces;
}

Pieces meshes_section(const ReportInput& input, const Shared& shared) {
  if (!input.meshes || input.meshes->empty()) return {};
  Pieces pieces;
  add(pieces, "<h2 id=\"meshes\">Meshes</h2>\n");
  const TetMesh* walls = mesh_named(input, "myocardium");
  if (walls) add(pieces, heart_pictures(*walls, shared.faces_of("myocardium"), input.picture_width_px));
  if (const TetMesh* torso = mesh_named(input, "torso"))
    add(pieces, torso_pictures(*torso, shared.faces_of("torso"), walls, input.picture_width_px));
  Pieces vessels;
  for (const char* name : {"trachea", "carotid"})
    if (const TetMesh* mesh = mesh_named(input, name))
      add_vessel(vessels, *mesh, shared.faces_of(name), name, input.picture_width_px);
  if (!vessels.empty()) {
    add(pieces, "<h3>Vessels and airways</h3>\n<div class=\"row two\">\n");
    add(pieces, std::move(vessels));
    add(pieces, "</div>\n");
  }
  pieces.emplace_back([&input] { return "<h3>Dihedral angles</h3>\n" + mesh_charts(input); });
  return pieces;
}

Pieces fibers_section(const ReportInput& input, const Shared& shared) {
  const TetMesh* walls = mesh_named(input, "myocardium");
  if (!walls || walls->node_fibers.fiber.size() != walls->nodes_mm.size()) return {};
  std::string lead = "<h2 id=\"fibres\">Fibres</h2>\n<p class=\"lead\">";
  lead +=
      "Lines along the muscle fibres, coloured by helix angle: red climbs to the base counter-clockwise (seen from the "
      "base), as inside the left ventricle; blue the other way, as outside; white runs around.";
  if (!input.atlas_name.empty()) lead += " Source: " + escaped(input.atlas_name) + ".";
  Pieces pieces;
  add(pieces, lead + "</p>\n<div class=\"row two\">\n");
  FiberPictureOptions options;
  options.width_px = input.picture_width_px, options.height_px = input.picture_width_px * 30 / 31;
  add_figure(pieces, "Cut along the long axis of the left ventricle.", true, [walls, &shared, options] {
    return fiber_picture(*walls, shared.faces_of("myocardium"), shared.helix_deg, options);
  });
  options.cut = false;
  add_figure(pieces, "The outside, from the front.", true, [walls, &shared, options] {
    return fiber_picture(*walls, shared.faces_of("myocardium"), shared.helix_deg, options);
  });
  add(pieces, "</div>\n");
  if (walls->rule_difference_deg.size() == walls->cells.size())
    add(pieces, rule_pictures(*walls, shared.faces_of("myocardium"), input.picture_width_px));
  pieces.emplace_back([&input, walls, &shared] { return helix_charts(input, *walls, shared.helix_deg); });
  return pieces;
}

}  // namespace heart::validation
