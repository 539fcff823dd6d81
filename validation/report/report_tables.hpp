// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The rows of a certificate as HTML tables, and numbers as people read them.
#pragma once
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "model/report.hpp"

namespace heartgen::report {

/// A number for people: at most four significant digits, thousands grouped, no exponent where it can be avoided.
std::string readable(double value);

/// The value of the first row with this group, scope and metric.
std::optional<double> row_value(const Report& report, std::string_view group, std::string_view scope,
                                std::string_view metric);

/// What the page's 3D view can show by name: regions, surfaces, meshes. Empty: there is no view, and no links to it.
using ShownNames = std::set<std::string>;

/// Rows that failed, then those that warn, in one table with links to their place; empty when there are none.
std::string flagged_rows_html(const Report& report, const ShownNames& shown);

/// All rows: a collapsible block per group and mesh (or region), parts of a mesh nested inside it.
std::string certificate_html(const Report& report);

/// A list of the words that these rows use; their ids are "term-" and the metric.
std::string terms_html(const Report& report);

}  // namespace heartgen::report
