// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/stages.hpp"

#include <iterator>

namespace heartgen::pipeline {
namespace {

/// The stages that have run and those that are needed as far as is known.
std::vector<StagePlan> plan_of(std::vector<StagePlan> done, const Stages& stages, std::size_t next, const Build& b) {
  for (; next < stages.size(); ++next)
    if (const Stage& stage = stages[next]; !stage.name.empty() && stage.needed(b))
      done.push_back({stage.name, stage.weight});
  return done;
}

}  // namespace

Stage step(Needed needed, Notes (*settle)(Build&)) {
  return {{}, 0, needed, [=](Build& b) {
            const Notes notes = parallel::run_on_root(b.run.comm, [&] { return settle(b); });
            b.run.notes.insert(b.run.notes.end(), notes.begin(), notes.end());
          }};
}

Stage step(Needed needed, void (*settle)(Build&)) {
  return {{}, 0, needed, [=](Build& b) { parallel::run_on_root(b.run.comm, [&] { settle(b); }); }};
}

Stages joined(std::vector<Stages> tables) {
  Stages all;
  for (auto& table : tables)
    all.insert(all.end(), std::make_move_iterator(table.begin()), std::make_move_iterator(table.end()));
  return all;
}

void run_stages(const Stages& stages, Build& b) {
  std::vector<StagePlan> done;
  for (std::size_t i = 0; i < stages.size(); ++i) {
    b.run.progress.plan = plan_of(done, stages, i, b);
    if (!b.run.agreed(stages[i].needed(b))) continue;
    stages[i].run(b);
    if (!stages[i].name.empty()) done.push_back({stages[i].name, stages[i].weight});
  }
  finish(b.run.progress);
}

}  // namespace heartgen::pipeline
