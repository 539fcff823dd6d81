#include "generator/segment/morphology.hpp"

#include <algorithm>

#include "generator/segment/distance.hpp"

namespace heart::segment {
namespace {

constexpr double rounding_mm = 1e-4;  // distances are floats: a ball reaches the voxels exactly at its radius

Mask inverse(const Mask& mask) {
  Mask result(mask.grid);
  for (std::size_t v = 0; v < mask.voxels.size(); ++v) result.voxels[v] = mask.voxels[v] == 0;
  return result;
}

template <class Rule>
Mask combine(const Mask& a, const Mask& b, Rule rule) {
  Mask result(a.grid);
  for (std::size_t v = 0; v < a.voxels.size(); ++v) result.voxels[v] = rule(a.voxels[v] != 0, b.voxels[v] != 0);
  return result;
}

}  // namespace

Mask dilate(const Mask& mask, double radius_mm) {
  const auto distance = distance_to(mask, static_cast<float>(radius_mm) + 1.0F);
  Mask result(mask.grid);
  for (std::size_t v = 0; v < result.voxels.size(); ++v)
    result.voxels[v] = static_cast<double>(distance.voxels[v]) <= radius_mm + rounding_mm;
  return result;
}

Mask erode(const Mask& mask, double radius_mm) { return inverse(dilate(inverse(mask), radius_mm)); }
Mask open(const Mask& mask, double radius_mm) { return dilate(erode(mask, radius_mm), radius_mm); }
Mask close(const Mask& mask, double radius_mm) { return erode(dilate(mask, radius_mm), radius_mm); }

Mask intersect(const Mask& a, const Mask& b) {
  return combine(a, b, [](bool x, bool y) { return x && y; });
}
Mask unite(const Mask& a, const Mask& b) {
  return combine(a, b, [](bool x, bool y) { return x || y; });
}
Mask subtract(const Mask& a, const Mask& b) {
  return combine(a, b, [](bool x, bool y) { return x && !y; });
}
std::int64_t count(const Mask& mask) {
  return static_cast<std::int64_t>(mask.voxels.size()) -
         std::count(mask.voxels.begin(), mask.voxels.end(), std::uint8_t{0});
}

}  // namespace heart::segment
