// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/chest/thorax.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "generator/chest/spine.hpp"
#include "generator/image/components.hpp"
#include "generator/image/convex_slices.hpp"
#include "generator/image/morphology.hpp"
#include "generator/image/slices.hpp"
#include "generator/image/statistics.hpp"
#include "model/error.hpp"

namespace heartgen::chest {
namespace {

constexpr float lung_limit_hu = -500;      // half-way between lung (-850) and soft tissue
constexpr float emptiest_lung_hu = -960;   // emphysema stays above; air outside the body lies below
constexpr double smallest_lung_mm2 = 600;  // per slice: airways and bowel gas are smaller
constexpr double opening_mm = 3;           // parts bronchi and the gap under the table from the lungs
constexpr double chest_slice_mm2 = 2500;   // slices with less lung are below or above the heart
constexpr double chest_margin_mm = 16;     // the heart's front lies outside the hull of the lungs

/// Median grey value of the component's pixels among the slice's first `count`; 0 for none.
double median_of(const Volume<float>& image, std::size_t slice, const image::Components& pieces, std::int32_t label,
                 std::size_t count) {
  std::vector<float> hu;
  for (std::size_t p = 0; p < count; ++p)
    if (pieces.label.voxels[p] == label) hu.push_back(image.voxels[slice + p]);
  return image::median(hu);
}

/// Lung sections of one slice: large, not as empty as the air outside, and not open to it at the front of the image, as
/// what lies on the patient is.
void mark_lung_slice(const Volume<float>& image, std::int64_t k, Mask& lung) {
  const auto pieces = image::slice_components(image, k, [](float hu) { return hu < lung_limit_hu; });
  const double pixel_mm2 = image.grid.spacing_mm.x * image.grid.spacing_mm.y;
  const auto [nx, ny, nz] = image.grid.size;
  const std::size_t slice = static_cast<std::size_t>(k * nx * ny);
  for (std::int32_t label = 1; label < static_cast<std::int32_t>(pieces.voxel_count.size()); ++label) {
    if (static_cast<double>(pieces.voxel_count[static_cast<std::size_t>(label)]) * pixel_mm2 < smallest_lung_mm2)
      continue;
    const auto& labels = pieces.label.voxels;
    const auto row = static_cast<std::size_t>(nx);
    const bool at_front = std::find(labels.begin(), labels.begin() + nx, label) != labels.begin() + nx;
    if (at_front && median_of(image, slice, pieces, label, row) <= emptiest_lung_hu) continue;
    if (median_of(image, slice, pieces, label, labels.size()) <= emptiest_lung_hu) continue;
    for (std::size_t p = 0; p < labels.size(); ++p)
      if (labels[p] == label) lung.voxels[slice + p] = 1;
  }
}

/// The two largest components: the lungs, whether or not they touch each other.
Mask two_largest(const Mask& mask) {
  const Mask first = image::largest_component(mask);
  return image::unite(first, image::largest_component(image::subtract(mask, first)));
}

/// Whether most slices that show lungs show them cut off at the back.
bool ends_in_lung(const Mask& lung) {
  const auto [nx, ny, nz] = lung.grid.size;
  const double pixel_mm2 = lung.grid.spacing_mm.x * lung.grid.spacing_mm.y;
  std::int64_t slices = 0, cut = 0;
  for (std::int64_t k = 0; k < nz; ++k) {
    const auto first = lung.voxels.begin() + k * nx * ny, last = first + nx * ny;
    if (static_cast<double>(std::count(first, last, 1)) * pixel_mm2 < chest_slice_mm2) continue;
    ++slices;
    cut += std::find(last - nx, last, 1) != last;
  }
  return 2 * cut > slices;
}

}  // namespace

Thorax find_thorax(const Volume<float>& image) {
  Mask air(image.grid);
  for (std::int64_t k = 0; k < image.grid.size[2]; ++k) mark_lung_slice(image, k, air);
  Thorax thorax;
  thorax.lung = two_largest(image::open(air, opening_mm));
  const Mask hull = image::convex_slices(thorax.lung, chest_slice_mm2);
  if (image::count(hull) == 0)
    throw UserError("no lungs are in the image: the heart cannot be found without them", "landmarks",
                    "give the seeds lv_blood, rv_blood, la_blood, ra_blood and the valve planes by hand");
  thorax.chest = image::dilate(hull, chest_margin_mm);
  thorax.spine = find_spine(image, thorax.lung);
  thorax.back_is_cut = ends_in_lung(thorax.lung);
  return thorax;
}

}  // namespace heartgen::chest
