// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/memory.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>

#include "support/data.hpp"
#include "support/files.hpp"

namespace heartgen {
namespace {

constexpr double gib = 1 << 30;

TEST(Memory, CgroupsOfBothVersionsAndTheirParentsLimit) {
  const auto folder = testing::scratch_folder("memory_cgroups");
  const auto least = [&](const std::string& membership) {
    testing::write_bytes(folder / "cgroup", membership);
    return cgroup_bytes(folder / "cgroup", folder / "mounts");
  };
  const auto limit = [&](const std::string& file, const std::string& value) {
    std::filesystem::create_directories((folder / "mounts" / file).parent_path());
    testing::write_bytes(folder / "mounts" / file, value);
  };
  EXPECT_TRUE(std::isinf(cgroup_bytes(folder / "none", folder / "mounts")));
  limit("memory.max", "max\n");
  limit("a/memory.max", "2147483648\n");
  limit("a/b/memory.max", "max\n");
  EXPECT_EQ(least("0::/a/b\n"), 2 * gib);
  EXPECT_TRUE(std::isinf(least("0::/c\n")));
  EXPECT_TRUE(std::isinf(least("0::/\n")));
  limit("memory.max", "1073741824\n");  // what a container sees of itself
  EXPECT_EQ(least("0::/\n"), gib);
  limit("memory/d/memory.limit_in_bytes", "536870912\n");
  EXPECT_EQ(least("9:name=systemd:/x\n4:cpu,memory:/d/e\n"), 0.5 * gib);
  EXPECT_TRUE(std::isinf(least("4:cpu:/d\n")));
}

TEST(Memory, UlimitsAndTheUsersLimitCount) {
  const double whole = memory_bytes();
  EXPECT_GT(whole, 0);
  set_memory_limit(0.25 * gib);
  EXPECT_EQ(memory_bytes(), 0.25 * gib);
  set_memory_limit(1e18);
  EXPECT_EQ(memory_bytes(), whole);
  set_memory_limit(0);
  for (const auto resource : {RLIMIT_DATA, RLIMIT_AS}) {
    rlimit usual{}, low{};
    ASSERT_EQ(getrlimit(resource, &usual), 0);
    low = usual;
    low.rlim_cur = 1U << 30;
    ASSERT_EQ(setrlimit(resource, &low), 0);
    const double limited = memory_bytes();
    ASSERT_EQ(setrlimit(resource, &usual), 0);
    EXPECT_LE(limited, gib);
  }
  EXPECT_EQ(memory_bytes(), whole);
}

TEST(Memory, AmountsAreReadAndWritten) {
  EXPECT_EQ(bytes_of_text("8G", ""), 8 * gib);
  EXPECT_EQ(bytes_of_text("8 GiB", ""), 8 * gib);
  EXPECT_EQ(bytes_of_text("1.5gb", ""), 1.5e9);
  EXPECT_EQ(bytes_of_text("512m", ""), 0.5 * gib);
  EXPECT_EQ(bytes_of_text("2147483648", ""), 2 * gib);
  for (const char* text : {"", "G", "8X", "-8G", "8GG", "nan", "infG", "1e400", "0", "5K", "8 G i", "8G 9"})
    EXPECT_NE(testing::error_of([&] { bytes_of_text(text, "--memory-limit"); }), "") << text;
  EXPECT_EQ(text_of_bytes(2 * gib), "2 GiB");
  EXPECT_EQ(text_of_bytes(0.5 * gib), "512 MiB");
  EXPECT_EQ(text_of_bytes(344e9), "320 GiB");
}

}  // namespace
}  // namespace heartgen
