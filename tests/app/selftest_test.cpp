// SPDX-License-Identifier: GPL-3.0-or-later
// The built-in case: the same bits as everywhere, whatever the processor's instructions, threads, ranks and
// locale.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/data.hpp"
#include "support/program.hpp"

namespace heartgen {
namespace {

constexpr const char* fewer_instructions =
    "env GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA,-AVX512F,-AVX2_Usable,-FMA_Usable,-AVX512F_Usable";

class SelftestOn : public ::testing::TestWithParam<std::pair<std::string, std::string>> {};

TEST_P(SelftestOn, ComputesTheExpectedBits) {
  const auto& [arguments, launcher] = GetParam();
  const auto run = testing::heartgen("selftest " + arguments, testing::scratch_folder("selftest").string(), launcher);
  EXPECT_EQ(run.exit_code, 0) << "After a change of results: heartgen selftest --list > "
                                 "generator/app/selftest_expected.txt\n"
                              << run.output << run.errors;
}

INSTANTIATE_TEST_SUITE_P(
    Machines, SelftestOn,
    ::testing::Values(std::pair<std::string, std::string>{"", ""},
                      std::pair{"--threads 1", "env LC_ALL=de_DE.UTF-8 LANG=de_DE.UTF-8 TZ=Asia/Tokyo"},
                      std::pair{"--simd plain", fewer_instructions}, std::pair{"--threads 2", testing::on_ranks(2)}));

TEST(SelftestJson, TellsTheIdsOnFiveRanks) {
  const auto run = testing::heartgen("selftest --threads 1 --json", testing::scratch_folder("selftest_json").string(),
                                     testing::on_ranks(5));
  const auto json = nlohmann::json::parse(run.output);
  EXPECT_EQ(json["content_id"], json["expected"]);
  EXPECT_TRUE(json["different"].empty());
  EXPECT_EQ(run.exit_code, 0);
}

TEST(Simd, AnUnknownNameIsRefused) {
  const auto run = testing::heartgen("selftest --simd sse9", testing::scratch_folder("simd").string());
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.errors, "heartgen: --simd: unknown \"sse9\" (give plain, avx2 or avx512)\n");
}

}  // namespace
}  // namespace heartgen
