// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "generator/pipeline/output.hpp"

namespace heartgen::pipeline {
namespace {

double done_share(const Progress& progress) {
  double done = 0, all = 0;
  for (std::size_t i = 0; i < progress.plan.size(); ++i) {
    all += progress.plan[i].weight;
    if (i < progress.next) done += progress.plan[i].weight;
  }
  return all > 0 ? done / all : 0;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// What the finished stages let expect; it falls with the seconds of the stage that runs.
std::string time_left(double share, double before_s, double stage_s) {
  const double left = before_s * (1 - share) / share - stage_s;
  return share < 0.02 || before_s < 1 || left < 0 ? "" : fmt::format("about {:.0f} s left", left);
}

void draw_bar(double share, const std::string& name, const std::string& remark) {
  constexpr int width = 30;
  const int filled = static_cast<int>(share * width);
  draw(fmt::format("\r\033[K[{}{}] {:3.0f} %  {}  {}", std::string(static_cast<std::size_t>(filled), '#'),
                   std::string(static_cast<std::size_t>(width - filled), '.'), 100 * share, name, remark));
}

std::shared_ptr<Heartbeat> bar_that_moves(const Progress& progress, const std::string& name) {
  const double share = done_share(progress), before_s = seconds_since(progress.start);
  const auto show = [=](double stage_s) {
    const auto left = time_left(share, before_s, stage_s);
    draw_bar(share, name, fmt::format("{:.0f} s{}{}", stage_s, left.empty() ? "" : ", ", left));
  };
  show(0);
  return {new Heartbeat(std::chrono::seconds(1), show), [](const Heartbeat* watch) {
            delete watch;
            draw("\r\033[K");
          }};
}

std::shared_ptr<Heartbeat> lines_of_life(const Progress& progress, const std::string& name) {
  const auto number = progress.next + 1, count = progress.plan.size();
  return std::make_shared<Heartbeat>(progress.silence, [=](double stage_s) {
    fmt::print(stderr, "[{:2}/{}] {:<12} {:.0f} s so far\n", number, count, name, stage_s);
    std::fflush(stderr);
  });
}

void tell(const Progress& progress, const std::string& name, std::size_t number, bool has_ended) {
  if (progress.on_stage)
    progress.on_stage({name, number, std::max(number, progress.plan.size()), done_share(progress), has_ended});
}

}  // namespace

Progress make_progress(std::vector<StagePlan> plan, bool enabled) {
  Progress progress;
  progress.plan = std::move(plan);
  progress.enabled = enabled;
  progress.terminal = isatty(STDERR_FILENO) == 1;
  return progress;
}

void stage_begins(Progress& progress, const std::string& name) {
  tell(progress, name, progress.next + 1, false);
  if (progress.enabled)
    progress.watch = progress.terminal ? bar_that_moves(progress, name) : lines_of_life(progress, name);
}

void stage_ends(Progress& progress, const std::string& name, const std::string& note) {
  ++progress.next;
  progress.watch.reset();
  tell(progress, name, progress.next, true);
  if (!progress.enabled) return;
  fmt::print(stderr, "[{:2}/{}] {:<12} {}\n", progress.next, progress.plan.size(), name, note);
  std::fflush(stderr);
}

void finish(Progress& progress) { progress.watch.reset(); }

}  // namespace heartgen::pipeline
