// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/naming/margins.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <utility>

#include "generator/parallel/tasks.hpp"

namespace heartgen::naming {
namespace {

constexpr int shakes = 60;

struct Alternative {
  Name name, instead;
  Solution solution;
};

/// The largest pieces of a name, as many as hold half of its blood.
Fixed main_pieces(const Problem& problem, const std::vector<Name>& names, Name name) {
  std::vector<std::pair<Whole, std::size_t>> pieces;
  Whole all = 0;
  for (std::size_t n = 0; n < names.size(); ++n) {
    if (names[n] != name) continue;
    pieces.emplace_back(-problem.pieces[n].voxels, n);
    all += problem.pieces[n].voxels;
  }
  std::sort(pieces.begin(), pieces.end());
  Fixed chosen(names.size(), false);
  Whole sum = 0;
  for (const auto& [voxels, n] : pieces) {
    if (2 * sum >= all) break;
    sum -= voxels;
    chosen[n] = true;
  }
  return chosen;
}

/// The best labelling in which half of the blood of `name` is called `instead`.
Solution with_other_name(const Problem& problem, const std::vector<Name>& names, Name name, Name instead) {
  Labelling labelling(problem, names);
  const Fixed fixed = main_pieces(problem, names, name);
  for (int n = 0; n < labelling.size(); ++n)
    if (fixed[static_cast<std::size_t>(n)]) labelling.set(n, instead);
  descend(labelling, fixed, 4);
  shake(labelling, static_cast<std::uint64_t>(name) * name_count + static_cast<std::uint64_t>(instead), shakes, fixed);
  const double energy = descend(labelling, fixed, 2);
  return {labelling.names(), energy};
}

std::vector<Alternative> all_alternatives(const Problem& problem, const std::vector<Name>& names) {
  const Labelling labelling(problem, names);
  std::vector<Alternative> alternatives;
  for (int a = 1; a < name_count; ++a)
    for (int b = 0; b < name_count; ++b)
      if (a != b && labelling.ml(static_cast<Name>(a)) > 0)
        alternatives.push_back({static_cast<Name>(a), static_cast<Name>(b), {}});
  std::vector<std::function<void()>> tasks;
  for (auto& alternative : alternatives)
    tasks.emplace_back(
        [&] { alternative.solution = with_other_name(problem, names, alternative.name, alternative.instead); });
  parallel::run_tasks(tasks);
  return alternatives;
}

}  // namespace

Judged judge_margins(const Problem& problem, std::vector<Name> names) {
  constexpr int most_rounds = 4;
  Judged judged{{std::move(names), 0}, {}};
  judged.solution.energy = Labelling(problem, judged.solution.names).energy();
  for (int round = 0; round < most_rounds; ++round) {
    const auto alternatives = all_alternatives(problem, judged.solution.names);
    const Solution before = judged.solution;
    for (const auto& alternative : alternatives)
      if (alternative.solution.energy < judged.solution.energy - 1e-6) judged.solution = alternative.solution;
    if (judged.solution.names != before.names) continue;
    for (auto& margin : judged.margins) margin.cost = std::numeric_limits<double>::infinity();
    for (const auto& [name, instead, solution] : alternatives) {
      Margin& margin = judged.margins[static_cast<std::size_t>(name)];
      if (solution.energy - before.energy < margin.cost) margin = {solution.energy - before.energy, instead};
    }
    break;
  }
  const Labelling labelling(problem, judged.solution.names);
  for (int n = 0; n < name_count; ++n)
    if (!labelling.holds(static_cast<Name>(n))) judged.margins[static_cast<std::size_t>(n)] = {};
  return judged;
}

}  // namespace heartgen::naming
