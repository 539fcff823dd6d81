// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/landmarks/valve_patch.hpp"

#include <algorithm>
#include <numbers>

#include "generator/image/statistics.hpp"
#include "generator/landmarks/contact.hpp"

namespace heartgen::landmarks {
namespace {

constexpr std::size_t min_faces = 5;
constexpr double linked_voxels = 1.5;  // faces of neighbouring voxels, also over an edge or a step

/// Indices of the largest set of points that hang together. Points are few (hundreds), so every pair is compared.
std::vector<std::size_t> largest_cluster(const std::vector<Vec3>& points, double link_mm) {
  std::vector<int> cluster(points.size(), -1);
  std::vector<std::size_t> largest;
  for (std::size_t start = 0; start < points.size(); ++start) {
    if (cluster[start] >= 0) continue;
    cluster[start] = 1;
    std::vector<std::size_t> members{start};
    for (std::size_t n = 0; n < members.size(); ++n)
      for (std::size_t other = 0; other < points.size(); ++other) {
        if (cluster[other] >= 0 || norm(points[other] - points[members[n]]) > link_mm) continue;
        cluster[other] = 1;
        members.push_back(other);
      }
    if (members.size() > largest.size()) largest = members;
  }
  return largest;
}

}  // namespace

std::optional<ValvePatch> find_valve_patch(const LabelVolume& chambers, Region ventricle, Region beyond) {
  const auto contact = contact_surface(
      chambers, [&](std::uint8_t l) { return l == tag(ventricle); }, [&](std::uint8_t l) { return l == tag(beyond); });
  if (contact.points.size() < min_faces || norm(contact.area_mm2) == 0) return std::nullopt;
  const auto members = largest_cluster(contact.points, linked_voxels * chambers.grid.spacing_mm.x);
  std::vector<Vec3> points;
  points.reserve(members.size());
  for (const auto n : members) points.push_back(contact.points[n]);
  ValvePatch patch;
  patch.centre_mm = image::mean(points);
  patch.normal = normalized(contact.area_mm2);
  patch.diameter_mm = 2 * std::sqrt(norm(contact.area_mm2) / std::numbers::pi);
  patch.uneven_mm = image::principal_axes(points).deviation[2];
  patch.share = static_cast<double>(points.size()) / static_cast<double>(contact.points.size());
  return patch;
}

}  // namespace heartgen::landmarks
