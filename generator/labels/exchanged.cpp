#include "generator/labels/exchanged.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "model/error.hpp"

namespace heart::labels {
namespace {

using enum Region;

constexpr double far_more = 2;     // as much contact as with the right neighbour, before it is a mistake
constexpr double least_mm2 = 100;  // less than the smallest valve
constexpr std::size_t regions = 18;

/// Areas over which voxels of two regions touch.
struct Contacts {
  std::array<std::array<double, regions>, regions> area_mm2{};
  std::array<bool, 256> is_there{};

  void add(std::uint8_t a, std::uint8_t b, double area) {
    if (a == b || a >= regions || b >= regions) return;
    area_mm2[a][b] += area;
    area_mm2[b][a] += area;
  }
  /// With what lies around the heart.
  double outside(Region region) const {
    return of(region, none) + of(region, torso) + of(region, lung) + of(region, liver) + of(region, bone);
  }
  double of(Region a, Region b) const { return area_mm2[tag(a)][tag(b)]; }
  /// Whether `region` touches `wrong` as it should touch `right`, which is there.
  bool prefers(Region region, Region wrong, Region right) const {
    return is_there[tag(right)] && of(region, wrong) > least_mm2 && of(region, wrong) > far_more * of(region, right);
  }
};

Contacts contacts_in(const LabelVolume& labels) {
  Contacts contacts;
  const auto& size = labels.grid.size;
  const Vec3& s = labels.grid.spacing_mm;
  const std::array<double, 3> area{s.y * s.z, s.x * s.z, s.x * s.y};
  const std::array<std::int64_t, 3> step{1, size[0], size[0] * size[1]};
  std::size_t v = 0;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i, ++v) {
        contacts.is_there[labels.voxels[v]] = true;
        const std::array<bool, 3> has_next{i + 1 < size[0], j + 1 < size[1], k + 1 < size[2]};
        for (std::size_t axis = 0; axis < 3; ++axis)
          if (has_next[axis])
            contacts.add(labels.voxels[v], labels.voxels[v + static_cast<std::size_t>(step[axis])], area[axis]);
      }
  return contacts;
}

/// The mean place of a region along x, LPS mm: it rises to the patient's left.
double middle_x_mm(const LabelVolume& labels, Region region) {
  double sum = 0, count = 0;
  std::size_t v = 0;
  const auto& size = labels.grid.size;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i, ++v)
        if (labels.voxels[v] == tag(region)) {
          sum +=
              lps_from_index(labels.grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}).x;
          ++count;
        }
  return count > 0 ? sum / count : 0;
}

/// About the thickness of a ventricle's wall.
double thickness_mm(const LabelVolume& labels, const Contacts& contacts, Region wall, Region blood) {
  const auto voxels = std::count(labels.voxels.begin(), labels.voxels.end(), tag(wall));
  const double area = contacts.of(wall, blood);
  return area > least_mm2 ? static_cast<double>(voxels) * labels.grid.voxel_volume_mm3() / area : 0;
}

/// Either alone may be a disease, or a heart on the right.
bool is_thin_and_right(const LabelVolume& labels, const Contacts& contacts) {
  const double left = thickness_mm(labels, contacts, lv_myocardium, lv_blood);
  const double right = thickness_mm(labels, contacts, rv_myocardium, rv_blood);
  constexpr double clearly = 1.3;
  if (left == 0 || right < clearly * left) return false;
  return middle_x_mm(labels, lv_blood) < middle_x_mm(labels, rv_blood) &&
         middle_x_mm(labels, lv_myocardium) < middle_x_mm(labels, rv_myocardium);
}

}  // namespace

void refuse_exchanged_regions(const LabelVolume& labels, const std::string& path) {
  const Contacts c = contacts_in(labels);
  const auto refuse_where = [&](bool exchanged, const char* one, const char* other, const char* why) {
    if (exchanged)
      throw UserError(fmt::format("{} and {} seem to be exchanged: {}", one, other, why), path,
                      "correct the label map, labels.preset or [labels.regions]");
  };
  refuse_where(c.outside(lv_blood) > least_mm2 + far_more * c.outside(lv_myocardium) && c.is_there[tag(lv_myocardium)],
               "lv_blood", "lv_myocardium", "the blood lies around the wall");
  refuse_where(c.prefers(lv_myocardium, la_blood, lv_blood), "lv_blood", "la_blood",
               "lv_myocardium lies around la_blood");
  refuse_where(c.prefers(lv_myocardium, ra_blood, rv_blood), "rv_blood", "ra_blood", "the septum lies at ra_blood");
  // Of the left ventricle's wall the septum alone touches the right one's blood, and papillary muscle its own.
  const bool in_rv = c.prefers(lv_myocardium, rv_blood, lv_blood) && !c.prefers(papillary, lv_blood, rv_blood);
  const bool blood_alone = c.of(lv_blood, lv_myocardium) >= c.of(rv_blood, rv_myocardium);
  refuse_where(in_rv && blood_alone, "lv_blood", "rv_blood", "lv_myocardium lies around rv_blood");
  refuse_where(in_rv, "lv_myocardium", "rv_myocardium", "lv_myocardium lies around rv_blood");
  refuse_where(c.prefers(lv_blood, ra_blood, la_blood) && c.prefers(rv_blood, la_blood, ra_blood), "la_blood",
               "ra_blood", "each touches the other side's ventricle");
  refuse_where(c.prefers(lv_blood, pulmonary_artery, aorta) && c.prefers(rv_blood, aorta, pulmonary_artery), "aorta",
               "pulmonary_artery", "each touches the other's ventricle");
  refuse_where(is_thin_and_right(labels, c), "the left", "the right heart",
               "what is called left has the thinner wall and lies on the right");
}

}  // namespace heart::labels
