// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/filters.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "generator/pde/diffusion.hpp"
#include "model/error.hpp"
#include "pde/pde_images.hpp"

namespace heartgen::pde {
namespace {

using testing::grid_of;
const auto alone = parallel::self();

std::string message_of(const std::string& name, const std::map<std::string, double>& parameters) {
  try {
    pde::apply_filter(name, testing::ball(grid_of({6, 6, 6}), 2), parameters, alone);
  } catch (const UserError& error) {
    return error.message;
  }
  return "";
}

TEST(Filters, AllRunWithTheirDefaultsInTwoAndThreeDimensions) {
  for (const Index3 size : {Index3{12, 11, 10}, Index3{12, 11, 1}, Index3{12, 1, 1}, Index3{1, 1, 1}})
    for (const auto& filter : pde::filters()) {
      SCOPED_TRACE(filter.name);
      auto image = testing::noisy(testing::ball(grid_of(size, {0.5, 0.5, 1.5}), 2), 0.3);
      image.voxels.front() = -1;
      image.voxels.back() = 1;  // of a single voxel: no zero level
      if (image.voxels.size() == 1 && (filter.name == "redistance" || filter.name == "reinitialise")) {
        EXPECT_THROW(pde::apply_filter(filter.name, image, {}, alone), UserError);
        continue;
      }
      const auto result = pde::apply_filter(filter.name, image, {}, alone);
      ASSERT_EQ(result.grid, image.grid);
      for (const float v : result.voxels) ASSERT_TRUE(std::isfinite(v));
      EXPECT_FALSE(filter.help.empty());
      for (const auto& parameter : filter.parameters) EXPECT_FALSE(parameter.help.empty());
    }
}

TEST(Filters, ResultsThatAreNotFiniteAreNoResults) {
  auto image = testing::ball(grid_of({6, 6, 6}), 2);
  for (auto& value : image.voxels) value *= 3e37F;
  try {
    pde::apply_filter("curvature", image, {}, alone);
    FAIL() << "infinity was handed on";
  } catch (const UserError& error) {
    EXPECT_NE(error.problem.find("e+37"), std::string::npos) << error.message;
  }
}

TEST(Filters, PassTheirParametersOn) {
  const auto image = testing::noisy(testing::ball(grid_of({12, 11, 10}), 3), 0.3);
  const auto result = pde::apply_filter("heat", image, {{"iterations", 3}, {"time_step", 0.05}}, alone);
  EXPECT_EQ(result.voxels, pde::heat(image, {3, 0.05}, alone).voxels);
}

TEST(Filters, NamesAreSorted) { EXPECT_TRUE(std::ranges::is_sorted(pde::filter_names())); }

TEST(Filters, NameTheNearestKnownNameAndParameter) {
  EXPECT_NE(message_of("perona_malk", {}).find("perona_malik"), std::string::npos);
  EXPECT_NE(message_of("heat", {{"iteration", 3}}).find("did you mean \"iterations\""), std::string::npos);
}

TEST(Filters, RefuseBadValuesAndImages) {
  EXPECT_NE(message_of("heat", {{"iterations", 2.5}}), "");
  EXPECT_NE(message_of("heat", {{"iterations", -1}}), "");
  EXPECT_NE(message_of("heat", {{"time_step", 5}}), "");
  EXPECT_NE(message_of("tv_l1", {{"lambda", std::nan("")}}), "");
  Volume<float> broken(grid_of({3, 3, 3}));
  broken(1, 1, 1) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(pde::apply_filter("heat", broken, {}, alone), UserError);
  EXPECT_THROW(pde::apply_filter("heat", {}, {}, alone), UserError);
}

}  // namespace
}  // namespace heartgen::pde
