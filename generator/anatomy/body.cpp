// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "generator/anatomy/liver.hpp"
#include "generator/anatomy/spinal_canal.hpp"
#include "generator/anatomy/wall_band.hpp"
#include "generator/image/components.hpp"
#include "generator/image/distance.hpp"
#include "generator/image/gaussian.hpp"
#include "generator/image/masks.hpp"
#include "generator/image/morphology.hpp"
#include "generator/parallel/threads.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"
#include "model/priors.hpp"
#include "model/quantile.hpp"
#include "model/tissue.hpp"

namespace heartgen::anatomy {
namespace {

constexpr double smoothing_mm = 1;             // against noise, for bone
constexpr double evenness_smoothing_mm = 1.5;  // of the image before its evenness is measured
constexpr float clip_mm = 12;                  // beyond, depth makes no difference

bool inside(const Grid& grid, const Vec3& position_mm) {
  const Vec3 index = index_from_lps(grid, position_mm);
  return grid.contains(std::lround(index.x), std::lround(index.y), std::lround(index.z));
}

struct Gap {
  bool reaches_side = false;  // touches the left, right, front or back face of the image
  std::int64_t air_voxels = 0;
  double grey_sum = 0;
};

std::vector<Gap> measure_gaps(const image::Components& gaps, const CtVolume& ct) {
  std::vector<Gap> result(gaps.voxel_count.size());
  const auto [nx, ny, nz] = ct.grid.size;
  std::size_t v = 0;
  for (std::int64_t k = 0; k < nz; ++k)
    for (std::int64_t j = 0; j < ny; ++j)
      for (std::int64_t i = 0; i < nx; ++i, ++v) {
        Gap& gap = result[static_cast<std::size_t>(gaps.label.voxels[v])];
        gap.reaches_side |= i == 0 || j == 0 || i == nx - 1 || j == ny - 1;
        if (ct.voxels[v] > tissue::air_in_gap_max_hu) continue;
        ++gap.air_voxels;
        gap.grey_sum += ct.voxels[v];
      }
  return result;
}

/// The patient: the largest piece of tissue with all that it encloses. Air that reaches the side of the image is
/// outside when it is as empty as air, and lung cut by the field of view otherwise.
Mask find_body(const CtVolume& ct, const Mask& tissue) {
  const Mask core = image::largest_component(image::erode(tissue, priors::table_contact_mm));
  const Mask solid = image::intersect(image::dilate(core, priors::table_contact_mm + 0.5), tissue);
  const image::Components gaps =
      image::connected_components(image::mask_where(ct.grid, [&](std::size_t v) { return solid.voxels[v] == 0; }));
  const auto gap = measure_gaps(gaps, ct);
  return image::mask_where(ct.grid, [&](std::size_t v) {
    const Gap& g = gap[static_cast<std::size_t>(gaps.label.voxels[v])];
    if (solid.voxels[v] || !g.reaches_side) return true;
    return g.air_voxels > 0 && g.grey_sum / static_cast<double>(g.air_voxels) > tissue::room_air_max_hu;
  });
}

Mask find_lung(const Mask& body, const Mask& tissue) {
  const image::Components air = image::connected_components(image::subtract(body, tissue));
  if (air.voxel_count.size() < 2) return Mask(body.grid);
  const auto largest = *std::max_element(air.voxel_count.begin() + 1, air.voxel_count.end());
  const auto least = static_cast<std::int64_t>(priors::lung_share * static_cast<double>(largest));
  const Mask lung = image::mask_where(body.grid, [&](std::size_t v) {
    const auto label = static_cast<std::size_t>(air.label.voxels[v]);
    return label > 0 && air.voxel_count[label] >= least;
  });
  return image::intersect(image::fill_holes(image::close(lung, priors::lung_vessel_radius_mm)), body);
}

constexpr double no_value = 1e6;

/// no_value for none.
float median(std::vector<float> values) { return values.empty() ? static_cast<float>(no_value) : upper_median(values); }

double median_under(const Volume<float>& image, const LabelVolume& labels, Region region) {
  std::vector<float> values;
  for (std::size_t v = 0; v < labels.voxels.size(); ++v)
    if (labels.voxels[v] == tag(region)) values.push_back(image.voxels[v]);
  return static_cast<double>(median(std::move(values)));
}

/// Voxels nearly as bright as the heart's blood that are connected with it over more than thin contacts: the great
/// vessels beyond the model. The spongy inside of bones is less bright, and their bright shell is thin.
Mask find_vessels(const Volume<float>& image, const LabelVolume& chambers) {
  const Mask heart = image::mask_where(
      chambers.grid, [&](std::size_t v) { return is_blood(static_cast<Region>(chambers.voxels[v])); });
  const double min_hu = tissue::great_vessel_share * median_under(image, chambers, Region::lv_blood);
  const Mask bright =
      image::mask_where(chambers.grid, [&](std::size_t v) { return static_cast<double>(image.voxels[v]) > min_hu; });
  const image::Components wide = image::connected_components(
      image::unite(image::erode(image::unite(bright, heart), priors::vessel_bone_contact_mm), heart));
  std::vector<std::uint8_t> joined(wide.voxel_count.size(), 0);
  for (std::size_t v = 0; v < heart.voxels.size(); ++v)
    if (heart.voxels[v]) joined[static_cast<std::size_t>(wide.label.voxels[v])] = 1;
  const Mask core = image::mask_where(chambers.grid, [&](std::size_t v) {
    const auto label = static_cast<std::size_t>(wide.label.voxels[v]);
    return label > 0 && joined[label] != 0;
  });
  return image::dilate(core, priors::vessel_bone_contact_mm + 1);
}

/// Voxels of `bright` deep inside it where the image hardly varies.
Mask find_even(const CtVolume& ct, const Mask& bright) {
  Volume<float> image(ct.grid);
  std::copy(ct.voxels.begin(), ct.voxels.end(), image.voxels.begin());
  image = image::gaussian(image, evenness_smoothing_mm);
  const Mask deep = image::erode(bright, priors::organ_rim_mm);
  Mask even(ct.grid);
  const auto& size = ct.grid.size;
  parallel::parallel_for(0, size[2], [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < size[1]; ++j)
        for (std::int64_t i = 0; i < size[0]; ++i)
          even(i, j, k) = deep(i, j, k) && norm(gradient(image, {i, j, k})) < tissue::even_organ_slope_max_hu_per_mm;
  });
  return image::count(even) > 0 ? image::open(even, priors::organ_rim_mm) : even;
}

/// Organs and vessels full of contrast among the bright voxels: even in grey value, where spongy bone seldom is.
Mask find_even_organs(const CtVolume& ct, const Volume<float>& image, const Mask& bright) {
  const auto least = static_cast<std::int64_t>(priors::even_organ_min_ml * 1000 / ct.grid.voxel_volume_mm3());
  const image::Components cores =
      image::connected_components(image::drop_small_components(find_even(ct, bright), least));
  const std::size_t most = std::min<std::size_t>(cores.voxel_count.size(), 256);  // far more than a body has
  std::vector<std::vector<float>> greys(most);
  LabelVolume core(ct.grid);
  for (std::size_t v = 0; v < core.voxels.size(); ++v) {
    const auto label = static_cast<std::size_t>(cores.label.voxels[v]);
    if (label == 0 || label >= most) continue;
    core.voxels[v] = static_cast<std::uint8_t>(label);
    greys[label].push_back(image.voxels[v]);
  }
  const auto spread = static_cast<float>(tissue::organ_rim_spread_hu);
  std::vector<float> limit(most, 0);
  for (std::size_t label = 1; label < most; ++label) limit[label] = median(std::move(greys[label])) + spread;
  const Vec3& spacing = ct.grid.spacing_mm;
  const LabelVolume organ = image::nearest_label(
      core, priors::organ_rim_mm + priors::organ_outer_rim_mm + std::max({spacing.x, spacing.y, spacing.z}) / 2);
  return image::mask_where(ct.grid, [&](std::size_t v) {
    return bright.voxels[v] && organ.voxels[v] && image.voxels[v] < limit[organ.voxels[v]];
  });
}

/// Pieces that have cortical bone in them; contrast in small vessels, spleen and kidneys is less bright.
Mask with_cortex(const Mask& pieces, const Volume<float>& image, std::int64_t min_voxels) {
  const image::Components parts = image::connected_components(pieces);
  std::vector<std::int64_t> cortical(parts.voxel_count.size(), 0);
  for (std::size_t v = 0; v < pieces.voxels.size(); ++v)
    if (image.voxels[v] > tissue::cortical_bone_min_hu) ++cortical[static_cast<std::size_t>(parts.label.voxels[v])];
  return image::mask_where(pieces.grid, [&](std::size_t v) {
    const auto label = static_cast<std::size_t>(parts.label.voxels[v]);
    return label > 0 && parts.voxel_count[label] >= min_voxels &&
           tissue::bone_per_cortex * static_cast<double>(cortical[label]) >=
               static_cast<double>(parts.voxel_count[label]);
  });
}

/// How grey value and depth go together in a piece.
struct DepthTrend {
  double n = 0, grey = 0, depth = 0, grey2 = 0, depth2 = 0, product = 0;

  void add(double g, double d) {
    n += 1, grey += g, depth += d;
    grey2 += g * g, depth2 += d * d, product += g * d;
  }
  double correlation() const {
    const double spread = (n * grey2 - grey * grey) * (n * depth2 - depth * depth);
    return spread > 0 ? (n * product - grey * depth) / std::sqrt(spread) : 0;
  }
};

/// Pieces that are contrast-filled through and through: brighter the deeper, like a blurred tube, where bone is
/// brightest in its shell; and hardly brighter than the heart's blood, where small pieces of compact bone are.
Mask find_filled_vessels(const Mask& pieces, const Volume<float>& image, double blood_hu) {
  const Mask outside = image::mask_where(pieces.grid, [&](std::size_t v) { return pieces.voxels[v] == 0; });
  if (image::count(outside) == 0) return Mask(pieces.grid);
  const auto depth = image::distance_to(outside, clip_mm);
  const image::Components parts = image::connected_components(pieces);
  std::vector<DepthTrend> trend(parts.voxel_count.size());
  std::vector<std::int64_t> brighter(parts.voxel_count.size(), 0);
  for (std::size_t v = 0; v < pieces.voxels.size(); ++v) {
    if (!pieces.voxels[v]) continue;
    const auto label = static_cast<std::size_t>(parts.label.voxels[v]);
    const auto grey = static_cast<double>(image.voxels[v]);
    trend[label].add(grey, static_cast<double>(depth.voxels[v]));
    brighter[label] += grey > tissue::filled_vessel_max_share * blood_hu;
  }
  return image::mask_where(pieces.grid, [&](std::size_t v) {
    const auto label = static_cast<std::size_t>(parts.label.voxels[v]);
    return label > 0 && trend[label].correlation() > tissue::filled_vessel_correlation &&
           10 * brighter[label] < parts.voxel_count[label];
  });
}

/// Brightest value in the box of priors::cortex_distance_mm around a voxel, among the voxels of `bone`.
float brightest_near(const Volume<float>& image, const Mask& bone, const Index3& at) {
  Index3 low{}, high{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto reach = std::lround(priors::cortex_distance_mm / image.grid.spacing_mm[static_cast<int>(axis)]);
    low[axis] = std::max<std::int64_t>(at[axis] - reach, 0);
    high[axis] = std::min<std::int64_t>(at[axis] + reach + 1, image.grid.size[axis]);
  }
  float most = 0;
  for (std::int64_t k = low[2]; k < high[2]; ++k)
    for (std::int64_t j = low[1]; j < high[1]; ++j)
      for (std::int64_t i = low[0]; i < high[0]; ++i)
        if (bone(i, j, k)) most = std::max(most, image(i, j, k));
  return most;
}

/// Bone without the blurred outside of its shell: it ends near half height between soft tissue and cortical bone.
Mask trimmed(const Mask& bone, const Volume<float>& image) {
  const auto soft = static_cast<float>(tissue::muscle_beside_bone_hu);
  const auto share = static_cast<float>(tissue::bone_edge_share);
  const Mask deep = image::erode(bone, priors::bone_skin_mm);
  Mask result = bone;
  const auto& size = bone.grid.size;
  parallel::parallel_for(0, size[2], [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < size[1]; ++j)
        for (std::int64_t i = 0; i < size[0]; ++i) {
          if (!bone(i, j, k) || deep(i, j, k)) continue;
          const float least = soft + share * (brightest_near(image, bone, {i, j, k}) - soft);
          if (image(i, j, k) < least) result(i, j, k) = 0;
        }
  });
  return image::intersect(image::fill_holes_in_slices(result), bone);
}

/// Without the pieces that see lung to most sides, which are vessels of the lung; a rib sees it to one side.
Mask drop_pieces_in_lung(const Mask& bone, const Mask& lung) {
  const image::Components parts = image::connected_components(bone);
  std::vector<std::int64_t> lung_views(parts.voxel_count.size(), 0), views(parts.voxel_count.size(), 0);
  const auto& size = bone.grid.size;
  Index3 look{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    look[axis] = std::max<std::int64_t>(
        std::lround(priors::lung_beside_bone_mm / bone.grid.spacing_mm[static_cast<int>(axis)]), 1);
  std::size_t v = 0;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i, ++v) {
        if (!bone.voxels[v]) continue;
        const auto label = static_cast<std::size_t>(parts.label.voxels[v]);
        for (std::size_t axis = 0; axis < 3; ++axis)
          for (const int way : {-1, 1}) {
            Index3 next{i, j, k}, at{i, j, k};
            next[axis] += way, at[axis] += way * look[axis];
            if (!bone.grid.contains(at[0], at[1], at[2]) || bone(next[0], next[1], next[2])) continue;
            ++views[label];
            lung_views[label] += lung(at[0], at[1], at[2]);
          }
      }
  return image::mask_where(bone.grid, [&](std::size_t n) {
    const auto label = static_cast<std::size_t>(parts.label.voxels[n]);
    return label > 0 && 2 * lung_views[label] <= views[label];
  });
}

/// LPS y of the centre of the chambers; -no_value without any, which is in front of everything.
double middle_of_heart_mm(const LabelVolume& chambers) {
  const auto [nx, ny, nz] = chambers.grid.size;
  Vec3 sum;
  double n = 0;
  std::size_t v = 0;
  for (std::int64_t k = 0; k < nz; ++k)
    for (std::int64_t j = 0; j < ny; ++j)
      for (std::int64_t i = 0; i < nx; ++i, ++v) {
        if (chambers.voxels[v] == 0) continue;
        sum = sum + Vec3{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
        n += 1;
      }
  return n > 0 ? lps_from_index(chambers.grid, sum * (1 / n)).y : -no_value;
}

Mask find_bone(const CtVolume& ct, const BodyResult& body, const LabelVolume& chambers) {
  Volume<float> image(ct.grid);
  std::copy(ct.voxels.begin(), ct.voxels.end(), image.voxels.begin());
  image = image::gaussian(image, smoothing_mm);
  const Mask bright = image::mask_where(ct.grid, [&](std::size_t v) {
    return image.voxels[v] > tissue::spongy_bone_min_hu && body.body.voxels[v] && chambers.voxels[v] == 0;
  });
  const Mask vessels = find_vessels(image, chambers);
  Mask dense = image::mask_where(ct.grid, [&](std::size_t v) { return image.voxels[v] > tissue::bone_max_hu; });
  if (image::count(dense) > 0) dense = image::dilate(dense, priors::metal_rim_mm);
  const Mask rest = image::mask_where(ct.grid, [&](std::size_t v) {
    return bright.voxels[v] && !vessels.voxels[v] && !body.lung.voxels[v] && !dense.voxels[v];
  });
  const Mask organs = image::unite(find_even_organs(ct, image, rest), dense);
  const auto least = static_cast<std::int64_t>(priors::bone_piece_min_ml * 1000 / ct.grid.voxel_volume_mm3());
  const Mask shell = with_cortex(image::subtract(rest, organs), image, least);
  // Even marrow counts as an organ, too, but its shell closes around it.
  const Mask solid = image::subtract(image::close(shell, priors::marrow_gap_mm), organs);
  const Mask filled = image::fill_holes_in_slices(solid);
  const Mask wall = image::mask_where(
      ct.grid, [&](std::size_t v) { return solid.voxels[v] || image.voxels[v] > tissue::spinal_canal_max_hu; });
  const Mask canal = find_spinal_canal(filled, wall, middle_of_heart_mm(chambers));
  const Mask bone = image::unite(image::subtract(filled, canal), solid);
  const Mask kept = image::mask_where(ct.grid, [&](std::size_t v) {
    return bone.voxels[v] && body.body.voxels[v] && !vessels.voxels[v] && !body.lung.voxels[v] &&
           chambers.voxels[v] == 0;
  });
  const Mask bone_alone = trimmed(kept, image);
  double blood_hu = 0;  // of the left side, wherever the contrast is just then
  for (const Region region : {Region::lv_blood, Region::la_blood, Region::aorta})
    if (const double hu = median_under(image, chambers, region); hu < no_value) blood_hu = std::max(blood_hu, hu);
  return drop_pieces_in_lung(image::subtract(bone_alone, find_filled_vessels(bone_alone, image, blood_hu)), body.lung);
}

}  // namespace

BodyResult segment_body(const CtVolume& ct, const pde::SegmentationTree& tree, const LabelVolume& chambers,
                        const Landmarks& landmarks, const ChamberSettings& settings) {
  const Mask& tissue = pde::side(tree, settings.tissue);
  BodyResult result;
  result.body = find_body(ct, tissue);
  if (image::count(result.body) == 0)
    throw UserError(fmt::format("\"{}\" holds no piece of tissue thicker than {:.0f} mm", settings.tissue,
                                2 * priors::table_contact_mm),
                    "chambers.tissue", "name the side of the tree that is not air");
  result.lung = find_lung(result.body, tissue);
  result.bone = find_bone(ct, result, chambers);
  const Mask free = image::mask_where(ct.grid, [&](std::size_t v) {
    return result.body.voxels[v] && !result.lung.voxels[v] && !result.bone.voxels[v] && chambers.voxels[v] == 0;
  });
  const auto liver = landmarks.seeds_mm.find("liver");
  if (liver == landmarks.seeds_mm.end())
    result.liver = find_liver(ct, result.lung, free);
  else
    result.liver = inside(ct.grid, liver->second) ? segment_liver(ct, free, liver->second) : Mask(ct.grid);
  return result;
}

}  // namespace heartgen::anatomy
