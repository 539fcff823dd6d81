// Shaded pictures of meshes: the boundary of the shown cells, drawn at twice the size and averaged down.
#include <algorithm>
#include <cmath>
#include <limits>

#include "model/labels.hpp"
#include "validation/boundary_faces.hpp"
#include "validation/palette.hpp"
#include "validation/pictures.hpp"
#include "validation/raster.hpp"

namespace heart::validation {
namespace {

constexpr int supersampling = 2;

bool contains(const std::vector<std::int32_t>& list, std::int32_t value) {
  return std::find(list.begin(), list.end(), value) != list.end();
}

Vec3 centroid(const TetMesh& mesh, const Cell& cell) {
  Vec3 sum;
  for (const auto n : cell) sum += mesh.nodes_mm[static_cast<std::size_t>(n)];
  return 0.25 * sum;
}

/// Cells to draw. `ghost` chooses the half transparent regions, which no plane cuts.
std::vector<std::uint8_t> choose_cells(const TetMesh& mesh, const MeshPictureOptions& options, bool ghost) {
  std::vector<std::uint8_t> chosen(mesh.cells.size(), 0);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const bool is_ghost = contains(options.ghost, mesh.region[c]);
    const bool shown = options.regions.empty() || contains(options.regions, mesh.region[c]);
    if (is_ghost != ghost || (!ghost && !shown)) continue;
    const bool cut_away =
        !ghost && options.cut && dot(centroid(mesh, mesh.cells[c]) - options.cut->point_mm, options.cut->normal) > 0;
    chosen[c] = !cut_away;
  }
  return chosen;
}

/// Surface tags found by the faces' sorted nodes.
struct SurfaceLookup {
  std::vector<std::pair<Face, std::int32_t>> table;

  explicit SurfaceLookup(const TetMesh& mesh) {
    table.reserve(mesh.faces.size());
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
      Face key = mesh.faces[f];
      std::sort(key.begin(), key.end());
      table.emplace_back(key, mesh.surface[f]);
    }
    std::sort(table.begin(), table.end());
  }
  std::int32_t operator()(Face face) const {
    std::sort(face.begin(), face.end());
    const auto at = std::lower_bound(table.begin(), table.end(), std::pair{face, INT32_MIN});
    return at != table.end() && at->first == face ? at->second : 0;
  }
};

Vec3 face_normal(const TetMesh& mesh, const Face& f) {
  const Vec3& a = mesh.nodes_mm[static_cast<std::size_t>(f[0])];
  return cross(mesh.nodes_mm[static_cast<std::size_t>(f[1])] - a, mesh.nodes_mm[static_cast<std::size_t>(f[2])] - a);
}

/// Faces opened by the cut belong to a cell on the other side of the same region (or of another shown one).
bool opened(const TetMesh& mesh, const BoundaryFaces& boundary, std::size_t f) {
  return boundary.other[f] >= 0 && mesh.region[static_cast<std::size_t>(boundary.other[f])] ==
                                       mesh.region[static_cast<std::size_t>(boundary.cell[f])];
}

/// Area-weighted normals at the nodes, over the faces that the cut did not open.
std::vector<Vec3> smooth_normals(const TetMesh& mesh, const BoundaryFaces& boundary) {
  std::vector<Vec3> normals(mesh.nodes_mm.size());
  for (std::size_t f = 0; f < boundary.faces.size(); ++f)
    if (!opened(mesh, boundary, f))
      for (const auto n : boundary.faces[f])
        normals[static_cast<std::size_t>(n)] += face_normal(mesh, boundary.faces[f]);
  for (Vec3& n : normals) n = normalized(n);
  return normals;
}

struct Painter {
  const TetMesh& mesh;
  const MeshPictureOptions& options;
  SurfaceLookup surface_of;
  std::vector<double> helix;

  Painter(const TetMesh& mesh_, const std::vector<MeshFace>& faces, const MeshPictureOptions& options_)
      : mesh(mesh_), options(options_), surface_of(options_.color == MeshColor::surface ? mesh_ : TetMesh{}) {
    if (options.color == MeshColor::helix_angle) helix = helix_angle_per_node(mesh, faces);
  }
  std::array<Rgb, 3> operator()(const Face& face, std::int32_t cell) const {
    const auto all = [](Rgb c) { return std::array<Rgb, 3>{c, c, c}; };
    const std::int32_t region = mesh.region[static_cast<std::size_t>(cell)];
    if (options.color == MeshColor::plain) return all(Rgb{214, 206, 200});
    if (options.color == MeshColor::region) return all(region_color(region));
    if (options.color == MeshColor::rule_difference) {
      const float angle = mesh.rule_difference_deg[static_cast<std::size_t>(cell)];
      return all(difference_color(angle < 0 ? std::numeric_limits<double>::quiet_NaN() : double{angle}));
    }
    if (options.color == MeshColor::surface) {
      const std::int32_t surface = surface_of(face);
      return all(surface ? surface_color(surface) : region_color(region));
    }
    const auto at = [&](std::int32_t n) { return helix_color(helix[static_cast<std::size_t>(n)]); };
    return {at(face[0]), at(face[1]), at(face[2])};
  }
};

double edge_opacity(const Triangle& t, bool edges) {
  if (!edges) return 0;
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto& a = t.corner[k];
    const auto& b = t.corner[(k + 1) % 3];
    longest = std::max(longest, (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y));
  }
  return 0.42 * std::clamp((std::sqrt(longest) - 7) / 14, 0.0, 1.0);
}

void draw_boundary(Layer& layer, const Camera& camera, const Painter& painter, const BoundaryFaces& boundary) {
  const TetMesh& mesh = painter.mesh;
  const auto normals = smooth_normals(mesh, boundary);
  for (std::size_t f = 0; f < boundary.faces.size(); ++f) {
    Triangle t;
    const Face& face = boundary.faces[f];
    const Vec3 flat = normalized(face_normal(mesh, face));
    // The cut is jagged, cell by cell: lit mostly as the plane it stands for, a little as the facets it is made of.
    const bool cut_face = painter.options.cut && opened(mesh, boundary, f);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto n = static_cast<std::size_t>(face[k]);
      t.corner[k] = project(camera, mesh.nodes_mm[n]);
      t.normal[k] = dot(normals[n], flat) < 0.3 ? flat : normals[n];
      if (cut_face) t.normal[k] = normalized(flat + 2 * painter.options.cut->normal);
    }
    t.color = painter(face, boundary.cell[f]);
    t.edge_opacity = edge_opacity(t, painter.options.edges);
    rasterize(layer, camera, t);
  }
}

/// Lays the half transparent regions over the picture: glassy, denser where they are seen edge-on.
void draw_ghost(Layer& layer, const Camera& camera, const TetMesh& mesh, const std::vector<MeshFace>& faces,
                const MeshPictureOptions& options) {
  MeshPictureOptions glass = options;
  glass.color = MeshColor::region;
  glass.edges = false;
  Layer over(layer.canvas.width, layer.canvas.height, Rgb{});
  draw_boundary(over, camera, Painter(mesh, faces, glass),
                boundary_faces(mesh, faces, choose_cells(mesh, options, true)));
  for (std::size_t p = 0; p < layer.depth.size(); ++p) {
    if (over.depth[p] < -1e299 || over.depth[p] < layer.depth[p]) continue;
    const double edge_on = 1 - double{over.facing[p]};
    layer.canvas.pixels[p] = mix(layer.canvas.pixels[p], over.canvas.pixels[p], 0.14 + 0.6 * edge_on * edge_on);
  }
}

std::vector<Vec3> shown_nodes(const TetMesh& mesh, const std::vector<std::uint8_t>& chosen) {
  std::vector<Vec3> nodes;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (chosen[c])
      for (const auto n : mesh.cells[c]) nodes.push_back(mesh.nodes_mm[static_cast<std::size_t>(n)]);
  return nodes;
}

}  // namespace

PngBytes mesh_picture(const TetMesh& mesh, View view, const MeshPictureOptions& options) {
  return mesh_picture(mesh, mesh_faces(mesh), view, options);
}

PngBytes mesh_picture(const TetMesh& mesh, const std::vector<MeshFace>& faces, View view,
                      const MeshPictureOptions& options) {
  MeshPictureOptions uncut = options;
  uncut.cut.reset();
  auto extent = shown_nodes(mesh, choose_cells(mesh, uncut, false));
  if (!options.ghost.empty()) {
    const auto ghost_extent = shown_nodes(mesh, choose_cells(mesh, options, true));
    extent.insert(extent.end(), ghost_extent.begin(), ghost_extent.end());
  }
  const int width = options.width_px * supersampling, height = options.height_px * supersampling;
  const Camera camera = camera_for(view, extent, width, height);
  const Rgb ground = options.dark ? Rgb{22, 24, 28} : Rgb{255, 255, 255};
  Layer layer(width, height, ground);
  draw_boundary(layer, camera, Painter(mesh, faces, options),
                boundary_faces(mesh, faces, choose_cells(mesh, options, false)));
  shade_depth(layer, camera);
  if (!options.ghost.empty()) draw_ghost(layer, camera, mesh, faces, options);
  Canvas picture = downsampled(layer.canvas, supersampling);
  annotate(picture, camera, camera.pixels_per_mm / supersampling, options.dark ? Rgb{190, 190, 190} : Rgb{90, 90, 90});
  return encode_png(picture);
}

}  // namespace heart::validation
