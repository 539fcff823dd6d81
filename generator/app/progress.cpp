#include "generator/app/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace heart::app {
namespace {

double done_share(const Progress& progress) {
  double done = 0, all = 0;
  for (std::size_t i = 0; i < progress.plan.size(); ++i) {
    all += progress.plan[i].weight;
    if (i < progress.next) done += progress.plan[i].weight;
  }
  return all > 0 ? done / all : 0;
}

std::string time_left(const Progress& progress, double share) {
  const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - progress.start).count();
  if (share < 0.02 || elapsed < 1) return "";
  return fmt::format("about {:.0f} s left", elapsed * (1 - share) / share);
}

void draw_bar(const Progress& progress, const std::string& name) {
  constexpr int width = 30;
  const double share = done_share(progress);
  const int filled = static_cast<int>(share * width);
  fmt::print(stderr, "\r\033[K[{}{}] {:3.0f} %  {}  {}", std::string(static_cast<std::size_t>(filled), '#'),
             std::string(static_cast<std::size_t>(width - filled), '.'), 100 * share, name, time_left(progress, share));
  std::fflush(stderr);
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
  if (progress.enabled && progress.terminal) draw_bar(progress, name);
}

void stage_ends(Progress& progress, const std::string& name, const std::string& note) {
  ++progress.next;
  if (!progress.enabled) return;
  if (progress.terminal) fmt::print(stderr, "\r\033[K");
  fmt::print(stderr, "[{:2}/{}] {:<12} {}\n", progress.next, progress.plan.size(), name, note);
  std::fflush(stderr);
}

void finish(Progress& progress) {
  if (progress.enabled && progress.terminal) fmt::print(stderr, "\r\033[K");
}

}  // namespace heart::app
