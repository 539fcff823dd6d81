// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Contracts. What a function states of its arguments, its result or what it keeps true inside is checked, not hoped
/// for: HEARTGEN_EXPECTS at its door, always; HEARTGEN_ENSURES and HEARTGEN_INVARIANT, which may cost as much as the
/// work itself, where HEARTGEN_AUDIT is set (the presets audit, asan and tsan). What is broken is a defect of the
/// caller or of ours, never of a user's file: that is a UserError.
#pragma once
#include <stdexcept>

namespace heartgen {

/// "generator/image/statistics.cpp:30: expects !values.empty()".
struct ContractViolation : std::logic_error {
  using std::logic_error::logic_error;
};

/// Throws ContractViolation. `kind` is expects, ensures or keeps.
[[noreturn]] void contract_violated(const char* kind, const char* condition, const char* file, int line);

}  // namespace heartgen

#define HEARTGEN_CHECK(kind, condition) \
  ((condition) ? static_cast<void>(0) : ::heartgen::contract_violated(kind, #condition, __FILE__, __LINE__))
#define HEARTGEN_EXPECTS(condition) HEARTGEN_CHECK("expects", condition)
#ifdef HEARTGEN_AUDIT
#define HEARTGEN_ENSURES(condition) HEARTGEN_CHECK("ensures", condition)
#define HEARTGEN_INVARIANT(condition) HEARTGEN_CHECK("keeps", condition)
#else
#define HEARTGEN_ENSURES(condition) static_cast<void>(0)
#define HEARTGEN_INVARIANT(condition) static_cast<void>(0)
#endif
