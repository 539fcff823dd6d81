// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/landmarks/anatomy_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "generator/image/statistics.hpp"
#include "generator/landmarks/judge.hpp"

namespace heartgen::landmarks {
namespace {

// What a contradiction leaves of the confidence: a size out of range may be a rare heart, a wrong order of the
// chambers means that something was taken for something else.
constexpr double minor = 0.85, severe = 0.5;

struct Report {
  FoundLandmarks& found;

  void warn(double keeps, std::string sentence) {
    found.confidence *= keeps;
    found.warnings.push_back(std::move(sentence));
  }
};

struct Range {
  const char* name;
  double low, high;
};

// Adults, any phase of the beat, dilated hearts included; vessels as far as they lie near the heart.
constexpr Range volume_ranges_ml[] = {{"lv_blood", 40, 300}, {"la_blood", 25, 250}, {"rv_blood", 40, 350},
                                      {"ra_blood", 30, 350}, {"aorta", 30, 400},    {"pulmonary_artery", 12, 200}};
constexpr Range diameter_ranges_mm[] = {
    {"mitral", 18, 48}, {"aortic", 12, 35}, {"tricuspid", 20, 52}, {"pulmonary", 14, 38}};

bool has_right_heart(const Findings& findings) { return findings.volumes_ml.at("rv_blood") > 0; }

bool is_of_right_heart(const std::string& name) {
  return name == "rv_blood" || name == "ra_blood" || name == "pulmonary_artery" || name == "tricuspid" ||
         name == "pulmonary";
}

/// A vessel that the field of view cuts may be any short.
bool is_cut_vessel(const LabelVolume& chambers, const std::string& name) {
  const auto region = region_from_name(name);
  if (region != Region::aorta && region != Region::pulmonary_artery) return false;
  const auto& size = chambers.grid.size;
  std::size_t v = 0;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i, ++v)
        if (chambers.voxels[v] == tag(*region) &&
            (i == 0 || j == 0 || k == 0 || i + 1 == size[0] || j + 1 == size[1] || k + 1 == size[2]))
          return true;
  return false;
}

void check_volumes(const Findings& findings, Report& report) {
  if (!has_right_heart(findings))
    report.warn(missing_half_keeps,
                "the right heart is not clearly brighter than muscle: give the seeds rv_blood, ra_blood and "
                "pulmonary_artery and the tricuspid and pulmonary valve planes by hand");
  for (const Range& range : volume_ranges_ml) {
    if (!has_right_heart(findings) && is_of_right_heart(range.name)) continue;
    const auto at = findings.volumes_ml.find(range.name);
    if (at == findings.volumes_ml.end() || at->second == 0)
      report.warn(missing_keeps, fmt::format("{} was not found: give its seed by hand", range.name));
    else if (at->second > range.high || (at->second < range.low && !is_cut_vessel(findings.chambers, range.name)))
      report.warn(minor, fmt::format("{} holds {:.0f} ml, expected {:.0f} to {:.0f}", range.name, at->second, range.low,
                                     range.high));
  }
}

/// A pool that swallowed a part of another, or lost one to it, may still have a volume that hearts have.
void check_ratios(const Findings& findings, Report& report) {
  struct Ratio {
    const char *one, *other;
    double low, high;
  };
  // Of the volumes of healthy adults 0.9 to 1.3, 0.4 to 1.1 and 0.4 to 1.1; the rest is for diseases and phases.
  constexpr Ratio ratios[] = {
      {"rv_blood", "lv_blood", 0.45, 3}, {"ra_blood", "rv_blood", 0.2, 2}, {"la_blood", "lv_blood", 0.2, 2.5}};
  for (const auto& [one, other, low, high] : ratios) {
    const double above = findings.volumes_ml.at(one), below = findings.volumes_ml.at(other);
    if (above == 0 || below == 0 || (above > low * below && above < high * below)) continue;
    report.warn(severe, fmt::format("{} holds {:.2g} times as much as {}, expected {:g} to {:g}", one, above / below,
                                    other, low, high));
  }
}

/// The left ventricle's wall is muscle; a vertebra's is bone.
void check_left_wall(const Findings& findings, Report& report) {
  constexpr double max_bone = 0.03, bone_keeps = 0.2, min_muscle = 0.45;
  if (findings.left_wall.bone > max_bone)
    report.warn(bone_keeps, fmt::format("{:.0f} % of what lies around the left ventricle is as bright as bone",
                                        100 * findings.left_wall.bone));
  if (findings.left_wall.muscle < min_muscle)
    report.warn(severe, fmt::format("only {:.0f} % of what lies around the left ventricle is as grey as muscle",
                                    100 * findings.left_wall.muscle));
}

void check_field_of_view(const FoundLandmarks& found, Report& report) {
  constexpr double max_cm2 = 3;  // the tip
  if (found.ventricles_cut_cm2 > max_cm2)
    report.warn(severe, fmt::format("the field of view cuts the ventricles, over {:.0f} cm2: use a scan that shows the "
                                    "whole heart",
                                    found.ventricles_cut_cm2));
}

/// With this little contrast usual anatomy decides as much as the image does.
void check_contrast(const Findings& findings, Report& report) {
  constexpr double hardly_any_hu = 10;
  if (!findings.faint || !has_right_heart(findings)) return;
  const double hu = findings.faint->difference_hu();
  const char* side = hu < 0 ? "darker" : "brighter";
  if (std::abs(hu) < hardly_any_hu)
    report.warn(severe,
                fmt::format("the right heart's blood is only {:.0f} HU {} than muscle: its contours follow "
                            "usual wall thicknesses; check them, or use a scan with contrast in the right heart",
                            std::abs(hu), side));
  else
    report.warn(minor, fmt::format("the right heart's blood is only {:.0f} HU {} than muscle: check its contours and "
                                   "the tricuspid valve",
                                   std::abs(hu), side));
}

void check_valve_shapes(const Findings& findings, Report& report) {
  constexpr double max_uneven_mm = 3.5, min_share = 0.8;
  for (const Range& range : diameter_ranges_mm) {
    if (!has_right_heart(findings) && is_of_right_heart(range.name)) continue;
    const auto at = findings.valves.find(range.name);
    if (at == findings.valves.end()) {
      report.warn(missing_keeps, fmt::format("the {} valve was not found: give its plane by hand", range.name));
      continue;
    }
    const ValvePatch& valve = at->second;
    if (valve.diameter_mm < range.low || valve.diameter_mm > range.high)
      report.warn(minor, fmt::format("the {} valve is {:.0f} mm wide, expected {:.0f} to {:.0f}", range.name,
                                     valve.diameter_mm, range.low, range.high));
    if (valve.uneven_mm > max_uneven_mm)
      report.warn(minor,
                  fmt::format("the {} valve is not flat ({:.1f} mm off its plane)", range.name, valve.uneven_mm));
    if (valve.hidden)
      report.warn(minor, fmt::format("noise hides the {} valve: its plane follows the shape of the heart and may be "
                                     "10 mm and 15 degrees off",
                                     range.name));
    if (valve.share < min_share) report.warn(minor, fmt::format("the {} valve is in pieces", range.name));
  }
}

void check_angles(const Findings& findings, Report& report) {
  constexpr double mitral_limit_deg = 40, tricuspid_limit_deg = 55, spread_limit_deg = 20;
  const auto off_axis = [&](const char* name) {
    const auto at = findings.valves.find(name);
    return at == findings.valves.end() ? 0 : image::angle_deg(at->second.normal, -findings.axis.direction);
  };
  if (off_axis("mitral") > mitral_limit_deg)
    report.warn(minor, fmt::format("the mitral valve is tilted by {:.0f} degrees", off_axis("mitral")));
  if (off_axis("tricuspid") > tricuspid_limit_deg)
    report.warn(minor, fmt::format("the tricuspid valve is tilted by {:.0f} degrees", off_axis("tricuspid")));
  if (findings.axis.spread_deg > spread_limit_deg)
    report.warn(minor,
                fmt::format("two estimates of the long axis differ by {:.0f} degrees", findings.axis.spread_deg));
}

/// Centres of the chambers that were found.
std::map<std::string, Vec3> centres_of(const LabelVolume& chambers) {
  std::map<std::string, std::pair<Vec3, double>> sums;
  std::vector<std::pair<Vec3, double>> by_tag(256);
  chest::for_each_voxel(chambers.grid, [&](const Vec3& p, std::size_t v) {
    auto& sum = by_tag[chambers.voxels[v]];
    sum.first += p;
    sum.second += 1;
  });
  std::map<std::string, Vec3> centres;
  for (std::size_t t = 1; t < by_tag.size(); ++t)
    if (by_tag[t].second > 0) centres[region_name(static_cast<int>(t))] = by_tag[t].first / by_tag[t].second;
  return centres;
}

/// The order of the chambers in the body. A mirrored image fails here.
void check_order(const Findings& findings, Report& report) {
  const char* mirrored = findings.slanted ? "" : "; is the image mirrored, or are chambers exchanged?";
  if (findings.left_of_spine_mm && *findings.left_of_spine_mm < 0)
    report.warn(minor,
                fmt::format("the heart lies {:.0f} mm right of the spine{}", -*findings.left_of_spine_mm, mirrored));
  const auto centres = centres_of(findings.chambers);
  const auto both = [&](const char* a, const char* b) { return centres.contains(a) && centres.contains(b); };
  if (both("lv_blood", "rv_blood") && centres.at("rv_blood").x > centres.at("lv_blood").x)
    report.warn(severe, fmt::format("the right ventricle lies left of the left one{}", mirrored));
  if (both("la_blood", "rv_blood") && centres.at("la_blood").y < centres.at("rv_blood").y)
    report.warn(severe, fmt::format("the left atrium lies in front of the right ventricle{}", mirrored));
  if (both("la_blood", "ra_blood") && centres.at("ra_blood").x > centres.at("la_blood").x)
    report.warn(severe, fmt::format("the right atrium lies left of the left one{}", mirrored));
}

void check_valve_places(const Findings& findings, Report& report) {
  const auto& valves = findings.valves;
  const auto both = [&](const char* a, const char* b) { return valves.contains(a) && valves.contains(b); };
  const auto height = [&](const char* name) { return valves.at(name).centre_mm.z; };
  const auto apart = [&](const char* a, const char* b) {
    return norm(valves.at(a).centre_mm - valves.at(b).centre_mm);
  };
  constexpr double height_slack_mm = 3;
  if (both("pulmonary", "aortic") && height("pulmonary") < height("aortic") - height_slack_mm)
    report.warn(severe, fmt::format("the pulmonary valve lies below the aortic one{}",
                                    findings.slanted ? "" : "; is the image mirrored?"));
  if (both("tricuspid", "pulmonary") && height("tricuspid") > height("pulmonary"))
    report.warn(severe, fmt::format("the tricuspid valve lies above the pulmonary one{}",
                                    findings.slanted ? "" : "; is the image upside down?"));
  if (both("mitral", "tricuspid") && (apart("mitral", "tricuspid") < 20 || apart("mitral", "tricuspid") > 75))
    report.warn(minor, fmt::format("mitral and tricuspid valve are {:.0f} mm apart", apart("mitral", "tricuspid")));
  if (both("mitral", "aortic") && (apart("mitral", "aortic") < 10 || apart("mitral", "aortic") > 40))
    report.warn(minor, fmt::format("mitral and aortic valve are {:.0f} mm apart", apart("mitral", "aortic")));
}

}  // namespace

void check_anatomy(const Findings& findings, FoundLandmarks& found) {
  constexpr double sure = 0.4;  // the second best left ventricle scores at most 60 % of the best
  found.confidence = 1;
  Report report{found};
  if (findings.ventricle_certainty < sure)
    report.warn(severe, fmt::format("another pool looks like a left ventricle too (certainty {:.2f})",
                                    findings.ventricle_certainty));
  check_field_of_view(found, report);
  check_contrast(findings, report);
  check_volumes(findings, report);
  check_ratios(findings, report);
  check_left_wall(findings, report);
  check_valve_shapes(findings, report);
  check_angles(findings, report);
  check_order(findings, report);
  check_valve_places(findings, report);
}

}  // namespace heartgen::landmarks
