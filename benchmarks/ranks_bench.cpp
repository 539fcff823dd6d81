// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "benchmarks/benchmarks.hpp"
#include "benchmarks/test_images.hpp"
#include "generator/parallel/slab.hpp"
#include "generator/pde/chan_vese.hpp"
#include "generator/pde/chan_vese_flow.hpp"
#include "generator/pde/continuous_min_cut.hpp"
#include "generator/pde/diffusion.hpp"
#include "generator/pde/total_variation.hpp"

namespace heartgen::benchmarks {
namespace {

using namespace pde;
using parallel::Comm;
using parallel::Slab;

/// What every stage works on: this rank's slabs.
struct Slabs {
  Slab<float> image, weight;
  Slab<std::uint8_t> domain, band;
};

Slabs make_slabs(const Volume<float>& image_on_root, const Comm& comm) {
  Volume<float> weight_on_root;
  Mask domain_on_root, band_on_root;
  if (comm.is_root()) {
    const Grid& grid = image_on_root.grid;
    weight_on_root = image_on_root;
    for (auto& w : weight_on_root.voxels) w = 1 / (1 + w * w / 1e4f);
    domain_on_root = Mask(grid, 1);
    band_on_root = Mask(grid, cut_free);  // free but for a column in the middle and the border along x
    for (std::int64_t k = 0; k < grid.size[2]; ++k)
      for (std::int64_t j = 0; j < grid.size[1]; ++j) {
        band_on_root(0, j, k) = band_on_root(grid.size[0] - 1, j, k) = cut_outer;
        band_on_root(grid.size[0] / 2, j, k) = cut_inner;
      }
  }
  return {parallel::scatter(image_on_root, comm), parallel::scatter(weight_on_root, comm),
          parallel::scatter(domain_on_root, comm), parallel::scatter(band_on_root, comm)};
}

/// Of every stage.
constexpr int iterations = 20;

struct Stage {
  const char* name;
  void (*run)(const Slabs& s, const Comm& comm);
};

constexpr Stage stages[] = {
    {"Chan-Vese, convex",
     [](const Slabs& s, const Comm& comm) {
       chan_vese(s.image, s.domain, {.mu = 0.5, .max_iterations = iterations}, comm);
     }},
    {"Chan-Vese, semi-explicit",
     [](const Slabs& s, const Comm& comm) {
       auto phi = s.image;
       sweep_flow(s.image, s.domain, phi, 50, 300, {}, iterations, comm);
     }},
    {"Perona-Malik",
     [](const Slabs& s, const Comm& comm) {
       auto image = s.image;
       perona_malik(image, {.iterations = iterations}, comm);
     }},
    {"minimal cut",
     [](const Slabs& s, const Comm& comm) {
       continuous_min_cut(s.weight, s.band, {.max_iterations = iterations}, comm);
     }},
    {"total variation",
     [](const Slabs& s, const Comm& comm) {
       auto image = s.image;
       total_variation_l2(image, {.iterations = iterations}, comm);
     }},
};

struct Times {
  double together = 0, one = 0;  ///< median seconds
};

/// Runs on all ranks and on the root alone by turns: both meet the machine in the same hour. @collective
Times measure(const Stage& stage, const Slabs& shared, const Slabs& whole, int repeats, const Comm& comm) {
  const auto alone = [&] { stage.run(whole, parallel::self()); };
  stage.run(shared, comm);
  std::vector<double> together, one;
  for (int n = 0; n < repeats; ++n) {
    together.push_back(slowest_seconds(comm, [&] { stage.run(shared, comm); }));
    one.push_back(comm.is_root() ? seconds(alone) : 0);
  }
  Times times{median(together), median(one)};
  parallel::broadcast(comm, times);
  return times;
}

/// How many times the memory of one rank all ranks together have: a stage that waits for memory gains no more.
double bandwidth_gain(const Comm& comm) {
  const auto together = static_cast<double>(parallel::sum_int64(comm, static_cast<std::int64_t>(triad_bandwidth())));
  double one = 0;
  if (comm.is_root()) one = triad_bandwidth();
  parallel::broadcast(comm, one);
  return together / one;
}

}  // namespace

Table bench_ranks(const Settings& settings, const Comm& comm) {
  Table table;
  if (comm.size == 1) {
    table.push_back({"ranks", "ranks", 1, "", "start it as: mpirun -n 2 heartgen-lab bench ranks"});
    return table;
  }
  parallel::set_thread_count(1);
  const auto image = comm.is_root() ? test_image(grid_of(settings.size, settings.spacing_mm)) : Volume<float>{};
  const Slabs shared = make_slabs(image, comm);
  const Slabs whole = comm.is_root() ? make_slabs(image, parallel::self()) : Slabs{};
  for (const auto& stage : stages) {
    const auto times = measure(stage, shared, whole, settings.repeats, comm);
    table.push_back({"ranks", fmt::format("{}, {} ranks against one", stage.name, comm.size),
                     times.one / times.together, "times",
                     fmt::format("{:.2f} s and {:.2f} s; 1.9 at 2 ranks is the goal", times.together, times.one)});
  }
  table.push_back({"ranks", fmt::format("memory bandwidth (triad), {} ranks against one", comm.size),
                   bandwidth_gain(comm), "times", "of the machine: what waits for memory gains no more"});
  return table;
}

}  // namespace heartgen::benchmarks
