// Pictures of a model, drawn in software: the same bytes on every machine, without a window system.
// All pictures are RGB PNG files in memory. Anatomy is shown in the radiological convention: the patient's left is on
// the right side of axial, coronal and frontal pictures.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "model/tet_mesh.hpp"
#include "model/volume.hpp"
#include "validation/mesh_topology.hpp"

namespace heart::validation {

using PngBytes = std::vector<std::uint8_t>;

enum class SlicePlane { axial, coronal, sagittal };

/// Grey values are mapped linearly from [center - width/2, center + width/2] to black .. white.
struct GreyWindow {
  double center_hu = 150;
  double width_hu = 700;
};

struct SliceOptions {
  GreyWindow window;
  int width_px = 640;             ///< width of the picture; the height follows from the field shown
  bool legend = true;             ///< names and colours of the regions that are cut
  std::optional<Vec3> center_mm;  ///< LPS centre of the field shown; the whole slice when not given
  double field_mm = 0;            ///< width and height of the field around center_mm
};

/// A slice of the CT with the outlines of the label map's regions, orientation letters and a scale bar. `index` counts
/// voxels along the patient axis nearest to the plane's normal (axial: z, coronal: y, sagittal: x). Either volume may
/// be null (black ground / no outlines), not both; their grids may differ.
/// Throws UserError when both are null and when `index` is outside the grid.
PngBytes slice_picture(const CtVolume* ct, const LabelVolume* labels, SlicePlane plane, std::int64_t index,
                       const SliceOptions& options = {});

enum class View { front, back, left, below };
enum class MeshColor { region, surface, helix_angle, rule_difference, plain };

/// Everything on the side of `point_mm` to which `normal` points is taken away.
struct CutPlane {
  Vec3 point_mm;
  Vec3 normal{0, -1, 0};
};

struct MeshPictureOptions {
  int width_px = 720;
  int height_px = 640;
  MeshColor color = MeshColor::region;
  bool edges = true;                  ///< mesh edges as thin lines
  std::optional<CutPlane> cut;        ///< whole cells are taken away, so that the inside shows
  std::vector<std::int32_t> regions;  ///< draw these regions only; empty: all
  std::vector<std::int32_t> ghost;    ///< regions drawn half transparent on top of the others
  bool dark = false;                  ///< dark ground instead of a white one
};

/// Orthographic shaded picture of the mesh's boundary faces.
PngBytes mesh_picture(const TetMesh& mesh, View view, const MeshPictureOptions& options = {});

/// The same for several pictures of one mesh: `faces` from mesh_faces.
PngBytes mesh_picture(const TetMesh& mesh, const std::vector<MeshFace>& faces, View view,
                      const MeshPictureOptions& options);

struct FiberPictureOptions {
  int width_px = 900;
  int height_px = 720;
  View view = View::front;  ///< of an uncut heart
  /// Cut along the long axis of the left ventricle and seen across the septum (base up, right ventricle on the left),
  /// so that the turn of the fibres through the wall shows.
  bool cut = true;
  double spacing_mm = 1.6;  ///< distance between neighbouring streamlines
  double length_mm = 18;    ///< length of a streamline
};

/// Streamlines of the fibres (Runge-Kutta of order 4 on axes, so the sign of the data does not matter) on the visible
/// walls of the ventricles, coloured by helix angle: blue -75 degrees, white 0, red +75. Needs fibres on nodes or
/// cells; throws UserError without them.
PngBytes fiber_picture(const TetMesh& myocardium, const FiberPictureOptions& options = {});

/// The same for several pictures of one mesh: `faces` from mesh_faces, `helix_deg` from helix_angle_per_node.
PngBytes fiber_picture(const TetMesh& myocardium, const std::vector<MeshFace>& faces,
                       const std::vector<double>& helix_deg, const FiberPictureOptions& options);

/// Helix angle in degrees (-90 .. 90) per node, for colouring: against the outward normal of the nearest wall surface
/// and the long axis of the left ventricle. NaN where there is no fibre or no wall.
std::vector<double> helix_angle_per_node(const TetMesh& myocardium);
std::vector<double> helix_angle_per_node(const TetMesh& myocardium, const std::vector<MeshFace>& faces);

/// Inline SVG charts; their text and lines take the colour of the page they are put in.
struct HistogramSeries {
  std::string name;
  std::vector<double> values;
};
std::string histogram_svg(const HistogramSeries& series, double from, double to, int bins, const std::string& unit);

/// Median and 10-90 % band of an angle against wall depth (0 endocardium, 1 epicardium), over the published range.
struct ProfileSeries {
  std::string name;
  std::vector<double> depth;
  std::vector<double> median_deg;
  std::vector<double> p10_deg;
  std::vector<double> p90_deg;
};
std::string helix_profile_svg(const std::vector<ProfileSeries>& series);

}  // namespace heart::validation
