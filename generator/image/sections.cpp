// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/image/sections.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "model/mathematics.hpp"
#include "model/priors.hpp"

namespace heartgen::image {
namespace {

constexpr double pixel_mm = 1.5;
static_assert(pixel_mm * pixel_mm == section_pixel_mm2);
constexpr int half_pixels = 24;  // 36 mm: the widest valve and half as much again
constexpr int side_pixels = 2 * half_pixels + 1;
constexpr double degree = std::numbers::pi / 180;

using Pixels = std::vector<std::uint8_t>;  // side_pixels squared: 0 outside, 1 blood, 2 blood that was visited

std::size_t pixel_index(int a, int b) {
  return static_cast<std::size_t>(b) * side_pixels + static_cast<std::size_t>(a);
}

Vec3 pixel_position(const Vec3& point, const PlaneFrame& frame, int a, int b) {
  return point + ((a - half_pixels) * pixel_mm) * frame.u + ((b - half_pixels) * pixel_mm) * frame.v;
}

Pixels cut(const Volume<float>& blood, const Vec3& point, const PlaneFrame& frame) {
  Pixels pixels(side_pixels * side_pixels);
  for (int b = 0; b < side_pixels; ++b)
    for (int a = 0; a < side_pixels; ++a)
      pixels[pixel_index(a, b)] =
          sample_linear(blood, index_from_lps(blood.grid, pixel_position(point, frame, a, b))) > 0.5;
  return pixels;
}

/// The blood pixel nearest to the middle, at most `search` pixels away; -1 for none.
int nearest_blood(const Pixels& pixels, double search) {
  int best = -1;
  double nearest = search * search + 1e-9;
  for (int b = 0; b < side_pixels; ++b)
    for (int a = 0; a < side_pixels; ++a) {
      const double d = (a - half_pixels) * (a - half_pixels) + (b - half_pixels) * (b - half_pixels);
      if (!pixels[pixel_index(a, b)] || d >= nearest) continue;
      nearest = d;
      best = b * side_pixels + a;
    }
  return best;
}

std::vector<int> connected_pixels(Pixels pixels, int start) {
  std::vector<int> members{start};
  pixels[static_cast<std::size_t>(start)] = 2;
  for (std::size_t n = 0; n < members.size(); ++n) {
    const int a = members[n] % side_pixels, b = members[n] / side_pixels;
    constexpr std::array<std::array<int, 2>, 4> steps{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
    for (const auto& step : steps) {
      const int c = a + step[0], d = b + step[1];
      if (c < 0 || d < 0 || c >= side_pixels || d >= side_pixels || pixels[pixel_index(c, d)] != 1) continue;
      pixels[pixel_index(c, d)] = 2;
      members.push_back(d * side_pixels + c);
    }
  }
  return members;
}

/// A section, its cost, and the plane it was cut in.
struct Trial {
  double cost = 0;
  TightestPlane plane;
};

/// Larger shifts and tilts must pay: the area has to fall by about 0.4 % times shift^1.5 (mm).
std::optional<Trial> try_plane(const Volume<float>& blood, const Vec3& centre, const Vec3& normal, double shift_mm,
                               double tilt) {
  constexpr double search_mm = 4.5, per_shift = 0.004, per_tilt = 0.5;
  const auto section = section_at(blood, centre + shift_mm * normal, normal, search_mm);
  if (!section || section->area_mm2 < priors::smallest_valve_mm2) return std::nullopt;
  const double penalty = per_shift * math::pow(std::abs(shift_mm), 1.5) + per_tilt * (1 - math::cos(tilt));
  return Trial{section->area_mm2 * (1 + penalty), {*section, normal}};
}

}  // namespace

PlaneFrame frame_across(const Vec3& normal) {
  const Vec3 helper = std::abs(normal.z) < 0.9 ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
  const Vec3 u = normalized(cross(normal, helper));
  return {u, cross(normal, u)};
}

double Section::diameter_mm() const { return 2 * std::sqrt(area_mm2 / std::numbers::pi); }

std::vector<Vec3> section_points(const Volume<float>& blood, const Vec3& point, const Vec3& normal, double search_mm) {
  const PlaneFrame frame = frame_across(normal);
  const Pixels pixels = cut(blood, point, frame);
  const int start = nearest_blood(pixels, search_mm / pixel_mm);
  std::vector<Vec3> points;
  if (start < 0) return points;
  for (const int n : connected_pixels(pixels, start))
    points.push_back(pixel_position(point, frame, n % side_pixels, n / side_pixels));
  return points;
}

std::optional<Section> section_at(const Volume<float>& blood, const Vec3& point, const Vec3& normal, double search_mm) {
  const auto points = section_points(blood, point, normal, search_mm);
  if (points.empty()) return std::nullopt;
  Vec3 sum;
  for (const Vec3& p : points) sum += p;
  const auto count = static_cast<double>(points.size());
  return Section{count * section_pixel_mm2, sum / count};
}

std::optional<TightestPlane> tightest_plane(const Volume<float>& blood, const Vec3& centre, const Vec3& normal,
                                            double reach_mm) {
  constexpr std::array<double, 5> tilts_deg{0, 8, 16, 24, 35};
  constexpr int azimuths = 8;
  const int shifts = static_cast<int>(reach_mm / pixel_mm);
  const PlaneFrame frame = frame_across(normal);
  std::optional<Trial> best;
  for (const double tilt_deg : tilts_deg)
    for (int azimuth = 0; azimuth < (tilt_deg > 0 ? azimuths : 1); ++azimuth)
      for (int shift = -shifts; shift <= shifts; ++shift) {
        const double tilt = tilt_deg * degree, turn = azimuth * 2 * std::numbers::pi / azimuths;
        const Vec3 side = math::cos(turn) * frame.u + math::sin(turn) * frame.v;
        const Vec3 tilted = normalized(math::cos(tilt) * normal + math::sin(tilt) * side);
        const auto trial = try_plane(blood, centre, tilted, shift * pixel_mm, tilt);
        if (trial && (!best || trial->cost < best->cost)) best = trial;
      }
  return best ? std::optional(best->plane) : std::nullopt;
}

}  // namespace heartgen::image
