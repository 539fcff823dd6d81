// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/labels/swapped_labels.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "generator/labels/contacts.hpp"
#include "model/error.hpp"
#include "model/priors.hpp"

namespace heartgen::labels {
namespace {

using enum Region;

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
  return area > priors::smallest_valve_mm2 ? static_cast<double>(voxels) * labels.grid.voxel_volume_mm3() / area : 0;
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
  const auto refuse_where = [&](bool swapped, const char* one, const char* other, const char* why) {
    if (swapped)
      throw UserError(fmt::format("{} and {} seem to be exchanged: {}", one, other, why), path,
                      "correct the label map, labels.preset or [labels.regions]");
  };
  refuse_where(c.outside(lv_blood) > priors::smallest_valve_mm2 + far_more * c.outside(lv_myocardium) &&
                   c.is_there[tag(lv_myocardium)],
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

}  // namespace heartgen::labels
