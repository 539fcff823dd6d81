// The certificate's rows as HTML.
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "model/report.hpp"

namespace heart::validation {

struct Counts {
  std::size_t judged = 0, failed = 0;
};
Counts counts_of(const Report& report);

/// A number for people: at most four significant digits, thousands grouped, no exponent where it can be avoided.
std::string readable(double value);

/// The value of the first row with this group, scope and metric.
std::optional<double> row_value(const Report& report, std::string_view group, std::string_view scope,
                                std::string_view metric);

/// Rows that failed, in one table; empty when there are none.
std::string failed_rows_html(const Report& report);

/// All rows: a collapsible block per group and mesh (or region), parts of a mesh nested inside it.
std::string certificate_html(const Report& report);

}  // namespace heart::validation
