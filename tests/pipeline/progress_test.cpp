// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/progress.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "support/data.hpp"
#include "support/program.hpp"

namespace heartgen::pipeline {
namespace {

using namespace std::chrono_literals;

TEST(Heartbeat, TellsAgainAndAgainUntilItsEnd) {
  std::atomic<int> told = 0;
  {
    const pipeline::Heartbeat watch(1ms, [&](double) { ++told; });
    while (told < 3) std::this_thread::sleep_for(1ms);
  }
  const int at_end = told;
  std::this_thread::sleep_for(20ms);
  EXPECT_EQ(told, at_end);
}

TEST(Heartbeat, EndsAtOnce) {
  const auto start = std::chrono::steady_clock::now();
  {
    const pipeline::Heartbeat watch(1h, [](double) {});
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, 1min);
}

/// What a build of one stage prints that takes 50 ms.
std::string printed(bool enabled) {
  ::testing::internal::CaptureStderr();
  auto progress = pipeline::make_progress({{"mesh", 1}}, enabled);
  progress.terminal = false;
  progress.silence = 1ms;
  pipeline::stage_begins(progress, "mesh");
  std::this_thread::sleep_for(50ms);
  pipeline::stage_ends(progress, "mesh", "0.1 s");
  pipeline::finish(progress);
  return ::testing::internal::GetCapturedStderr();
}

TEST(Progress, ALongStageSaysThatItStillRuns) {
  const auto lines = printed(true);
  const auto alive = lines.find("mesh         0 s so far\n"), end = lines.find("mesh         0.1 s\n");
  ASSERT_NE(end, std::string::npos) << lines;
  EXPECT_LT(alive, end) << lines;
  EXPECT_EQ(printed(false), "");
}

TEST(BenchCommand, SaysWhatItMeasures) {
  const auto folder = testing::scratch_folder("bench").string();
  const auto run = testing::heartgen_lab("bench segment --size 24,24,24 --repeats 1 --json", folder);
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_NE(run.errors.find("heartgen-lab bench: segment (1 of 1): "), std::string::npos) << run.errors;
  EXPECT_EQ(run.output.find("heartgen-lab bench"), std::string::npos) << run.output;
}

}  // namespace
}  // namespace heartgen::pipeline
