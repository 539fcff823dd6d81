// Fibres as thin tubes on the walls one sees, coloured by helix angle.
#include <algorithm>
#include <cmath>

#include "model/error.hpp"
#include "model/labels.hpp"
#include "validation/boundary_faces.hpp"
#include "validation/heart_frame.hpp"
#include "validation/palette.hpp"
#include "validation/pictures.hpp"
#include "validation/raster.hpp"
#include "validation/streamlines.hpp"

namespace heart::validation {
namespace {

constexpr int supersampling = 2;
constexpr double seed_depth_mm = 1.6;   // seeds lie at most this far below the surface one sees
constexpr double shown_depth_mm = 1.1;  // and lines are drawn this far below it

struct Scene {
  std::vector<std::uint8_t> shown;  ///< per cell
  Camera camera;
};

bool is_ventricle(std::int32_t region) {
  return region == tag(Region::lv_myocardium) || region == tag(Region::rv_myocardium) ||
         region == tag(Region::papillary);
}

Scene make_scene(const TetMesh& mesh, const FiberPictureOptions& options) {
  Scene scene;
  const HeartFrame frame = heart_frame(mesh);
  const Vec3 toward = normalized(cross(-frame.to_right, frame.axis));
  scene.shown.assign(mesh.cells.size(), 0);
  std::vector<Vec3> extent;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    if (!is_ventricle(mesh.region[c])) continue;
    Vec3 center;
    for (const auto n : mesh.cells[c]) {
      extent.push_back(mesh.nodes_mm[static_cast<std::size_t>(n)]);
      center += 0.25 * extent.back();
    }
    scene.shown[c] = !options.cut || dot(center - frame.center_mm, toward) <= 0;
  }
  const int width = options.width_px * supersampling, height = options.height_px * supersampling;
  scene.camera = camera_for(options.view, extent, width, height);
  if (options.cut) {
    scene.camera.right = -frame.to_right, scene.camera.up = frame.axis, scene.camera.toward = toward;
    scene.camera.sides = {"RV", "LV", "base", "apex"};
    fit_camera(scene.camera, extent);
  }
  return scene;
}

/// The walls in pale colours, as ground for the lines.
void draw_walls(Layer& layer, const Scene& scene, const TetMesh& mesh, const std::vector<MeshFace>& faces,
                const std::vector<double>& helix_deg) {
  const BoundaryFaces boundary = boundary_faces(mesh, faces, scene.shown);
  std::vector<Vec3> normals(mesh.nodes_mm.size());
  const auto area = [&](const Face& f) {
    const Vec3& a = mesh.nodes_mm[static_cast<std::size_t>(f[0])];
    return cross(mesh.nodes_mm[static_cast<std::size_t>(f[1])] - a, mesh.nodes_mm[static_cast<std::size_t>(f[2])] - a);
  };
  for (const Face& face : boundary.faces)
    for (const auto n : face) normals[static_cast<std::size_t>(n)] += area(face);
  for (std::size_t f = 0; f < boundary.faces.size(); ++f) {
    const Face& face = boundary.faces[f];
    const bool opened =
        boundary.other[f] >= 0 && is_ventricle(mesh.region[static_cast<std::size_t>(boundary.other[f])]);
    Triangle t;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto n = static_cast<std::size_t>(face[k]);
      t.corner[k] = project(scene.camera, mesh.nodes_mm[n]);
      // The cut is jagged, cell by cell; lit as the plane it stands for.
      t.normal[k] = opened ? scene.camera.toward : normalized(normals[n]);
      t.color[k] = mix(Rgb{238, 232, 226}, helix_color(helix_deg[n]), 0.62);
    }
    rasterize(layer, scene.camera, t);
  }
}

std::vector<std::int32_t> visible_seeds(const Layer& walls, const Scene& scene, const TetMesh& mesh,
                                        double spacing_mm) {
  std::vector<std::uint8_t> allowed(mesh.nodes_mm.size(), 0);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (scene.shown[c])
      for (const auto n : mesh.cells[c]) allowed[static_cast<std::size_t>(n)] = 1;
  for (std::size_t n = 0; n < allowed.size(); ++n) {
    if (!allowed[n]) continue;
    const ScreenPoint p = project(scene.camera, mesh.nodes_mm[n]);
    const int x = static_cast<int>(p.x), y = static_cast<int>(p.y);
    const bool on_picture = x >= 0 && y >= 0 && x < walls.canvas.width && y < walls.canvas.height;
    allowed[n] = on_picture && p.depth > walls.depth[walls.canvas.at(x, y)] - seed_depth_mm;
  }
  return thinned_nodes(mesh, allowed, spacing_mm);
}

/// A piece of tube: bright along its middle, dark at its rim so that crossing lines stay apart.
void draw_tube(Layer& lines, const Layer& walls, const ScreenPoint& a, const ScreenPoint& b, double radius, Rgb color) {
  const double rim = radius + 1;
  const int x0 = std::max(0, static_cast<int>(std::min(a.x, b.x) - rim));
  const int y0 = std::max(0, static_cast<int>(std::min(a.y, b.y) - rim));
  const int x1 = std::min(lines.canvas.width - 1, static_cast<int>(std::max(a.x, b.x) + rim) + 1);
  const int y1 = std::min(lines.canvas.height - 1, static_cast<int>(std::max(a.y, b.y) + rim) + 1);
  const double dx = b.x - a.x, dy = b.y - a.y, length2 = dx * dx + dy * dy;
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const double px = x + 0.5 - a.x, py = y + 0.5 - a.y;
      const double t = length2 > 0 ? (px * dx + py * dy) / length2 : 0;
      const double s = std::clamp(t, 0.0, 1.0), ex = px - s * dx, ey = py - s * dy;
      if (std::sqrt(ex * ex + ey * ey) > rim) continue;
      const bool end_on = length2 < 1;
      const double off = end_on ? std::sqrt(px * px + py * py) : std::abs(px * dy - py * dx) / std::sqrt(length2);
      if (off > rim) continue;
      const auto at = lines.canvas.at(x, y);
      // Caps and rim lie lower than the tube, so that a line never darkens itself at its own joints.
      const double lower_mm = (off > radius ? 0.5 : 0.0) + (t != s && !end_on ? 0.25 : 0.0);
      const double depth = a.depth + s * (b.depth - a.depth) - lower_mm;
      if (depth < walls.depth[at] - shown_depth_mm || depth <= lines.depth[at]) continue;
      lines.depth[at] = depth;
      const double round = 1 - 0.4 * (off / radius) * (off / radius);
      lines.canvas.pixels[at] = off > radius ? scaled(color, 0.38) : scaled(color, round);
    }
}

void draw_helix_legend(Canvas& canvas) {
  const double left = 14, top = 16, width = 132, height = 9;
  const Rgb ink{90, 90, 90};
  for (int x = 0; x < static_cast<int>(width); ++x)
    fill_box(canvas, left + x, top, 1, height, helix_color(-75 + 150.0 * x / (width - 1)));
  draw_text(canvas, "helix angle", left, top - 4, 7.5, ink);
  draw_text(canvas, "-75\xB0", left, top + height + 12, 7.5, ink);
  draw_text(canvas, "0\xB0", left + width / 2 - 3, top + height + 12, 7.5, ink);
  draw_text(canvas, "+75\xB0", left + width - text_width("+75\xB0", 7.5), top + height + 12, 7.5, ink);
}

}  // namespace

PngBytes fiber_picture(const TetMesh& mesh, const FiberPictureOptions& options) {
  const auto faces = mesh_faces(mesh);
  return fiber_picture(mesh, faces, helix_angle_per_node(mesh, faces), options);
}

PngBytes fiber_picture(const TetMesh& mesh, const std::vector<MeshFace>& faces, const std::vector<double>& helix_deg,
                       const FiberPictureOptions& options) {
  if (mesh.node_fibers.fiber.empty() || mesh.node_fibers.fiber.size() != mesh.nodes_mm.size())
    throw UserError("the mesh has no fibres on its nodes", "fibre picture", "build it with an atlas");
  const Scene scene = make_scene(mesh, options);
  Layer walls(scene.camera.width, scene.camera.height, Rgb{255, 255, 255});
  draw_walls(walls, scene, mesh, faces, helix_deg);
  const auto seeds = visible_seeds(walls, scene, mesh, options.spacing_mm);
  Layer lines = walls;
  std::fill(lines.depth.begin(), lines.depth.end(), -1e300);
  const double radius = std::max(1.6, 0.34 * scene.camera.pixels_per_mm * std::min(options.spacing_mm, 2.0));
  for (const auto& line : trace_fibers(mesh, seeds, helix_deg, {0.7, options.length_mm}))
    for (std::size_t i = 0; i + 1 < line.points_mm.size(); ++i)
      draw_tube(lines, walls, project(scene.camera, line.points_mm[i]), project(scene.camera, line.points_mm[i + 1]),
                radius, helix_color(line.helix_deg[i]));
  for (std::size_t p = 0; p < lines.depth.size(); ++p) lines.depth[p] = std::max(lines.depth[p], walls.depth[p]);
  shade_depth(lines, scene.camera);
  Canvas picture = downsampled(lines.canvas, supersampling);
  annotate(picture, scene.camera, scene.camera.pixels_per_mm / supersampling, Rgb{90, 90, 90});
  draw_helix_legend(picture);
  return encode_png(picture);
}

}  // namespace heart::validation
