// Orthographic pictures of triangles: camera, depth buffer, shading. Shared by the mesh and the fibre pictures.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "validation/canvas.hpp"
#include "validation/pictures.hpp"

namespace heart::validation {

/// right, up and toward are orthonormal; screen x = scale * dot(right, p - center) + width / 2, and so on.
struct Camera {
  Vec3 right, up, toward;  ///< toward points at the viewer
  Vec3 center_mm;
  double pixels_per_mm = 1;
  int width = 0, height = 0;
  std::array<std::string, 4> sides;  ///< words left, right, top, bottom
};

Camera camera_for(View view, const std::vector<Vec3>& shown_mm, int width, int height);
/// Centres the camera on the points and chooses the scale so that they fill nine tenths of the picture.
void fit_camera(Camera& camera, const std::vector<Vec3>& shown_mm);

struct ScreenPoint {
  double x = 0, y = 0, depth = 0;  ///< depth in mm, larger is nearer to the viewer
};
ScreenPoint project(const Camera& camera, const Vec3& p);

struct Triangle {
  std::array<ScreenPoint, 3> corner;
  std::array<Vec3, 3> normal;  ///< unit, in LPS
  std::array<Rgb, 3> color;
  double edge_opacity = 0;  ///< 0: no edges drawn
};

struct Layer {
  Canvas canvas;
  std::vector<double> depth;  ///< per pixel; -1e300 where nothing was drawn
  std::vector<float> facing;  ///< per pixel, |cos| of the angle between normal and line of sight

  Layer(int width, int height, Rgb ground)
      : canvas(width, height, ground), depth(canvas.pixels.size(), -1e300), facing(canvas.pixels.size(), 0.f) {}
};

void rasterize(Layer& layer, const Camera& camera, const Triangle& triangle);

/// Darkens creases and outlines, from the depth buffer alone.
void shade_depth(Layer& layer, const Camera& camera);

/// Orientation letters and a scale bar on a finished picture.
void annotate(Canvas& canvas, const Camera& camera, double pixels_per_mm, Rgb ink);

}  // namespace heart::validation
