// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Progress of a build: a bar with the stage, its share and the time left on a terminal, plain lines otherwise: one as
/// a stage ends, and more of stages that take long.
#pragma once
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "generator/pipeline/heartbeat.hpp"
#include "generator/pipeline/stage_event.hpp"

namespace heartgen::pipeline {

struct StagePlan {
  std::string name;
  double weight = 1;  ///< rough share of the whole time
};

struct Progress {
  std::vector<StagePlan> plan{};
  std::function<void(const StageEvent&)> on_stage{};
  bool enabled = false;   ///< only rank 0 prints
  bool terminal = false;  ///< redraw one line instead of printing lines
  std::size_t next = 0;   ///< stages finished
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  std::chrono::milliseconds silence = longest_silence;  ///< between plain lines, at most
  std::shared_ptr<Heartbeat> watch{};                   ///< of the stage that runs
};

Progress make_progress(std::vector<StagePlan> plan, bool enabled);
void stage_begins(Progress& progress, const std::string& name);
/// `note` says how it ended: "4.2 s" or "from the cache".
void stage_ends(Progress& progress, const std::string& name, const std::string& note);
void finish(Progress& progress);

}  // namespace heartgen::pipeline
