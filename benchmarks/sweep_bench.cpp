// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <utility>

#include "benchmarks/benchmarks.hpp"
#include "benchmarks/test_images.hpp"
#include "generator/adapters/itk_chan_vese.hpp"
#include "generator/parallel/simd.hpp"
#include "generator/parallel/slab.hpp"
#include "generator/parallel/threads.hpp"
#include "generator/pde/chan_vese_flow.hpp"
#include "generator/pde/diffusion.hpp"
#include "generator/pde/total_variation.hpp"

namespace heartgen::benchmarks {
namespace {

using namespace pde;
using parallel::Comm;
using parallel::Slab;

/// A sweep over a whole image: what it does, and the bytes it must move for each voxel (4 for each float read or
/// written once, as the triad counts them).
struct Sweep {
  std::string name;
  double bytes;
  std::function<void(int sweeps)> run;
};

/// Seconds of one sweep: of `many` minus those of `few` right before, so that what is done once does not count, and
/// the median of that, since a difference of two medians may be of two moods of the machine.
double sweep_seconds(int repeats, const Sweep& sweep) {
  constexpr int few = 4, many = 12;  // some go by passes of four
  sweep.run(few);
  std::vector<double> differences;
  for (int r = 0; r < repeats; ++r) {
    const double start = seconds([&] { sweep.run(few); });
    differences.push_back(seconds([&] { sweep.run(many); }) - start);
  }
  return median(std::move(differences)) / (many - few);
}

/// A row for a sweep that takes so long; none for one that is lost in the noise of the machine.
void add_rate(Table& table, const std::string& what, double voxels, double sweep_seconds, const std::string& note) {
  const bool is_lost = !(sweep_seconds > 0);
  table.push_back({"sweep", what, is_lost ? 0 : voxels / sweep_seconds / 1e9, "G voxels/s",
                   is_lost ? "not measured: noise is larger than the sweep; give more --repeats" : note});
}

std::vector<Sweep> sweeps_of(const Slab<float>& image, const Slab<std::uint8_t>& domain, const Comm& alone) {
  static constexpr ChanVeseFlowSettings flow{.mu = 0.1};
  return {{"Chan-Vese, semi-explicit (3.14)", 12,  // reads φ and the image, writes φ
           [&](int n) {
             auto phi = image;
             sweep_flow(image, domain, phi, 20, 300, flow, n, alone);
           }},
          {"total variation, primal-dual", 11,  // u, 2 u - u_old, three dual fields and the image, once for four sweeps
           [&](int n) {
             auto u = image;
             total_variation_l2(u, {.iterations = n}, alone);
           }},
          {"Perona-Malik, explicit", 3,  // reads the image, writes it and its copy, once for four steps
           [&](int n) {
             auto u = image;
             perona_malik(u, {.iterations = n}, alone);
           }},
          {"heat equation, explicit", 3, [&](int n) {
             auto u = image;
             heat(u, {.iterations = n}, alone);
           }}};
}

void measure(Table& table, const Settings& settings, const std::vector<Sweep>& sweeps, double voxels) {
  const double bandwidth = triad_bandwidth();
  const int threads = parallel::thread_count();
  const auto with_threads = fmt::format("{} thread{}", threads, threads > 1 ? "s" : "");
  table.push_back({"sweep", "memory bandwidth (triad), " + with_threads, bandwidth / 1e9, "GB/s", ""});
  for (const auto& sweep : sweeps) {
    const double one = sweep_seconds(settings.repeats, sweep), least = voxels * sweep.bytes / bandwidth;
    add_rate(table, fmt::format("{}, {}", sweep.name, with_threads), voxels, one,
             fmt::format("{:.0f} % of the {:.2f} that the bandwidth allows at {} bytes a voxel", 100 * least / one,
                         voxels / least / 1e9, sweep.bytes));
  }
}

void measure_levels(Table& table, const Settings& settings, const Sweep& sweep, double voxels) {
  const auto best = parallel::simd_level();
  for (const auto level : {parallel::Simd::plain, parallel::Simd::avx2, parallel::Simd::avx512}) {
    if (parallel::set_simd_level(level) != level) break;
    add_rate(table, fmt::format("{}, {} code", sweep.name, parallel::name_of(level)), voxels,
             sweep_seconds(settings.repeats, sweep), "the same bits");
  }
  parallel::set_simd_level(best);
}

void measure_memory(Table& table, const Sweep& sweep, double voxels) {
  start_peak();
  sweep.run(1);
  table.push_back({"sweep", "memory of the semi-explicit sweep besides image and domain", peak_bytes() / voxels,
                   "bytes/voxel", "φ twice; the image has 4, the domain 1"});
}

void measure_peer(Table& table) {
  const Grid grid = grid_of({96, 96, 64});
  const auto image = test_image(grid);
  constexpr int iterations = 8;
  const double one = seconds([&] { adapters::itk_dense_chan_vese(image, 1); });
  const double more = seconds([&] { adapters::itk_dense_chan_vese(image, 1 + iterations); });
  add_rate(table, "peer: ITK dense Chan-Vese, 96 x 96 x 64", static_cast<double>(grid.voxel_count()),
           (more - one) / iterations, "its own threads");
}

}  // namespace

Table bench_sweep(const Settings& settings, const Comm& comm) {
  Table table;
  if (!comm.is_root()) return table;  // one process has the machine to itself
  const auto alone = parallel::self();
  const Grid grid = grid_of({512, 512, 100});
  const auto voxels = static_cast<double>(grid.voxel_count());
  const auto image = parallel::scatter(test_image(grid), alone);
  const auto domain = parallel::scatter(Mask(grid, 1), alone);
  const auto sweeps = sweeps_of(image, domain, alone);
  for (int threads = 1; threads <= settings.threads; threads *= 2) {
    parallel::set_thread_count(threads);
    measure(table, settings, sweeps, voxels);
  }
  measure_levels(table, settings, sweeps.front(), voxels);
  measure_memory(table, sweeps.front(), voxels);
  measure_peer(table);
  return table;
}

}  // namespace heartgen::benchmarks
