// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/landmarks/landmarks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <numbers>

#include "generator/anatomy/faint_right_heart.hpp"
#include "generator/anatomy/hounsfield.hpp"
#include "generator/chest/spine.hpp"
#include "generator/chest/trachea.hpp"
#include "generator/landmarks/anatomy_check.hpp"
#include "generator/landmarks/assign.hpp"
#include "generator/landmarks/blood.hpp"
#include "generator/landmarks/cut_ventricles.hpp"
#include "generator/landmarks/faint_right_heart.hpp"
#include "generator/landmarks/named_chambers.hpp"
#include "generator/landmarks/right_heart.hpp"
#include "generator/landmarks/search.hpp"
#include "generator/landmarks/valves.hpp"
#include "model/error.hpp"
#include "model/mathematics.hpp"

namespace heartgen::landmarks {
namespace {

constexpr std::int64_t coarse_step = 2;  // 3 mm for lungs and spine

/// The coarse mask on the fine grid that it was thinned from.
Mask refined(const Mask& coarse, const Grid& fine) {
  Mask result(fine);
  for (std::int64_t k = 0; k < fine.size[2]; ++k)
    for (std::int64_t j = 0; j < fine.size[1]; ++j)
      for (std::int64_t i = 0; i < fine.size[0]; ++i)
        result(i, j, k) = coarse(i / coarse_step, j / coarse_step, k / coarse_step);
  return result;
}

/// The part of the image that matters, and what is known about it.
struct Scene {
  chest::WorkingImage image;
  Mask region;  ///< where heart blood may be
  chest::Spine spine;
  Contrast contrast;
  std::size_t ventricle_choice = 0;
};

/// Voxels within a heart's reach and a little more.
Box box_around_heart(const Grid& grid, const Vec3& centre) {
  constexpr double margin_mm = 12;  // shells of muscle around the outermost blood
  Box box;
  const Index3 middle = chest::nearest_voxel(grid, centre);
  const auto reach = static_cast<std::int64_t>((heart_reach_mm + margin_mm) / chest::working_spacing_mm);
  for (std::size_t a = 0; a < 3; ++a) {
    box.begin[a] = std::max<std::int64_t>(middle[a] - reach, 0);
    box.end[a] = std::min(middle[a] + reach + 1, grid.size[a]);
  }
  return box;
}

struct Chambers {
  chest::WorkingImage image;
  LabelVolume labels;
  LongAxis axis;
  std::optional<double> left_of_spine_mm;  ///< middle of the heart's blood
  double ventricle_certainty = 0;
  RightHeartLook right;
};

/// A right heart with more contrast than this comes out of the threshold as pools of its own; with less it is searched
/// for by its usual shape as well.
constexpr double pool_contrast_hu = 50;

/// One attempt with one local threshold; nothing where the left ventricle has no two neighbours.
std::optional<Chambers> find_chambers(const Scene& scene, double fraction) {
  const Mask all_blood = local_blood(scene.image, scene.contrast, fraction);
  const Vec3 centre = heart_centre(all_blood, scene.region);
  const auto box = box_around_heart(scene.region.grid, centre);
  Chambers chambers;
  chambers.image = crop(scene.image, box);
  const Mask blood = heart_blood(crop(all_blood, box), crop(scene.region, box), centre);
  const auto basins = image::divide_at_constrictions(blood);
  const auto pools = measure_pools(chambers.image, basins, scene.contrast, scene.spine, centre);
  const auto left = find_left_heart(basins, pools, scene.spine, scene.ventricle_choice);
  if (!left) return std::nullopt;
  const auto right = find_right_heart(basins, pools, *left);
  chambers.labels = label_map(basins, assign_basins(basins, pools, *left, right));
  chambers.axis = find_long_axis(chambers.labels, chambers.image.smooth);
  const double muscle_hu = chambers.right.muscle_hu = pools.at(left->ventricle.front()).shell_hu;
  if (right == 0 || pools.at(right).hu < muscle_hu + pool_contrast_hu)
    chambers.right.faint = add_faint_right_heart(chambers.labels, chambers.image, crop(scene.region, box),
                                                 chambers.axis, scene.contrast, muscle_hu);
  if (scene.spine.is_sure) chambers.left_of_spine_mm = centre.x - scene.spine.at(centre.z).x;
  chambers.ventricle_certainty = left->certainty;
  chambers.right.streaks = split_right_heart(chambers.labels, chambers.image.smooth, chambers.axis);
  keep_main_pieces(chambers.labels);
  return chambers;
}

/// Whether the right heart's names follow from its grey value: a fainter one is found by its usual shape.
bool is_bright(const naming::Naming& named) {
  const auto& ventricle = named[naming::Name::rv];
  return ventricle.ml > 0 && ventricle.hu > named.levels.muscle_hu + pool_contrast_hu;
}

/// The bodies that a labelling of all blood at once has named, within the borders of the local threshold.
Chambers chambers_by_name(const Scene& scene, const naming::Naming& named) {
  constexpr double fraction = 0.55;
  const Mask bright = local_blood(scene.image, scene.contrast, fraction);
  const Vec3 middle = middle_of_chambers(named);
  const auto box = box_around_heart(scene.region.grid, middle);
  Chambers chambers;
  chambers.image = crop(scene.image, box);
  const Mask region = crop(scene.region, box), by_name = named_blood(region.grid, named);
  Mask blood = crop(bright, box);
  for (std::size_t v = 0; v < blood.voxels.size(); ++v) blood.voxels[v] = blood.voxels[v] || by_name.voxels[v];
  chambers.labels = named_chambers(heart_blood(blood, region, middle), named);
  chambers.axis = find_long_axis(chambers.labels, chambers.image.smooth);
  chambers.right.muscle_hu = named.levels.muscle_hu;
  if (scene.spine.is_sure) chambers.left_of_spine_mm = middle.x - scene.spine.at(middle.z).x;
  chambers.ventricle_certainty = 1;  // the labelling's margin says so
  keep_main_pieces(chambers.labels);
  return chambers;
}

Chambers find_chambers(const Scene& scene) {
  // The middle value separates most hearts; thin walls need a higher and weak contrast a lower one.
  for (const double fraction : {0.55, 0.45, 0.35})
    if (auto chambers = find_chambers(scene, fraction)) return std::move(*chambers);
  throw NotAHeart("the left ventricle was found, but not both the left atrium and the aorta next to it",
                  "check that the image is not mirrored");
}

constexpr Region pool_regions[] = {Region::lv_blood, Region::rv_blood, Region::la_blood,
                                   Region::ra_blood, Region::aorta,    Region::pulmonary_artery};

/// The deepest point and the volume of every pool.
void add_seeds(const LabelVolume& chambers, FoundLandmarks& found) {
  for (const Region region : pool_regions) {
    const Mask pool =
        chest::mask_where(chambers.grid, [&](const Vec3&, std::size_t v) { return chambers.voxels[v] == tag(region); });
    const auto depth = chest::depth_of(pool);
    double voxels = 0;
    float deepest = 0;
    Vec3 seed;
    chest::for_each_voxel(chambers.grid, [&](const Vec3& p, std::size_t v) {
      voxels += pool.voxels[v];
      if (!pool.voxels[v] || depth.voxels[v] <= deepest) return;
      deepest = depth.voxels[v];
      seed = p;
    });
    const std::string name = region_name(tag(region));
    found.volumes_ml[name] = voxels * chambers.grid.voxel_volume_mm3() / 1000;
    if (voxels > 0) found.landmarks.seeds_mm[name] = seed;
  }
}

/// Slices in reverse order make a heart that looks like one, and whose right chambers are taken for each other.
void refuse_upside_down(const std::map<std::string, ValvePatch>& valves) {
  constexpr double downwards = -0.3;  // upright, the valve's normal rises by .4 to .95
  const auto aortic = valves.find("aortic");
  if (aortic == valves.end() || aortic->second.normal.z > downwards) return;
  throw NotAHeart("the aorta leaves the left ventricle downwards: the image is upside down",
                  "check the order of its slices and the orientation in its header");
}

/// By how much the header turns the image against the body's axes, in degrees; 0 for any order of the axes.
double slant_deg(const Mat3& direction) {
  double min_cosine = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 way = transposed(direction)[axis];
    min_cosine = std::min(min_cosine, std::max({std::abs(way.x), std::abs(way.y), std::abs(way.z)}));
  }
  return math::acos(min_cosine) * 180 / std::numbers::pi;
}

/// What is searched, and how far its frame can be trusted.
struct Subject {
  chest::WorkingImage image;
  Volume<float> coarse;
  chest::Thorax thorax;
  double bright_hu = 0;
  std::size_t ventricle_choice = 0;  ///< 0: what looks most like a left ventricle
  bool slanted = false;              ///< by the header
};

Scene set_scene(const Subject& subject, const chest::Spine& spine) {
  const Mask chest = refined(subject.thorax.chest, subject.image.hu.grid);
  const auto box = bounding_box(chest, 0, [](std::uint8_t set) { return set != 0; });
  Scene scene{crop(subject.image, box), crop(chest, box), spine, {}, subject.ventricle_choice};
  scene.contrast = measure_contrast(scene.image, scene.region, spine, subject.bright_hu);
  scene.region = without_spine(scene.region, spine);
  return scene;
}

SearchResult landmarks_of(const Subject& subject, const Scene& scene, Chambers chambers) {
  SearchResult result;
  FoundLandmarks& found = result.found;
  if (const auto trachea = chest::find_trachea(subject.image.hu, scene.spine))
    found.landmarks.seeds_mm["trachea"] = *trachea;
  const auto valves = find_valves(chambers.labels, chambers.image, chambers.axis, chambers.right);
  refuse_upside_down(valves);
  keep_main_pieces(chambers.labels);
  add_seeds(chambers.labels, found);
  found.ventricles_cut_cm2 = ventricles_cut_cm2(chambers.labels);
  constexpr double margin_mm = 2;  // voxels of both pools beside the orifice
  for (const auto& [name, valve] : valves)
    found.landmarks.valves[name] = {valve.centre_mm, valve.normal, 0.5 * valve.diameter_mm + margin_mm};
  found.landmarks.lv_apex_mm = chambers.axis.apex_mm;
  found.long_axis = chambers.axis.direction;
  check_anatomy({chambers.labels, valves, chambers.axis, found.volumes_ml,
                 look_at_left_wall(chambers.labels, chambers.image.smooth), chambers.ventricle_certainty,
                 chambers.left_of_spine_mm,
                 chambers.right.faint ? std::optional(chambers.right.faint->contrast) : std::nullopt, subject.slanted},
                found);
  result.chambers = chambers.labels;
  return result;
}

SearchResult search_in(const Subject& subject, const Scene& scene) {
  return landmarks_of(subject, scene, find_chambers(scene));
}

/// A field of view that ends in the lungs may not hold the spine, and what was taken for it may be an atrium.
SearchResult search_in(const Subject& subject) {
  constexpr double surely_unlike = 0.25, surely_like = 0.15;
  const chest::Thorax& thorax = subject.thorax;
  if (!thorax.back_is_cut) return search_in(subject, set_scene(subject, thorax.spine));
  const Scene scene = set_scene(subject, chest::spine_behind(subject.coarse.grid));
  const double unlike = chest::share_unlike_spine(thorax.spine, subject.coarse, thorax.lung, scene.contrast.blood_hu);
  if (unlike > surely_unlike) return search_in(subject, scene);
  chest::Spine spine = thorax.spine;
  spine.is_sure = unlike < surely_like;
  return search_in(subject, set_scene(subject, spine));
}

/// Midway between enhanced muscle and the left heart's blood.
double midway_hu(const Subject& subject) {
  constexpr double enhanced_muscle_hu = 110;
  return 0.5 * (enhanced_muscle_hu + set_scene(subject, subject.thorax.spine).contrast.blood_hu);
}

/// Nothing where the labelling is not sure of all its names.
std::optional<naming::Naming> sure_names(const CtVolume& ct) {
  try {
    auto named = naming::name_blood(ct);
    if (named.verdict == naming::Verdict::found && is_bright(named)) return named;
  } catch (const UserError&) {  // the search's own refusal tells more
  }
  return std::nullopt;
}

/// What the names say of a result: where both give other names, the one that looks more like a heart counts. Where they
/// differ in how far a chamber reaches the first stays, whose valves are the better ones. What is disputed is not sure.
void ask_for_names(const Subject& subject, const CtVolume& ct, double plausible, std::optional<SearchResult>& best) {
  constexpr double disputed_keeps = 0.6;
  const auto named = sure_names(ct);
  if (!named) return;
  const auto disputed = best ? disputes(best->chambers, *named) : Disputes{};
  if (best && best->found.confidence >= plausible && !disputed.any()) return;
  try {
    const Scene scene = set_scene(subject, named->spine);
    auto by_name = landmarks_of(subject, scene, chambers_by_name(scene, *named));
    const bool may_replace = !best || best->found.confidence < plausible || !disputed.names.empty();
    if (may_replace && (!best || by_name.found.confidence >= best->found.confidence)) {
      best = std::move(by_name);
      return;
    }
  } catch (const UserError&) {  // the first result, or its refusal, tells more
  }
  if (!best || !disputed.any()) return;
  best->found.confidence *= disputed_keeps;
  for (const auto* sentences : {&disputed.names, &disputed.extents})
    best->found.warnings.insert(best->found.warnings.end(), sentences->begin(), sentences->end());
}

/// The whole image's threshold is low where its bone or contrast is: muscle then joins the chambers, and something else
/// is taken for the left ventricle. So is a right ventricle with the thicker wall. What does not look like a heart is
/// therefore searched for again, with a threshold between muscle and blood and from the next best ventricle, and the
/// most plausible result counts.
SearchResult search_until_plausible(Subject& subject, const CtVolume& ct) {
  constexpr double plausible = 0.4;  // a right heart as grey as muscle and a valve hidden in noise leave .42
  std::optional<SearchResult> best;
  std::exception_ptr refused;
  const auto attempt = [&] {
    SearchResult result = search_in(subject);
    if (!best || result.found.confidence > best->found.confidence) best = std::move(result);
  };
  try {
    attempt();
  } catch (const NotAHeart&) {
    refused = std::current_exception();
  }
  const double whole_image_hu = subject.bright_hu;
  const auto attempt_again = [&](bool midway, std::size_t ventricle_choice) {
    if (best && best->found.confidence >= plausible) return;
    try {
      subject.bright_hu = midway ? midway_hu(subject) : whole_image_hu;
      subject.ventricle_choice = ventricle_choice;
      attempt();
    } catch (const UserError&) {  // the first result, or its refusal, tells more
    }
  };
  attempt_again(true, 0);
  if (best) {  // mirrored images are refused, whatever else might do for a ventricle
    attempt_again(false, 1);
    attempt_again(true, 1);
  }
  ask_for_names(subject, ct, plausible, best);
  if (!best) std::rethrow_exception(refused);
  return std::move(*best);
}

Subject make_subject(const CtVolume& ct) {
  anatomy::require_hounsfield(ct);
  Subject subject;
  subject.image = chest::make_working_image(ct);
  subject.coarse = chest::thinned(subject.image.smooth, coarse_step);
  subject.thorax = chest::find_thorax(subject.coarse);
  subject.bright_hu = bright_threshold(subject.coarse);
  return subject;
}

/// By how much the header turns the image, as a sentence's begin.
std::string slant_remark(double slant_deg) {
  return fmt::format("the header turns the image by {:.0f} degrees against the body's axes", slant_deg);
}

constexpr const char* by_hand = "give the seeds lv_blood, la_blood, rv_blood, ra_blood and the valve planes by hand";

}  // namespace

// A slanted header or a small field of view may be true, and may be the mistake behind whatever does not look like a
// heart.
SearchResult search(const CtVolume& ct) {
  constexpr double min_slant_deg = 10;  // patients lie as crooked as that
  const double slant = slant_deg(ct.grid.direction);
  const bool slanted = slant >= min_slant_deg;
  bool back_is_cut = false;
  try {
    Subject subject = make_subject(ct);
    subject.slanted = slanted;
    back_is_cut = subject.thorax.back_is_cut;
    auto result = search_until_plausible(subject, ct);
    auto& warnings = result.found.warnings;
    if (slanted && !warnings.empty())
      warnings.insert(warnings.begin(), slant_remark(slant) + ": is that true of the patient?");
    return result;
  } catch (const NotAHeart& error) {
    throw UserError(error.problem, error.where,
                    fmt::format("{}, or {}",
                                slanted       ? slant_remark(slant) + ": check that first"
                                : back_is_cut ? "the field of view ends in the lungs, before the back: use a larger one"
                                              : error.suspicion,
                                by_hand));
  } catch (const UserError& error) {
    if (!slanted) throw;
    throw UserError(error.problem, error.where, slant_remark(slant) + ": check that first; else " + error.remedy);
  }
}

FoundLandmarks find_landmarks(const CtVolume& ct) { return search(ct).found; }

}  // namespace heartgen::landmarks
