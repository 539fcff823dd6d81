// SPDX-License-Identifier: GPL-3.0-or-later
// Contracts that are broken on purpose.
#include "model/contract.hpp"

#include <gtest/gtest.h>

#include <string>

#include "model/quantile.hpp"

namespace heartgen {
namespace {

std::string broken(bool is_kept) {
  try {
    HEARTGEN_EXPECTS(is_kept);
  } catch (const ContractViolation& error) {
    return error.what();
  }
  return "";
}

TEST(Contract, SaysWhatAndWhere) {
  EXPECT_EQ(broken(true), "");
  EXPECT_NE(broken(false).find("contract_test.cpp:"), std::string::npos) << broken(false);
  EXPECT_NE(broken(false).find(": expects is_kept"), std::string::npos) << broken(false);
}

TEST(Contract, NamesNoFolderOfTheMachine) {
  try {
    contract_violated("keeps", "x > 0", "/home/someone/heartgen/generator/image/distance.cpp", 7);
  } catch (const ContractViolation& error) {
    EXPECT_STREQ(error.what(), "generator/image/distance.cpp:7: keeps x > 0");
  }
}

TEST(Contract, EnsuresAndInvariantsAreAskedInAuditsAlone) {
#ifdef HEARTGEN_AUDIT
  EXPECT_THROW(HEARTGEN_ENSURES(false), ContractViolation);
  EXPECT_THROW(HEARTGEN_INVARIANT(false), ContractViolation);
#else
  HEARTGEN_ENSURES(false);
  HEARTGEN_INVARIANT(false);
#endif
}

TEST(Contract, OrderStatisticsOfNothing) {
  std::vector<float> none, some{3, 1, 2};
  EXPECT_THROW(upper_median(none), ContractViolation);
  EXPECT_THROW(lower_median(none), ContractViolation);
  EXPECT_THROW(quantile(none, 0.5), ContractViolation);
  EXPECT_THROW(quantile(some, 1.5), ContractViolation);
  EXPECT_THROW(ranked(some, 3), ContractViolation);
  EXPECT_EQ(upper_median(some), 2);
}

}  // namespace
}  // namespace heartgen
