// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The certificate's bounds: which rows judge, by what, and why. They stand here alone; checks only measure.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "model/recipe.hpp"
#include "model/report.hpp"

namespace heartgen::validation {

/// Which parts of a model a criterion speaks of.
enum class Where : std::uint8_t { anywhere, whole_mesh, heart, wall, blood, outside_heart };

struct Bounds {
  std::optional<double> fail_below{}, warn_below{}, warn_above{}, fail_above{};
  bool judge() const { return fail_below || warn_below || warn_above || fail_above; }
};

/// The first criterion that fits a row counts. In `scope` and `metric` a '*' stands for any text.
struct Criterion {
  std::string group;
  Where where = Where::anywhere;
  std::string scope;
  std::string metric;
  Bounds bounds;       ///< none: the row informs
  std::string reason;  ///< one sentence: the source of the bounds, or why there are none
};

/// All criteria, those of a recipe's `settings` among them.
std::vector<Criterion> criteria(const ValidationSettings& settings);

/// The rows with the bounds and the reason of their criterion; rows that fit none stay as they are.
Report judged(Report rows, const ValidationSettings& settings);

}  // namespace heartgen::validation
