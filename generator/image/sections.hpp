// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Plane sections through blood.
#pragma once
#include <optional>
#include <vector>

#include "model/volume.hpp"

namespace heartgen::image {

/// A unit vector across `normal`, and the third of the right-handed frame.
struct PlaneFrame {
  Vec3 u, v;
};
PlaneFrame frame_across(const Vec3& normal);

struct Section {
  double area_mm2 = 0;
  Vec3 centre_mm;
  double diameter_mm() const;  ///< of the disc of the same area
};

/// What one point of a section stands for.
constexpr double section_pixel_mm2 = 2.25;

/// The pixels' centres of the piece of the section through `point` across `normal` that lies nearest to the point;
/// none where no blood is within `search_mm` of it.
std::vector<Vec3> section_points(const Volume<float>& blood, const Vec3& point, const Vec3& normal, double search_mm);

/// The piece of the section through `point` across `normal` that lies nearest to the point; nothing where no blood is
/// within `search_mm` of it. `blood` is 0 to 1; the section is seen to 36 mm from the point.
std::optional<Section> section_at(const Volume<float>& blood, const Vec3& point, const Vec3& normal, double search_mm);

/// The section of least area among those tilted by up to 35 degrees and shifted by up to `reach_mm` along the normal
/// from a plane through a valve, large changes at a penalty; nothing where none cuts blood.
struct TightestPlane {
  Section section;
  Vec3 normal;
};
std::optional<TightestPlane> tightest_plane(const Volume<float>& blood, const Vec3& centre, const Vec3& normal,
                                            double reach_mm);

}  // namespace heartgen::image
