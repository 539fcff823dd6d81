// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A build as a table: the list that runs is the plan that the progress shows.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "generator/pipeline/build.hpp"

namespace heartgen::pipeline {

/// One row: a stage, which the progress and the log name, or a step between them, too short to be told of.
struct Stage {
  std::string name{};  ///< empty: a step
  double weight = 0;   ///< rough share of the whole time
  bool (*needed)(const Build&);
  std::function<void(Build&)> run;
};
using Stages = std::vector<Stage>;
using Needed = bool (*)(const Build&);
using Sources = std::vector<std::string>;

inline bool always(const Build&) { return true; }

/// `make` is a function of what earlier stages left; its value goes to `place`, its notes to the build's. `sources`
/// stand for all that it depends on: the same ones let the cache answer.
template <class T>
Stage stage(const char* name, double weight, Needed needed, Staged<T> Build::*place, Sources (*sources)(const Build&),
            Noted<T> (*make)(const Build&), On on = On::root) {
  return {name, weight, needed,
          [=](Build& b) { b.*place = b.run.stage(on, name, sources(b), [&] { return make(b); }); }};
}

/// A stage whose value is kept elsewhere than in the cache.
template <class T>
Stage last_stage(const char* name, double weight, Needed needed, T Build::*place, Noted<T> (*make)(const Build&),
                 On on = On::root) {
  return {name, weight, needed,
          [=](Build& b) { b.*place = std::move(b.run.last_stage(on, name, [&] { return make(b); }).value); }};
}

/// Refuses, or settles what a stage left; on the root.
Stage step(Needed needed, Notes (*settle)(Build&));
Stage step(Needed needed, void (*settle)(Build&));

/// One after the other. Other tables' stages can be among them.
Stages joined(std::vector<Stages> tables);

/// Runs what is needed in the order of the table; whether a row is needed is asked anew before it. @collective
void run_stages(const Stages& stages, Build& build);

}  // namespace heartgen::pipeline
