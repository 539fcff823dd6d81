// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Pictures of a model, drawn in software: the same bytes on every machine, without a window system.
/// All pictures are RGB PNG files in memory. Anatomy is shown in the radiological convention: the patient's left is on
/// the right side of axial and coronal pictures.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "model/tet_mesh.hpp"
#include "model/volume.hpp"
#include "validation/mesh_topology.hpp"

namespace heartgen::report {

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

/// Helix angle in degrees (-90 .. 90) per node, for colouring: against the outward normal of the nearest wall surface
/// and the long axis of the left ventricle. NaN where there is no fibre or no wall.
std::vector<double> helix_angle_per_node(const TetMesh& myocardium);
std::vector<double> helix_angle_per_node(const TetMesh& myocardium, const std::vector<validation::MeshFace>& faces);

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

}  // namespace heartgen::report
