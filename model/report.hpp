// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Rows of a certificate: what was measured, where, against which bound, and why that bound.
#pragma once
#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace heartgen {

/// Where a value lies against its bounds. `told`: the row has none, it informs.
enum class Verdict : std::uint8_t { told, passed, warned, failed };

struct ReportRow {
  std::string group;   ///< "mesh", "fibers", "fit", "labels"
  std::string scope;   ///< mesh, region, surface or interface: "myocardium", "myocardium/lv_myocardium"
  std::string metric;  ///< "dihedral_min", "helix_angle_endocardium_median"
  double value = 0;
  std::string unit;                    ///< "deg", "mm", "1", "count"
  std::optional<double> at_least;      ///< the row fails below
  std::optional<double> at_most;       ///< the row fails above
  std::optional<double> warn_below{};  ///< the row warns below, where it does not fail
  std::optional<double> warn_above{};
  std::string reason{};  ///< one sentence: where the bounds come from, or why there is none

  bool judges() const { return at_least || at_most || warn_below || warn_above; }
  /// Not failed. NaN fails.
  bool passed() const { return (!at_least || value >= *at_least) && (!at_most || value <= *at_most); }
  Verdict verdict() const {
    if (!judges()) return Verdict::told;
    if (!passed()) return Verdict::failed;
    const bool is_usual = (!warn_below || value >= *warn_below) && (!warn_above || value <= *warn_above);
    return is_usual ? Verdict::passed : Verdict::warned;
  }
};

using Report = std::vector<ReportRow>;

inline std::int64_t count_of(const Report& report, Verdict verdict) {
  return std::count_if(report.begin(), report.end(), [&](const ReportRow& row) { return row.verdict() == verdict; });
}

inline bool all_passed(const Report& report) { return count_of(report, Verdict::failed) == 0; }

}  // namespace heartgen
