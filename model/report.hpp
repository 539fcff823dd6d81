// Rows of a certificate: what was measured, where, against which bound.
#pragma once
#include <optional>
#include <string>
#include <vector>

namespace heart {

struct ReportRow {
  std::string group;   ///< "mesh", "fibers", "fit", "labels"
  std::string scope;   ///< mesh, region, surface or interface: "myocardium", "myocardium/lv_myocardium"
  std::string metric;  ///< "dihedral_min", "helix_angle_endocardium_median"
  double value = 0;
  std::string unit;                ///< "deg", "mm", "1", "count"
  std::optional<double> at_least;  ///< bound, if this row judges
  std::optional<double> at_most;

  bool judges() const { return at_least || at_most; }
  bool passed() const { return (!at_least || value >= *at_least) && (!at_most || value <= *at_most); }
};

using Report = std::vector<ReportRow>;

inline bool all_passed(const Report& report) {
  for (const auto& row : report)
    if (!row.passed()) return false;
  return true;
}

}  // namespace heart
