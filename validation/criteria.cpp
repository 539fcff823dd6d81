// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/criteria.hpp"

#include <fmt/format.h>

#include <string_view>

#include "model/labels.hpp"
#include "validation/criteria_tables.hpp"

namespace heartgen::validation {
namespace {

/// `pattern` with '*' for any text.
bool fits(std::string_view pattern, std::string_view text) {
  std::size_t p = 0, t = 0, star = std::string_view::npos, resume = 0;
  while (t < text.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      resume = t;
    } else if (p < pattern.size() && pattern[p] == text[t]) {
      ++p, ++t;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      t = ++resume;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

/// The region that a scope ends in: "myocardium/lv_myocardium" or "lv_myocardium".
std::optional<Region> region_of(std::string_view scope) {
  const auto slash = scope.rfind('/');
  return region_from_name(std::string(slash == std::string_view::npos ? scope : scope.substr(slash + 1)));
}

bool fits(Where where, std::string_view scope) {
  if (where == Where::anywhere) return true;
  if (where == Where::whole_mesh) return scope.find('/') == std::string_view::npos;
  const auto region = region_of(scope);
  if (!region) return false;
  const bool is_heart = is_myocardium(*region) || is_blood(*region);
  switch (where) {
    case Where::heart:
      return is_heart;
    case Where::wall:
      return is_myocardium(*region) && *region != Region::papillary;
    case Where::blood:
      return is_blood(*region);
    default:
      return !is_heart;
  }
}

bool fits(const Criterion& criterion, const ReportRow& row) {
  return fits(criterion.group, row.group) && fits(criterion.metric, row.metric) && fits(criterion.scope, row.scope) &&
         fits(criterion.where, row.scope);
}

void append(std::vector<Criterion>& all, std::vector<Criterion> more) {
  for (auto& criterion : more) all.push_back(std::move(criterion));
}

}  // namespace

std::vector<Criterion> criteria(const ValidationSettings& settings) {
  std::vector<Criterion> all;
  append(all, mesh_criteria(settings));
  append(all, label_criteria(settings));
  append(all, anatomy_criteria());
  append(all, fiber_criteria(settings));
  append(all, fit_criteria());
  return all;
}

Report judged(Report rows, const ValidationSettings& settings) {
  const auto all = criteria(settings);
  for (auto& row : rows)
    for (const auto& criterion : all) {
      if (!fits(criterion, row)) continue;
      row.at_least = criterion.bounds.fail_below;
      row.at_most = criterion.bounds.fail_above;
      row.warn_below = criterion.bounds.warn_below;
      row.warn_above = criterion.bounds.warn_above;
      row.reason = criterion.reason;
      break;
    }
  return rows;
}

}  // namespace heartgen::validation
