// SPDX-License-Identifier: GPL-3.0-or-later
// Run under mpirun with any number of ranks: every distributed result must equal the serial one, bit for bit, and every
// rank must see the same errors.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "generator/fibers/inpaint_grid.hpp"
#include "generator/parallel/comm.hpp"
#include "generator/pde/active_contours.hpp"
#include "generator/pde/chan_vese.hpp"
#include "generator/pde/chan_vese_flow.hpp"
#include "generator/pde/continuous_min_cut.hpp"
#include "generator/pde/filters.hpp"
#include "generator/pde/median.hpp"
#include "generator/pde/subjective_surface.hpp"
#include "model/error.hpp"
#include "pde/pde_images.hpp"

namespace heartgen {
namespace {

using parallel::self;
using parallel::world;
using testing::grid_of;
using testing::length;
using testing::noisy;
using testing::volume_of;

/// Images with many slices, fewer slices than ranks, one slice, and enough slices for passes of several iterations, of
/// different depths on different numbers of ranks.
const Index3 sizes[] = {{14, 11, 13}, {12, 9, 31}, {12, 9, 2}, {16, 12, 1}, {9, 7, 130}};

/// The image as a collective sees it: on the root only.
template <class T>
Volume<T> on_root(const Volume<T>& volume) {
  return world().is_root() ? volume : Volume<T>{};
}

Volume<float> image_of(Index3 size) {
  return noisy(volume_of(grid_of(size, {0.7, 0.7, 1.3}),
                         [](double x, double y, double z) { return length(x, y, z) < 3 ? 80 : 5; }),
               20);
}

TEST(Ranks, BroadcastsReachEverybody) {
  const auto comm = world();
  std::vector<double> values;
  std::vector<std::string> texts;
  if (comm.is_root()) {
    values = {1.5, -2, 1e300};
    texts = {"", "fibre", std::string(1000, 'x')};
  }
  broadcast(comm, values);
  broadcast(comm, texts);
  EXPECT_EQ(values, (std::vector<double>{1.5, -2, 1e300}));
  EXPECT_EQ(texts, (std::vector<std::string>{"", "fibre", std::string(1000, 'x')}));
}

TEST(Ranks, ReductionsAreExact) {
  const auto comm = world();
  EXPECT_EQ(parallel::max(comm, comm.rank), comm.size - 1);
  EXPECT_EQ(parallel::min(comm, comm.rank), 0);
  EXPECT_EQ(parallel::sum_int64(comm, (std::int64_t{1} << 60) / comm.size / 2 * 2 + 1) % 2, comm.size % 2);
}

TEST(Ranks, SliceSumsHaveTheSameBits) {
  const auto comm = world();
  std::vector<double> slices;
  for (int k = 0; k < 17; ++k) slices.push_back(std::pow(-1.7, k) + 0.1 * k);
  const auto own = parallel::owned_slices(17, comm, comm.rank);
  const std::vector<double> mine(slices.begin() + own.begin, slices.begin() + own.end);
  EXPECT_EQ(parallel::sum_by_slice(comm, mine), parallel::sum_by_slice(self(), slices));
}

TEST(Ranks, ErrorsOfTheRootReachEverybody) {
  const auto comm = world();
  try {
    parallel::run_on_root(comm, []() -> int { throw UserError("no seed", "ct.nii.gz", "add one"); });
    FAIL() << "nothing thrown";
  } catch (const UserError& error) {
    EXPECT_EQ(error.problem, "no seed");
    EXPECT_EQ(error.where, "ct.nii.gz");
    EXPECT_EQ(error.remedy, "add one");
  }
  EXPECT_THROW(parallel::run_on_root(comm, [] { throw std::logic_error("defect"); }), std::exception);
  EXPECT_EQ(parallel::run_on_root(comm, [] { return 7; }), comm.is_root() ? 7 : 0);
}

TEST(Ranks, ScatterHaloAndGather) {
  for (const auto size : sizes)
    for (const std::int64_t ghosts : {0, 1, 3}) {
      const auto volume = image_of(size);
      const auto slab = parallel::scatter(on_root(volume), world(), ghosts);
      EXPECT_EQ(slab.grid, volume.grid);
      for (auto k = slab.first - ghosts; slab.count && k < slab.end() + ghosts; ++k)
        for (std::int64_t j = 0; j < size[1]; ++j)
          for (std::int64_t i = 0; i < size[0]; ++i)
            ASSERT_EQ(slab.row(j, k)[i], volume(i, j, std::clamp<std::int64_t>(k, 0, size[2] - 1)));
      const auto back = parallel::gather(slab, world());
      EXPECT_EQ(back.voxels, on_root(volume).voxels);
    }
}

/// Random, constant and heavily tied grey values.
std::vector<Volume<float>> images_for_medians(Index3 size) {
  const auto random = image_of(size);
  auto tied = random;
  for (auto& v : tied.voxels) v = std::round(v / 40);
  return {random, tied, Volume<float>(random.grid, -3.5f)};
}

TEST(Ranks, MediansAreExact) {
  for (const auto size : sizes)
    for (const auto& volume : images_for_medians(size)) {
      const auto labels = volume_of<std::uint8_t>(volume.grid, [](double x, double, double) { return x > 1 ? 2 : 1; });
      const auto distributed = pde::median(parallel::scatter(on_root(volume), world()),
                                           parallel::scatter(on_root(labels), world()), 2, world());
      std::vector<float> sorted;
      for (std::size_t i = 0; i < volume.voxels.size(); ++i)
        if (labels.voxels[i] == 2) sorted.push_back(volume.voxels[i]);
      std::sort(sorted.begin(), sorted.end());
      EXPECT_EQ(distributed, sorted[(sorted.size() - 1) / 2]);
    }
}

TEST(Ranks, MediansRefuseNaNEverywhere) {
  auto volume = image_of(sizes[0]);
  volume.voxels.back() = std::numeric_limits<float>::quiet_NaN();
  const auto image = parallel::scatter(on_root(volume), world());
  const auto all = parallel::scatter(on_root(Mask(volume.grid, 1)), world());
  EXPECT_THROW(pde::median(image, all, 1, world()), UserError);
}

TEST(Ranks, FiltersHaveTheSameBits) {
  for (const auto size : sizes)
    for (const auto& name : pde::filter_names()) {
      SCOPED_TRACE(name);
      std::map<std::string, double> parameters;
      if (name != "sobolev" && name != "redistance") parameters["iterations"] = 9;
      const auto volume = image_of(size);
      const auto distributed = pde::apply_filter(name, on_root(volume), parameters, world());
      const auto serial = pde::apply_filter(name, volume, parameters, self());
      EXPECT_EQ(distributed.voxels, on_root(serial).voxels);
    }
}

TEST(Ranks, FilterErrorsReachEverybody) {
  EXPECT_THROW(pde::apply_filter("heat", {}, {}, world()), UserError);
  EXPECT_THROW(pde::apply_filter("heat", on_root(image_of(sizes[0])), {{"time_step", 3}}, world()), UserError);
}

TEST(Ranks, ChanVeseHasTheSameBits) {
  for (const auto size : sizes)
    for (const auto norm : {pde::Norm::l1, pde::Norm::l2}) {
      const auto volume = image_of(size);
      const auto domain =
          volume_of<std::uint8_t>(volume.grid, [](double x, double y, double) { return x + y < 4 ? 1 : 0; });
      pde::ChanVeseSettings settings;
      settings.norm = norm;
      settings.mu = 0.6;
      const auto distributed = pde::chan_vese(on_root(volume), on_root(domain), settings, world());
      const auto serial = pde::chan_vese(volume, domain, settings, self());
      EXPECT_EQ(distributed.above.voxels, on_root(serial.above).voxels);
      EXPECT_EQ(distributed.c_below, serial.c_below);
      EXPECT_EQ(distributed.c_above, serial.c_above);
      EXPECT_EQ(distributed.energy, serial.energy);
      EXPECT_EQ(distributed.iterations, serial.iterations);
    }
  EXPECT_THROW(pde::chan_vese(on_root(image_of(sizes[0])), on_root(Mask(image_of(sizes[0]).grid)), {}, world()),
               UserError);
}

TEST(Ranks, ChanVeseFlowHasTheSameBits) {
  for (const auto size : sizes)
    for (const auto norm : {pde::Norm::l1, pde::Norm::l2}) {
      const auto volume = image_of(size);
      const auto domain =
          volume_of<std::uint8_t>(volume.grid, [](double x, double y, double) { return x + y < 4 ? 1 : 0; });
      const pde::ChanVeseFlowSettings settings{.norm = norm, .mu = 0.6, .max_iterations = 60};
      const auto found = pde::chan_vese_flow(parallel::scatter(on_root(volume), world()),
                                             parallel::scatter(on_root(domain), world()), settings, world());
      const auto serial =
          pde::chan_vese_flow(parallel::scatter(volume, self()), parallel::scatter(domain, self()), settings, self());
      const auto phi = parallel::gather(found.phi, world());
      EXPECT_EQ(phi.voxels, on_root(parallel::gather(serial.phi, self())).voxels);
      EXPECT_EQ(found.energy, serial.energy);
      EXPECT_EQ(found.c_above, serial.c_above);
      EXPECT_EQ(found.iterations, serial.iterations);
    }
}

TEST(Ranks, MinimalCutHasTheSameBits) {
  for (const auto size : sizes) {
    const auto volume = image_of(size);
    auto weight = volume;
    for (auto& w : weight.voxels) w = 1 / (1 + w * w / 100);
    const auto state = volume_of<std::uint8_t>(volume.grid, [](double x, double y, double z) {
      const double r = length(x, y, z);
      return r < 1.5 ? 2 : r < 3.4 ? 1 : 0;
    });
    const auto distributed = pde::continuous_min_cut(on_root(weight), on_root(state), {45, 1e-6, 20}, world());
    const auto serial = pde::continuous_min_cut(weight, state, {45, 1e-6, 20}, self());
    EXPECT_EQ(distributed.u.voxels, on_root(serial.u).voxels);
    EXPECT_EQ(distributed.duality_gap, serial.duality_gap);
    EXPECT_EQ(distributed.energy, serial.energy);
    EXPECT_EQ(distributed.iterations, 45);
  }
}

TEST(Ranks, ContoursHaveTheSameBits) {
  for (const auto size : sizes) {
    const auto volume = image_of(size);
    const auto& grid = volume.grid;
    const std::vector<Vec3> seeds = {lps_from_index(grid, {6, 5, size[2] > 5 ? 6.0 : 0.0})};
    const auto start = pde::balls(grid, seeds, 2);
    for (const auto model : {pde::ContourModel::geometric, pde::ContourModel::geodesic}) {
      const pde::ContourSettings settings{model, 1, 1, 0.5, 45};
      const auto distributed = pde::evolve_contour(on_root(volume), on_root(start), {0.8, 20}, settings, world());
      const auto serial = pde::evolve_contour(volume, start, {0.8, 20}, settings, self());
      EXPECT_EQ(distributed.level_set.voxels, on_root(serial.level_set).voxels);
      EXPECT_EQ(distributed.iterations, serial.iterations);
    }
    const auto distributed = pde::subjective_surface(on_root(volume), seeds, {0.8, 20}, {70, 0}, world());
    const auto serial = pde::subjective_surface(volume, seeds, {0.8, 20}, {70, 0}, self());
    EXPECT_EQ(distributed.surface.voxels, on_root(serial.surface).voxels);
    EXPECT_EQ(distributed.plateau, serial.plateau);
  }
  EXPECT_THROW(pde::evolve_contour(on_root(image_of(sizes[0])), {}, {}, {}, world()), UserError);
  EXPECT_THROW(pde::subjective_surface(on_root(image_of(sizes[0])), {}, {}, {}, world()), UserError);
}

TEST(Ranks, InpaintedAxesHaveTheSameBits) {
  for (const auto size : sizes) {
    const auto wall = volume_of<std::uint8_t>(grid_of(size, {0.75, 0.75, 1.25}), [](double x, double y, double z) {
      return length(x, y, z) > 1.5 && length(x, y, z) < 5 && x + y < 4 ? 1 : 0;
    });
    Volume<Vec3> fiber(wall.grid);
    for (std::size_t v = 0; v < fiber.voxels.size(); ++v) {
      const double turn = 0.37 * static_cast<double>(v % 29);
      if (v % 7 < 2) fiber.voxels[v] = {std::cos(turn), std::sin(turn), 0};
    }
    const auto serial = fibers::inpaint_axes(fiber, wall, 25, self());
    const auto distributed = fibers::inpaint_axes(on_root(fiber), on_root(wall), 25, world());
    EXPECT_EQ(distributed.voxels, on_root(serial).voxels);
    EXPECT_NE(serial.voxels, fiber.voxels);
  }
}

}  // namespace
}  // namespace heartgen

int main(int argc, char** argv) {
  const heartgen::parallel::Environment environment(&argc, &argv);
  ::testing::InitGoogleTest(&argc, argv);
  if (!heartgen::parallel::world().is_root())  // one report is enough; failures show in the exit code
    delete ::testing::UnitTest::GetInstance()->listeners().Release(
        ::testing::UnitTest::GetInstance()->listeners().default_result_printer());
  return RUN_ALL_TESTS();
}
