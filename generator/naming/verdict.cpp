// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/naming/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

namespace heartgen::naming {
namespace {

// Limits: set on three real CTs; `heartgen-lab naming` counts what is right on either side.
constexpr double min_margin = 3, min_vessel_margin = 1.5;
constexpr double like_mirrored = 6;   // a mirrored image that costs so little more
constexpr double max_border_cm2 = 3;  // of a chamber's blood on the image's border

constexpr std::array<Name, 5> needed = {Name::lv, Name::la, Name::aorta, Name::rv, Name::ra};
constexpr std::array<Name, 4> chambers = {Name::lv, Name::la, Name::rv, Name::ra};
constexpr std::array<std::string_view, 6> sides = {"right", "left", "front", "back", "bottom", "top"};

/// A term of the cost with what it says when it is larger than usual.
struct Limit {
  double Terms::*term;
  double usual;
  std::string_view says;
};
constexpr std::array<Limit, 6> limits = {{
    {&Terms::place, 9, "the chambers do not lie to each other as in a heart"},
    {&Terms::shell, 3, "little muscle is around the left ventricle"},
    {&Terms::stream, 7, "grey values differ along the stream of the blood"},
    {&Terms::volume, 12, "the volumes of the chambers do not go together"},
    {&Terms::touch, 9, "chambers open into each other that never do"},
    {&Terms::opening, 7, "chambers do not open into each other that must"},
}};

struct Reasons {
  std::vector<std::string> against, doubts;
};

/// The side of the image beyond which, or at whose very border, a name is expected.
std::optional<std::size_t> side_beyond(const Labelling& labelling, Name name) {
  const Vec3 expected = labelling.expected_mm(name), reach = usual_of(name).deviation_mm;
  const Problem& problem = labelling.problem();
  std::optional<std::size_t> side;
  double farthest = 0;
  for (int a = 0; a < 3; ++a) {
    const double below = (problem.view_from_mm[a] - expected[a]) / reach[a] + 1;
    const double above = (expected[a] - problem.view_to_mm[a]) / reach[a] + 1;
    if (below > farthest) farthest = below, side = static_cast<std::size_t>(2 * a);
    if (above > farthest) farthest = above, side = static_cast<std::size_t>(2 * a + 1);
  }
  return side;
}

void judge_field_of_view(const Labelling& labelling, Reasons& reasons) {
  for (const Name name : chambers)
    for (int side = 0; side < 6; ++side)
      if (const double cm2 = labelling.border_cm2(name, side); labelling.holds(name) && cm2 > max_border_cm2)
        reasons.against.push_back(fmt::format("the field of view cuts {} at the {} ({:.0f} cm2)", usual_of(name).word,
                                              sides[static_cast<std::size_t>(side)], cm2));
}

void judge_missing(const Labelling& labelling, Reasons& reasons) {
  const bool right_is_grey = !labelling.holds_right_heart();
  if (right_is_grey)
    reasons.doubts.emplace_back("the right heart's blood is hardly brighter than muscle: no part of it was found");
  for (const Name name : {Name::lv, Name::la, Name::aorta, Name::rv, Name::ra, Name::pulmonary_artery}) {
    const bool is_right = std::find(right_heart.begin(), right_heart.end(), name) != right_heart.end();
    if (labelling.holds(name) || (is_right && right_is_grey)) continue;
    auto& list = name == Name::pulmonary_artery ? reasons.doubts : reasons.against;
    const auto side = labelling.holds(Name::lv) ? side_beyond(labelling, name) : std::nullopt;
    list.push_back(
        side ? fmt::format("{} is not in view: the image ends too early at the {}", usual_of(name).word, sides[*side])
             : fmt::format("{} was not found", usual_of(name).word));
  }
}

void judge_margins(const Labelling& labelling, const Naming& naming, Reasons& reasons) {
  const auto unsure = [&](Name name, double least) {
    const Margin& margin = naming[name].margin;
    if (!labelling.holds(name) || margin.cost >= least) return;
    auto& list = name == Name::lv ? reasons.against : reasons.doubts;
    list.push_back(fmt::format("{} could be {} (margin {:.1f})", usual_of(name).word, usual_of(margin.runner_up).word,
                               margin.cost));
  };
  for (const Name name : needed) unsure(name, min_margin);
  unsure(Name::pulmonary_artery, min_vessel_margin);
}

void judge_terms(const Terms& terms, Reasons& reasons) {
  for (const auto& [term, most, says] : limits)
    if (const double cost = terms.*term; cost > most)
      (cost > 2 * most ? reasons.against : reasons.doubts)
          .push_back(fmt::format("{} (cost {:.0f}, usual below {:.0f})", says, cost, most));
}

void judge_sides(const Naming& naming, Reasons& reasons) {
  const double energy = naming.terms.sum();
  if (naming.mirrored_energy < energy)
    reasons.against.insert(reasons.against.begin(),
                           fmt::format("left and right are exchanged: the mirrored image fits better (cost {:.0f}, not "
                                       "{:.0f})",
                                       naming.mirrored_energy, energy));
  else if (naming.mirrored_energy < energy + like_mirrored)
    reasons.doubts.push_back("the mirrored image fits nearly as well");
}

}  // namespace

void judge(const Labelling& labelling, Naming& naming) {
  Reasons reasons;
  judge_field_of_view(labelling, reasons);
  judge_missing(labelling, reasons);
  judge_margins(labelling, naming, reasons);
  judge_terms(naming.terms, reasons);
  judge_sides(naming, reasons);
  naming.verdict = !reasons.against.empty()  ? Verdict::no_heart
                   : !reasons.doubts.empty() ? Verdict::doubtful
                                             : Verdict::found;
  naming.reasons = std::move(reasons.against);
  naming.reasons.insert(naming.reasons.end(), reasons.doubts.begin(), reasons.doubts.end());
}

}  // namespace heartgen::naming
