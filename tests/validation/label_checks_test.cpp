// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/label_checks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "model/labels.hpp"
#include "support/synthetic_heart.hpp"
#include "validation/report/report_tables.hpp"

namespace heartgen::validation {
namespace {

/// A shell of `wall_mm` around a ball of blood of 15 mm, on a grid of 1 mm.
LabelVolume shell(double wall_mm) {
  Grid grid;
  grid.size = {61, 61, 61};
  LabelVolume labels(grid);
  for (std::int64_t k = 0; k < 61; ++k)
    for (std::int64_t j = 0; j < 61; ++j)
      for (std::int64_t i = 0; i < 61; ++i) {
        const double r = norm(Vec3{double(i), double(j), double(k)} - Vec3{30, 30, 30});
        labels(i, j, k) = r < 15 ? tag(Region::lv_blood) : r < 15 + wall_mm ? tag(Region::lv_myocardium) : 0;
      }
  return labels;
}

double value(const Report& report, const char* scope, const char* metric) {
  return report::row_value(report, "labels", scope, metric).value();
}

TEST(LabelChecks, VolumeOfABall) {
  const Report report = check_labels(shell(8), {});
  EXPECT_NEAR(value(report, "lv_blood", "volume"), 4.0 / 3 * 3.14159265 * 15 * 15 * 15 / 1000, 0.2);
  EXPECT_EQ(value(report, "lv_blood", "components"), 1);
  EXPECT_EQ(value(report, "lv_blood", "largest_component"), 1);
}

TEST(LabelChecks, ThicknessOfAShell) {
  for (const double wall : {4.0, 8.0, 12.0})
    EXPECT_NEAR(value(check_labels(shell(wall), {}), "lv_myocardium", "wall_thickness_median"), wall, 0.6) << wall;
}

TEST(LabelChecks, CountsComponentsByCorners) {
  Grid grid;
  grid.size = {10, 10, 10};
  LabelVolume labels(grid);
  labels(1, 1, 1) = labels(2, 2, 2) = labels(2, 2, 3) = tag(Region::aorta);  // joined by a corner
  labels(8, 8, 8) = tag(Region::aorta);
  const Report report = check_labels(labels, {});
  EXPECT_EQ(value(report, "aorta", "components"), 2);
  EXPECT_EQ(value(report, "aorta", "largest_component"), 0.75);
}

/// Components of a label by the slow clear way: every voxel takes the least number around it until nothing changes.
std::pair<std::size_t, double> components_by_spreading(const LabelVolume& labels, std::uint8_t label) {
  const Grid& grid = labels.grid;
  std::vector<std::int64_t> number(labels.voxels.size());
  std::iota(number.begin(), number.end(), 0);
  const auto min_around = [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    auto least = number[static_cast<std::size_t>(grid.offset(i, j, k))];
    for (auto z = k - 1; z <= k + 1; ++z)
      for (auto y = j - 1; y <= j + 1; ++y)
        for (auto x = i - 1; x <= i + 1; ++x)
          if (grid.contains(x, y, z) && labels(x, y, z) == label)
            least = std::min(least, number[static_cast<std::size_t>(grid.offset(x, y, z))]);
    return least;
  };
  std::map<std::int64_t, double> size;
  for (bool changed = true; changed;) {
    changed = false;
    size.clear();
    for (std::int64_t k = 0; k < grid.size[2]; ++k)
      for (std::int64_t j = 0; j < grid.size[1]; ++j)
        for (std::int64_t i = 0; i < grid.size[0]; ++i) {
          if (labels(i, j, k) != label) continue;
          auto& own = number[static_cast<std::size_t>(grid.offset(i, j, k))];
          const auto least = min_around(i, j, k);
          changed = changed || least != own;
          own = least;
          ++size[own];
        }
  }
  double total = 0, largest = 0;
  for (const auto& [first, count] : size) total += count, largest = std::max(largest, count);
  return {size.size(), largest / total};
}

TEST(LabelChecks, ComponentsAreThoseOfASlowSearch) {
  std::mt19937 random(3);
  Grid grid;
  grid.size = {13, 9, 11};
  for (const unsigned others : {2U, 4U, 7U}) {
    LabelVolume labels(grid);
    for (auto& voxel : labels.voxels) voxel = static_cast<std::uint8_t>(random() % others + 1);
    const Report report = check_labels(labels, {});
    for (std::uint8_t label = 1; label <= others; ++label) {
      const auto [count, largest] = components_by_spreading(labels, label);
      EXPECT_EQ(value(report, region_name(label).c_str(), "components"), static_cast<double>(count));
      EXPECT_DOUBLE_EQ(value(report, region_name(label).c_str(), "largest_component"), largest);
    }
  }
}

TEST(LabelChecks, AnEmptyRegionThatIsNeededFails) {
  const Report empty = check_labels(shell(8), {Region::lv_blood, Region::ra_blood});
  const auto volume = std::ranges::find_if(
      empty, [](const ReportRow& row) { return row.scope == "ra_blood" && row.metric == "volume"; });
  ASSERT_NE(volume, empty.end());
  EXPECT_EQ(volume->value, 0);
  EXPECT_EQ(volume->verdict(), Verdict::failed);
}

}  // namespace
}  // namespace heartgen::validation
