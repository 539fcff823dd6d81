// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/tetmesh/remesh_worst.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <iterator>
#include <utility>
#include <vector>

#include "generator/parallel/tasks.hpp"
#include "generator/parallel/threads.hpp"
#include "generator/tetmesh/cavity.hpp"
#include "generator/tetmesh/collapse.hpp"
#include "model/contract.hpp"

namespace heartgen::tetmesh {
namespace {

constexpr int rings = 3;  // of cells around a bad one

// The edge of the worst cell that is so many places after the longest.
std::pair<std::int32_t, std::int32_t> edge_of_worst(const Complex& part, std::size_t place) {
  const auto worst = std::min_element(part.quality.begin(), part.quality.end()) - part.quality.begin();
  const Cell& cell = part.cell(static_cast<std::int32_t>(worst));
  std::array<std::pair<double, std::pair<std::int32_t, std::int32_t>>, 6> edges;
  std::size_t count = 0;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j)
      edges[count++] = {-norm(part.at(cell[i]) - part.at(cell[j])), {cell[i], cell[j]}};
  std::sort(edges.begin(), edges.end());
  return edges[place].second;
}

// What is tried with a place, in this order. To divide an edge of the worst cell first helps most often and takes
// least; shakes of all the cells below the goal take most: where all else failed they seldom help.
constexpr int edges_of_cell = 6, modest_from = edges_of_cell, thorough_from = modest_from + 6,
              divided_and_shaken_from = thorough_from + 2, max_tries = divided_and_shaken_from + edges_of_cell;

void try_to_mend(Complex& part, const Materials& materials, RepairSettings settings, double enough, int number) {
  settings.may_relabel =
      settings.may_relabel && number >= modest_from;  // it moves a surface: only where dividing does not help
  settings.least = enough;
  const bool divides = number < modest_from || number >= divided_and_shaken_from;
  if (divides) {
    const int place = number < modest_from ? number : number - divided_and_shaken_from;
    const auto [a, b] = edge_of_worst(part, static_cast<std::size_t>(place));
    bisect_edge(part, materials, a, b);
    if (number < modest_from)
      settings.sweeps = std::min(settings.sweeps, 6);  // without shakes: another edge is cheaper
    if (number >= divided_and_shaken_from) perturb(part, materials, 0.03, static_cast<std::uint32_t>(place));
  } else {
    const int shakes = number >= thorough_from ? number - thorough_from : number - modest_from;
    if (shakes > 0) perturb(part, materials, 0.04 + 0.04 * (shakes % 4), static_cast<std::uint32_t>(shakes));
    if (number >= thorough_from) {
      settings.least = settings.goal;
      settings.sweeps *= 2;
    }
  }
  repair(part, materials, settings);
}

/// What is done with a place.
struct Effort {
  double enough;
  int tries;    ///< at most
  int at_once;  ///< of the tries: those are made together, in vain where an earlier one does
};

// The best of the tries up to the first that is good enough: the same for any number at once.
Complex best_repair(const Complex& part, const Materials& materials, const RepairSettings& settings,
                    const Effort& effort) {
  const double enough = effort.enough;
  Complex best = part;
  for (int first = 0; first < effort.tries && worst_quality(best) < enough; first += effort.at_once) {
    std::vector<Complex> tried(static_cast<std::size_t>(std::min(effort.at_once, effort.tries - first)), part);
    std::vector<std::function<void()>> tasks;
    tasks.reserve(tried.size());
    for (std::size_t i = 0; i < tried.size(); ++i)
      tasks.emplace_back([&, i] { try_to_mend(tried[i], materials, settings, enough, first + static_cast<int>(i)); });
    parallel::run_tasks(tasks);
    for (auto& one : tried)
      if (worst_quality(best) < enough && worst_quality(one) > worst_quality(best)) best = std::move(one);
  }
  return best;
}

// The worst first.
std::vector<std::int32_t> cells_below(const Complex& c, double enough) {
  std::vector<std::int32_t> bad;
  for (std::size_t i = 0; i < c.quality.size(); ++i)
    if (static_cast<double>(c.quality[i]) < enough) bad.push_back(static_cast<std::int32_t>(i));
  std::stable_sort(bad.begin(), bad.end(), [&](auto a, auto b) { return c.quality_of(a) < c.quality_of(b); });
  return bad;
}

/// A place with bad cells, and the best that was made of it.
struct Job {
  Cavity place;
  Complex best;
  bool is_better = false, is_enough = false;
};

// Places around the first of the bad cells that have no cell in common; these go from the list, and so does what is
// good enough meanwhile.
std::vector<Job> next_places(const Complex& c, std::vector<std::int32_t>& bad, double enough, std::size_t at_once) {
  std::vector<Job> jobs;
  std::vector<std::int32_t> taken;  // ascending
  std::vector<std::int32_t> left;
  for (const auto id : bad) {
    if (!c.is_alive(id) || c.quality_of(id) >= enough) continue;
    if (jobs.size() == at_once) {
      left.push_back(id);
      continue;
    }
    auto place = cavity_around(c, id, rings);
    std::vector<std::int32_t> both;
    std::set_intersection(place.cells.begin(), place.cells.end(), taken.begin(), taken.end(), std::back_inserter(both));
    if (!both.empty()) {
      left.push_back(id);
      continue;
    }
    both.clear();
    std::merge(place.cells.begin(), place.cells.end(), taken.begin(), taken.end(), std::back_inserter(both));
    taken = std::move(both);
    jobs.push_back({std::move(place), {}, false, false});
  }
  bad = std::move(left);
  return jobs;
}

void mend(std::vector<Job>& jobs, const Materials& materials, const RepairSettings& settings, double enough,
          int tries) {
  const Effort effort{enough, tries, jobs.size() == 1 ? parallel::thread_count() : 1};
  std::vector<std::function<void()>> tasks;
  tasks.reserve(jobs.size());
  for (auto& job : jobs)
    tasks.emplace_back([&] {
      job.best = best_repair(job.place.part, materials, settings, effort);
      job.is_better = worst_quality(job.best) > worst_quality(job.place.part);
      job.is_enough = worst_quality(job.best) >= enough;
    });
  parallel::run_tasks(tasks);
}

}  // namespace

std::int64_t remesh_worst(Complex& complex, const Materials& materials, const RepairSettings& settings, double enough,
                          OnFailure on_failure) {
  HEARTGEN_INVARIANT(has_derived_touches(complex));
  constexpr std::size_t always = 30, cells_for_one = 30'000;
  constexpr int max_in_vain = 8;  // after so many of the worst, what is cheap is all that the others get
  auto bad = cells_below(complex, enough);
  // More are not a few: the whole has to be made in another way.
  if (bad.size() > std::max(always, complex.cells.size() / cells_for_one)) return static_cast<std::int64_t>(bad.size());
  // The worst alone: where it cannot be mended and that is the end, all others are mended in vain.
  std::size_t at_once = 1;
  int in_vain = 0;
  for (bool is_lost = false; !is_lost && !bad.empty(); at_once = 4) {
    auto jobs = next_places(complex, bad, enough, at_once);
    mend(jobs, materials, settings, enough, in_vain < max_in_vain ? max_tries : modest_from);
    for (auto& job : jobs) {
      if (job.is_better) reinsert_cavity(complex, job.place, job.best);
      in_vain += job.is_enough ? 0 : 1;
      is_lost = is_lost || (on_failure == OnFailure::stop && !job.is_enough);
    }
  }
  return static_cast<std::int64_t>(cells_below(complex, enough).size());
}

}  // namespace heartgen::tetmesh
