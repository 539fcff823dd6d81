// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/criteria.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "model/certificate.hpp"
#include "validation/uses.hpp"

namespace heartgen::validation {
namespace {

ReportRow row(const char* group, const char* scope, const char* metric, double value) {
  return {group, scope, metric, value, "1", {}, {}};
}

Verdict verdict_on(const char* group, const char* scope, const char* metric, double value,
                   const ValidationSettings& settings = {}) {
  return judged({row(group, scope, metric, value)}, settings).front().verdict();
}

TEST(Criteria, EveryOneHasAReasonAndOrderedBounds) {
  for (const auto& criterion : criteria({})) {
    const auto name = criterion.group + " " + criterion.scope + " " + criterion.metric;
    EXPECT_TRUE(criterion.reason.ends_with(".")) << name;
    const auto& b = criterion.bounds;
    constexpr double none = std::numeric_limits<double>::infinity();
    EXPECT_LE(b.fail_below.value_or(-none), b.warn_below.value_or(none)) << name;
    EXPECT_LE(b.warn_above.value_or(-none), b.fail_above.value_or(none)) << name;
    EXPECT_LT(b.warn_below.value_or(-none), b.warn_above.value_or(none)) << name;
  }
}

TEST(Criteria, JudgeByScopeAndMetric) {
  EXPECT_EQ(verdict_on("labels", "lv_blood", "volume", 20), Verdict::failed);
  EXPECT_EQ(verdict_on("labels", "lv_blood", "volume", 24), Verdict::warned);
  EXPECT_EQ(verdict_on("labels", "lv_blood", "volume", 120), Verdict::passed);
  EXPECT_EQ(verdict_on("labels", "lung", "volume", 20), Verdict::told);
  EXPECT_EQ(verdict_on("mesh", "torso/lv_blood", "volume_difference", -7), Verdict::failed);
  EXPECT_EQ(verdict_on("mesh", "torso/bone", "volume_difference", -7), Verdict::told);
  EXPECT_EQ(verdict_on("mesh", "myocardium", "boundary_non_manifold_edges", 1), Verdict::failed);
  EXPECT_EQ(verdict_on("mesh", "myocardium/la_wall", "boundary_non_manifold_edges", 1), Verdict::told);
  EXPECT_EQ(verdict_on("mesh", "torso/lv_blood", "to_level_set_p99", 9), Verdict::told);
}

TEST(Criteria, TheRecipesBoundsCount) {
  EXPECT_EQ(verdict_on("mesh", "myocardium", "dihedral_min", 10), Verdict::passed);
  ValidationSettings settings;
  settings.minimum_dihedral_deg = 25;
  EXPECT_EQ(verdict_on("mesh", "myocardium", "dihedral_min", 10, settings), Verdict::failed);
  settings.maximum_inpainted_fraction = 0.2;
  EXPECT_EQ(verdict_on("fibers", "ventricles", "inpainted_fraction", 0.25, settings), Verdict::failed);
}

TEST(Criteria, AnUnknownRowStaysAsItIs) {
  const auto rows = judged({row("other", "x", "y", 1)}, {});
  EXPECT_TRUE(rows.front().reason.empty());
  EXPECT_EQ(rows.front().verdict(), Verdict::told);
}

UseVerdict verdict_of_use(const std::vector<UseVerdict>& uses, const std::string& name) {
  const auto found = std::ranges::find(uses, name, &UseVerdict::use);
  return found == uses.end() ? UseVerdict{} : *found;
}

std::vector<UseVerdict> uses_at(double edge_mm, const std::vector<std::string>& asked = {}) {
  return judge_uses(judged({row("mesh", "myocardium", "edge_mean", edge_mm)}, {}), {}, {"myocardium"}, asked);
}

TEST(Uses, AskForEdgesShortEnough) {
  EXPECT_EQ(verdict_of_use(uses_at(1.4), "eikonal").fitness, Fitness::fit);
  EXPECT_EQ(verdict_of_use(uses_at(2), "eikonal").fitness, Fitness::fit_with_warnings);
  EXPECT_EQ(verdict_of_use(uses_at(5), "eikonal").fitness, Fitness::unfit);
  EXPECT_NE(verdict_of_use(uses_at(5), "eikonal").remedy.find("heart_edge_mm"), std::string::npos);
  EXPECT_FALSE(verdict_of_use(uses_at(5), "eikonal").is_asked) << "the recipe chose its edges";
}

TEST(Uses, FinerOnesAreAskedForByTheRecipeAlone) {
  EXPECT_EQ(verdict_of_use(uses_at(1.4), "monodomain").fitness, Fitness::unfit);
  EXPECT_FALSE(verdict_of_use(uses_at(1.4), "monodomain").is_asked);
  EXPECT_TRUE(verdict_of_use(uses_at(1.4, {"monodomain"}), "monodomain").is_asked);
  EXPECT_TRUE(verdict_of_use(uses_at(0.3), "monodomain").is_asked);
  EXPECT_EQ(verdict_of(Certificate{{}, {}, uses_at(1.4, {"monodomain"})}), Verdict::failed);
}

TEST(Uses, EdgesTooLongForTheUsualOnesAreNeverSilent) {
  const Report rows = {row("mesh", "myocardium", "edge_mean", 5)};
  auto certificate = certified(rows, {}, {"myocardium"}, {});
  ASSERT_EQ(certificate.warnings.size(), 1u);
  EXPECT_EQ(certificate.warnings[0].code, "uses.eikonal");
  EXPECT_EQ(verdict_of(certificate), Verdict::warned);
  certificate = certified(rows, certificate.warnings, {"myocardium"}, {});
  EXPECT_EQ(certificate.warnings.size(), 1u) << "judged again, it is said once";
  ValidationSettings asked;
  asked.uses = {"eikonal"};
  certificate = certified(rows, {}, {"myocardium"}, asked);
  EXPECT_TRUE(certificate.warnings.empty());
  EXPECT_EQ(verdict_of(certificate), Verdict::failed);
}

TEST(Uses, AMeshThatIsMissingMakesUnfitOnlyWhereAsked) {
  EXPECT_TRUE(verdict_of_use(uses_at(1), "ecg").use.empty());
  const auto ecg = verdict_of_use(uses_at(1, {"ecg"}), "ecg");
  EXPECT_EQ(ecg.fitness, Fitness::unfit);
  EXPECT_TRUE(ecg.is_asked);
}

TEST(Uses, AFailedRowAndADoubtMakeUnfit) {
  const auto rows = judged({row("mesh", "myocardium/lv_myocardium", "inverted_cells", 1)}, {});
  const auto uses = judge_uses(rows, {}, {"chambers", "myocardium"}, {});
  EXPECT_EQ(verdict_of_use(uses, "mechanics").fitness, Fitness::unfit);
  EXPECT_EQ(verdict_of_use(uses, "blood_flow").fitness, Fitness::fit) << "its mesh is another one";
  for (const auto& use : judge_uses({}, {{"landmarks.doubtful", WarningLevel::doubt, "No heart."}}, {"myocardium"}, {}))
    EXPECT_EQ(use.fitness, Fitness::unfit) << use.use;
}

TEST(Verdicts, ADoubtIsNeverGreen) {
  const Report fine = judged({row("labels", "lv_blood", "volume", 120)}, {});
  EXPECT_EQ(verdict_of(Certificate{fine, {}, {}}), Verdict::passed);
  EXPECT_EQ(verdict_of(Certificate{fine, {{"a", WarningLevel::note, ""}}, {}}), Verdict::passed);
  EXPECT_EQ(verdict_of(Certificate{fine, {{"a", WarningLevel::warning, ""}}, {}}), Verdict::warned);
  EXPECT_EQ(verdict_of(Certificate{fine, {{"a", WarningLevel::doubt, ""}}, {}}), Verdict::failed);
}

}  // namespace
}  // namespace heartgen::validation
