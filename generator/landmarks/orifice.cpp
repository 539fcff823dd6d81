// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/landmarks/orifice.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "generator/chest/working_image.hpp"
#include "generator/image/gaussian.hpp"
#include "generator/image/sections.hpp"
#include "generator/parallel/threads.hpp"
#include "model/mathematics.hpp"

namespace heartgen::landmarks {
namespace {

constexpr double off_fat_mm = 3;           // nearer to fat the grey value is a mixture
constexpr double off_left_blood_mm = 3.5;  // and so it is nearer to bright blood, where a few percent of it count
constexpr double max_information = 1;      // nats per mm³: no voxel decides alone
constexpr double thickness_mm = 3;         // of the ring of muscle around an orifice, as far as it tells
constexpr double smoothing_mm = 1;         // across the section, which is one voxel thick
constexpr double min_nats = 15;            // chance gives up to 11 on a thousand planes
constexpr double reach_mm = 15;            // of the plane, along its normal
constexpr double shift_slack_mm = 4;       // standard deviations of the first guess: where grey values tell little
constexpr double tilt_slack_deg = 10;      // it counts for more
constexpr double across_slack_mm = 8;
constexpr double typical_radius_mm = 17;  // tricuspid annulus of adults: 28 to 40 mm wide
constexpr double radius_slack_mm = 4;
constexpr double degree = 3.14159265358979323846 / 180;

/// A plane near the first guess.
struct Pose {
  double shift_mm = 0, tilt_u_deg = 0, tilt_v_deg = 0;

  double tilt_deg() const { return math::hypot(tilt_u_deg, tilt_v_deg); }
};

Vec3 normal_of(const ValvePatch& start, const Pose& pose) {
  const image::PlaneFrame frame = image::frame_across(start.normal);
  return normalized(start.normal + math::tan(pose.tilt_u_deg * degree) * frame.u +
                    math::tan(pose.tilt_v_deg * degree) * frame.v);
}

Vec3 point_of(const ValvePatch& start, const Pose& pose) { return start.centre_mm + pose.shift_mm * start.normal; }

float value_at(const Volume<float>& image, const Vec3& p) {
  return static_cast<float>(sample_linear(image, index_from_lps(image.grid, p)));
}

/// A section through the right heart, in pixels around `point`.
struct Cut {
  static constexpr double pixel_mm = 1.5;
  static constexpr int half = 26;  // 39 mm: the farthest edge of a disc
  static constexpr int side = 2 * half + 1;

  std::vector<double> row_sum;  ///< of `excess`, up to and without each pixel of the row; side + 1 a row

  /// Sum over the pixels of row b from column first to last.
  double over(int b, int first, int last) const {
    const auto row = static_cast<std::size_t>(b + half) * static_cast<std::size_t>(side + 1);
    return row_sum[row + static_cast<std::size_t>(last + half + 1)] -
           row_sum[row + static_cast<std::size_t>(first + half)];
  }
};

Cut cut_at(const FaintTissue& tissue, const Vec3& point, const Vec3& normal) {
  const image::PlaneFrame frame = image::frame_across(normal);
  Cut cut;
  cut.row_sum.reserve(static_cast<std::size_t>(Cut::side) * static_cast<std::size_t>(Cut::side + 1));
  for (int b = -Cut::half; b <= Cut::half; ++b) {
    double sum = 0;
    cut.row_sum.push_back(0);
    for (int a = -Cut::half; a <= Cut::half; ++a) {
      const Vec3 p = point + (a * Cut::pixel_mm) * frame.u + (b * Cut::pixel_mm) * frame.v;
      sum += static_cast<double>(value_at(tissue.excess, p));
      cut.row_sum.push_back(sum);
    }
  }
  return cut;
}

struct Disc {
  int a = 0, b = 0;  ///< centre, pixels from the middle
  double radius_mm = 0;
  double excess = -1e9;  ///< sum over the disc, unusual radii and places at a penalty
};

double excess_in(const Cut& cut, int a, int b, double radius_mm) {
  const double radius = radius_mm / Cut::pixel_mm;
  const int rows = static_cast<int>(radius);
  double sum = 0;
  for (int row = -rows; row <= rows; ++row) {
    const int width = static_cast<int>(std::sqrt(radius * radius - row * row));
    sum += cut.over(b + row, a - width, a + width);
  }
  return sum;
}

/// The disc of most blood.
Disc best_disc(const Cut& cut, double radius_step_mm, int step, double nats_per_mm2) {
  constexpr double min_mm = 10, max_mm = 26;
  constexpr int reach = 8;  // 12 mm from the middle; with the greatest radius still inside the cut
  static_assert(reach * Cut::pixel_mm + max_mm < Cut::half * Cut::pixel_mm);
  Disc best;
  const int radii = 1 + static_cast<int>((max_mm - min_mm) / radius_step_mm);
  for (int r = 0; r < radii; ++r) {
    const double radius_mm = min_mm + r * radius_step_mm;
    const double unusual = (radius_mm - typical_radius_mm) / radius_slack_mm;
    for (int b = -reach; b <= reach; b += step)
      for (int a = -reach; a <= reach; a += step) {
        const double across = math::hypot(a, b) * Cut::pixel_mm / across_slack_mm;
        const double penalty_nats = 0.5 * (unusual * unusual + across * across);
        const double excess =
            excess_in(cut, a, b, radius_mm) - penalty_nats / (2 * nats_per_mm2 * image::section_pixel_mm2);
        if (excess > best.excess) best = {a, b, radius_mm, excess};
      }
  }
  return best;
}

/// How much more the grey values in the plane speak for a disc of blood in a plate of muscle than for blood alone or
/// muscle alone, nats; less for large shifts and tilts.
double gain_of(const FaintTissue& tissue, const ValvePatch& start, const Pose& pose) {
  constexpr double search_mm = 9, min_mm2 = 300, nothing = -1e9, radius_step_mm = 2;
  constexpr int step = 2;
  const Vec3 point = point_of(start, pose), normal = normal_of(start, pose);
  const auto points = image::section_points(tissue.open, point, normal, search_mm);
  if (static_cast<double>(points.size()) * image::section_pixel_mm2 < min_mm2) return nothing;
  double whole = 0;
  for (const Vec3& p : points) whole += static_cast<double>(value_at(tissue.excess, p));
  const Disc disc = best_disc(cut_at(tissue, point, normal), radius_step_mm, step, tissue.nats_per_mm2);
  const double off = math::pow(pose.shift_mm / shift_slack_mm, 2) + math::pow(pose.tilt_deg() / tilt_slack_deg, 2);
  return 2 * (disc.excess - std::max(whole, 0.0)) * image::section_pixel_mm2 * tissue.nats_per_mm2 - 0.5 * off;
}

std::vector<Pose> poses_around(const Pose& middle, double shift_step_mm, int shifts, double tilt_step_deg, int tilts) {
  constexpr double max_tilt_deg = 35;
  std::vector<Pose> poses;
  for (int shift = -shifts; shift <= shifts; ++shift)
    for (int u = -tilts; u <= tilts; ++u)
      for (int v = -tilts; v <= tilts; ++v) {
        const Pose pose{middle.shift_mm + shift * shift_step_mm, middle.tilt_u_deg + u * tilt_step_deg,
                        middle.tilt_v_deg + v * tilt_step_deg};
        if (std::abs(pose.shift_mm) <= reach_mm && pose.tilt_deg() <= max_tilt_deg) poses.push_back(pose);
      }
  return poses;
}

struct Choice {
  Pose pose;
  double gain = 0;
};

/// The pose of greatest gain; the first of equals.
Choice best_of(const FaintTissue& tissue, const ValvePatch& start, const std::vector<Pose>& poses) {
  std::vector<double> gain(poses.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(poses.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n)
      gain[n] = gain_of(tissue, start, poses[n]);
  });
  const auto best = static_cast<std::size_t>(std::max_element(gain.begin(), gain.end()) - gain.begin());
  return {poses[best], gain[best]};
}

/// Coarse to fine; every step looks one step of the one before around.
Choice find_plane(const FaintTissue& tissue, const ValvePatch& start) {
  Choice choice = best_of(tissue, start, poses_around({}, 1.5, 10, 8, 4));
  choice = best_of(tissue, start, poses_around(choice.pose, 0.75, 2, 4, 2));
  return best_of(tissue, start, poses_around(choice.pose, 0.375, 2, 2, 2));
}

}  // namespace

FaintTissue show_tissue(const Volume<float>& hu, const FaintRightHeart& right) {
  constexpr double min_power = 1;
  const auto& walls = right.walls;
  const double difference = right.contrast.difference_hu();
  const double middle = right.contrast.muscle_hu + difference / 2;
  const double power = std::max(right.contrast.noise_power, min_power);
  const double information = std::min(difference * difference / (2 * power), max_information);
  FaintTissue tissue{Volume<float>(hu.grid), Volume<float>(hu.grid), 0};
  tissue.nats_per_mm2 = 2 * information * thickness_mm;
  for (std::size_t v = 0; v < hu.voxels.size(); ++v) {
    const double outside = static_cast<double>(walls.from_outside.voxels[v]);
    const double other = static_cast<double>(walls.from_other_left.voxels[v]);
    const bool in_left = static_cast<double>(walls.from_lv.voxels[v]) < walls.lv_wall_mm || other <= 0;
    const bool open = right.near.voxels[v] && outside > off_fat_mm && other > off_left_blood_mm && !in_left;
    const double grey = difference * (static_cast<double>(hu.voxels[v]) - middle) / power;
    const double excess = information > 0 ? std::clamp(grey, -max_information, max_information) / (2 * information) : 0;
    tissue.open.voxels[v] = open;
    if (open)
      tissue.excess.voxels[v] = static_cast<float>(excess);
    else
      tissue.excess.voxels[v] = outside <= 0 || in_left ? -0.5F : 0.0F;
  }
  tissue.excess = image::gaussian(tissue.excess, smoothing_mm);
  return tissue;
}

std::optional<ValvePatch> find_orifice(const FaintTissue& tissue, const ValvePatch& start) {
  if (tissue.nats_per_mm2 == 0) return std::nullopt;
  const auto [pose, gain] = find_plane(tissue, start);
  if (gain < min_nats) return std::nullopt;
  const Vec3 point = point_of(start, pose), normal = normal_of(start, pose);
  const Disc disc = best_disc(cut_at(tissue, point, normal), 0.5, 1, tissue.nats_per_mm2);
  const image::PlaneFrame frame = image::frame_across(normal);
  ValvePatch patch;
  patch.centre_mm = point + (disc.a * Cut::pixel_mm) * frame.u + (disc.b * Cut::pixel_mm) * frame.v;
  patch.normal = normal;
  patch.diameter_mm = 2 * disc.radius_mm;
  patch.share = 1;
  return patch;
}

}  // namespace heartgen::landmarks
