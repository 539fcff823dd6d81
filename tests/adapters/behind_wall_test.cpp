// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/adapters/behind_wall.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <numeric>

#include "model/error.hpp"
#include "support/files.hpp"

namespace heartgen::adapters {
namespace {

constexpr Allowance usual{64 << 20, 20};

/// The message that ends a child's work; nothing that it prints may be seen, and it must not be left behind.
template <class Work>
std::string message_of(const Work& work, const Allowance& allowance = usual) {
  ::testing::internal::CaptureStderr();
  ::testing::internal::CaptureStdout();
  const auto message = testing::error_of([&] { read_behind_wall<int>("scan.mha", allowance, work); });
  EXPECT_EQ(::testing::internal::GetCapturedStderr() + ::testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1);
  EXPECT_EQ(errno, ECHILD);
  return message;
}

TEST(BehindWall, WhatIsReadComesBackWhole) {
  UnstructuredData data;
  data.points.resize(1000000);
  for (std::size_t i = 0; i < data.points.size(); ++i) data.points[i] = {1.0 * static_cast<double>(i), 2, 3};
  data.cell_tensors["a"].resize(3);
  data.integers = {"x", "y"};
  data.remarks = {"left out"};
  const auto back = read_behind_wall<UnstructuredData>("mesh.vtu", usual, [&] { return data; });
  EXPECT_EQ(back.points, data.points);
  EXPECT_EQ(back.cell_tensors.at("a").size(), 3U);
  EXPECT_EQ(back.integers, data.integers);
  EXPECT_EQ(back.remarks, data.remarks);
}

TEST(BehindWall, ARefusalKeepsItsParts) {
  try {
    read_behind_wall<int>("scan.mha", usual, []() -> int { throw UserError("is odd", "line 3", "mend it"); });
    FAIL();
  } catch (const UserError& error) {
    EXPECT_EQ(error.problem, "is odd");
    EXPECT_EQ(error.where, "line 3");
    EXPECT_EQ(error.remedy, "mend it");
  }
}

TEST(BehindWall, SignalsAndExitsBecomeOneMessageThatNamesTheFile) {
  for (const int signal : {SIGSEGV, SIGFPE, SIGABRT, SIGBUS, SIGKILL, SIGILL}) {
    const auto message = message_of([&] {
      std::puts("*** buffer overflow detected ***");
      return std::raise(signal);
    });
    EXPECT_NE(message.find("scan.mha: cannot be read"), std::string::npos) << signal << message;
  }
  EXPECT_NE(message_of([]() -> int { std::exit(0); }).find("scan.mha: cannot be read"), std::string::npos);
  EXPECT_NE(message_of([]() -> int { throw std::runtime_error("bad\ntag"); }).find("bad tag"), std::string::npos);
  EXPECT_NE(message_of([]() -> int { throw 3; }).find("scan.mha: cannot be read"), std::string::npos);
}

TEST(BehindWall, AnEndlessReaderIsEnded) {
  const Allowance short_time{64 << 20, 1};
  const auto busy = message_of(
      [] {
        while (clock() >= 0) {
        }
        return 0;
      },
      short_time);
  EXPECT_NE(busy.find("within 1 s"), std::string::npos) << busy;
  const auto asleep = message_of([] { return static_cast<int>(sleep(60)); }, short_time);
  EXPECT_NE(asleep.find("within 1 s"), std::string::npos) << asleep;
}

TEST(BehindWall, MemoryBeyondTheAllowanceIsRefusedAndMoreCanBeAllowed) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "a sanitizer needs all addresses";
#endif
  const auto take = [] {
    const std::vector<char> taken(256 << 20, 'x');
    return std::accumulate(taken.begin(), taken.end(), 0) == 0 ? 1 : 2;
  };
  EXPECT_NE(message_of(take).find("more memory"), std::string::npos);
  EXPECT_EQ(read_behind_wall<int>("scan.mha", usual,
                                  [&] {
                                    allow_memory(512 << 20);
                                    return take();
                                  }),
            2);
}

TEST(BehindWall, ACountThatNoMemoryHoldsIsNotBelieved) {
  EXPECT_NE(testing::error_of([] {
              behind_wall(
                  "scan.mha", usual,
                  [](WallSender& sender) {
                    sender.put(true);
                    sender.put(SIZE_MAX / 16);
                  },
                  [](WallReceiver& receiver) {
                    std::vector<double> values;
                    receiver.get(values);
                  });
            }).find("scan.mha: holds more"),
            std::string::npos);
}

}  // namespace
}  // namespace heartgen::adapters
