// SPDX-License-Identifier: GPL-3.0-or-later
// What the studies find and how it is written down.
#include "benchmarks/study/study.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "benchmarks/study/convergence.hpp"
#include "benchmarks/study/studies.hpp"
#include "support/data.hpp"

namespace heartgen::study {
namespace {

TEST(Study, LengthsReportThePrintedTable) {
  StudySettings quick;
  quick.quick = true;
  const StudyResult study = study_lengths(quick);
  ASSERT_EQ(study.tables.size(), 4u);
  EXPECT_EQ(study.tables[0].rows[0][3], "722.2914139");
  ASSERT_EQ(study.plots.size(), 3u);
  EXPECT_EQ(study.plots[0].curves.size(), 4u);
  for (const auto& curve : study.plots[0].curves) EXPECT_GT(curve.y[2], 10) << curve.name;  // the Heaviside length
  EXPECT_EQ(study.plots[1].curves.size(), 5u);
  // All but the first: the printed digits belong to a shape that the thesis does not describe.
  for (std::size_t n = 1; n < study.claims.size(); ++n) EXPECT_TRUE(study.claims[n].holds) << study.claims[n].statement;
}

TEST(Study, ThePrintedHeavisideLengthIsA198PixelDisc) {
  EXPECT_NEAR(792 - (2 - std::sqrt(2.0)) * 119, 722.2914139, 5e-8);
}

// So small an image has other orders than the thesis's, but the start must matter here too.
TEST(Study, TheMethodsAreComparedFromEveryStart) {
  StudySettings quick;
  quick.quick = true;
  const StudyResult study = study_discretisations(quick);
  ASSERT_EQ(study.tables.size(), 2u);
  EXPECT_EQ(study.tables[0].rows.size(), 8u) << "seven methods and the convex solver";
  const auto& starts = study.tables[1].rows;
  ASSERT_EQ(starts.size(), 5u) << "the thesis and four starts";
  EXPECT_NE(starts[1][1], starts[4][1]) << "from the two classes and from one circle";
  EXPECT_EQ(study.plots[0].curves.size(), 7u);
  for (const auto& curve : study.plots[0].curves)
    EXPECT_GT(curve.y.front(), 2000) << curve.name << ": 100 circles are far from the minimum";
}

TEST(Study, SettledIsForGood) {
  const Curve curve{"", {1, 2, 3, 4, 5}, {9, 2, 7, 3, 1}};
  EXPECT_EQ(settled_within(curve, 3), 4);
  EXPECT_EQ(settled_within(curve, 10), 1);
  EXPECT_EQ(settled_within(curve, 0.5), -1);
}

TEST(Study, TablesKeepTheirCells) {
  const Table table{"t", "Title", {"a", "b"}, {{"1, \"x\"", "|y|"}}};
  EXPECT_EQ(csv(table), "a,b\n\"1, \"\"x\"\"\",|y|\n");
  EXPECT_EQ(markdown(table), "Title\n\n| a | b |\n| --- | --- |\n| 1, \"x\" | \\|y\\| |\n");
}

TEST(Study, PlotsAreDrawnInsideTheirFrame) {
  const Plot plot{"p", "a < b", "x", "y", true, true, {{"c", {1, 10, 100}, {0, 5, 50}}}};
  const std::string drawn = svg(plot);
  EXPECT_NE(drawn.find("a &lt; b"), std::string::npos);
  EXPECT_EQ(drawn.find("nan"), std::string::npos);
  EXPECT_EQ(drawn.find("inf"), std::string::npos);
  EXPECT_EQ(drawn, svg(plot));
}

TEST(Study, WritesOnePageAndItsParts) {
  const auto folder = testing::scratch_folder("study");
  std::filesystem::remove_all(folder);
  StudyResult study{"s",
                    "Title",
                    "setup",
                    {{"t", "T", {"a"}, {{"1"}}}},
                    {{"p", "P", "x", "y", false, false, {{"c", {0, 1}, {1, 2}}}}},
                    {},
                    {{"5.1", "statement", true, "measured"}}};
  study.pictures.push_back({"i", "caption", grey_picture(Field(4, 3, 2), 2)});
  write_studies(folder, {study});
  for (const char* name : {"s-t.csv", "s-t.md", "s-claims.csv", "s-p.svg", "s-i.png", "index.html"})
    EXPECT_TRUE(std::filesystem::exists(folder / name)) << name;
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace heartgen::study
