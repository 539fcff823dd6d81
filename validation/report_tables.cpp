#include "validation/report_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "validation/html_text.hpp"

namespace heart::validation {
namespace {

std::string words(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return escaped(name);
}

std::string unit_text(const std::string& unit) {
  if (unit == "1" || unit == "count") return "";
  if (unit == "deg") return "\u00B0";
  if (unit == "mm3") return " mm\u00B3";
  if (unit == "cm2") return " cm\u00B2";
  return fmt::format(" {}", escaped(unit));
}

std::string bound_text(const ReportRow& row) {
  const std::string unit = unit_text(row.unit);
  if (row.at_least && row.at_most) return readable(*row.at_least) + " to " + readable(*row.at_most) + unit;
  if (row.at_least) return "\u2265 " + readable(*row.at_least) + unit;
  if (row.at_most)
    return fmt::format("{}{}{}", *row.at_most == 0 ? "must be " : "\u2264 ", readable(*row.at_most), unit);
  return "";
}

std::string status(const ReportRow& row) {
  if (!row.judges()) return "";
  return row.passed() ? "<span class=\"pill good\">passed</span>" : "<span class=\"pill bad\">failed</span>";
}

std::string pill(const Counts& verdict) {
  if (verdict.judged == 0) return "<span class=\"pill none\">measured</span>";
  if (verdict.failed == 0) return fmt::format("<span class=\"pill good\">{} passed</span>", verdict.judged);
  return fmt::format("<span class=\"pill bad\">{} of {} failed</span>", verdict.failed, verdict.judged);
}

std::string table(const std::vector<const ReportRow*>& rows, bool with_scope) {
  std::string html = "<div class=\"scroll\"><table><thead><tr>";
  if (with_scope) html += "<th>where</th>";
  html += "<th>measure</th><th class=\"value\">value</th><th>bound</th><th></th></tr></thead><tbody>\n";
  for (const ReportRow* row : rows) {
    html += row->judges() && !row->passed() ? "<tr class=\"fail\">" : "<tr>";
    if (with_scope) html += "<td>" + words(row->scope) + "</td>";
    html += fmt::format("<td>{}</td><td class=\"value\">{}{}</td><td class=\"bound\">{}</td><td>{}</td></tr>\n",
                        words(row->metric), readable(row->value), unit_text(row->unit), bound_text(*row), status(*row));
  }
  return html + "</tbody></table></div>\n";
}

Counts counts_of_rows(const std::vector<const ReportRow*>& rows) {
  Counts verdict;
  for (const ReportRow* row : rows) verdict.judged += row->judges(), verdict.failed += row->judges() && !row->passed();
  return verdict;
}

using RowsByScope = std::vector<std::pair<std::string, std::vector<const ReportRow*>>>;

/// Rows of one group by scope, in the order of their first appearance.
RowsByScope by_scope(const Report& report, const std::string& group) {
  RowsByScope scopes;
  for (const ReportRow& row : report) {
    if (row.group != group) continue;
    const auto at = std::find_if(scopes.begin(), scopes.end(), [&](const auto& s) { return s.first == row.scope; });
    if (at == scopes.end())
      scopes.push_back({row.scope, {&row}});
    else
      at->second.push_back(&row);
  }
  return scopes;
}

/// One line per scope, one column per metric: for groups whose scopes share a few metrics.
std::string pivot(const RowsByScope& scopes, const std::vector<std::pair<std::string, std::string>>& metrics) {
  std::string html = "<div class=\"scroll\"><table><thead><tr><th></th>";
  for (const auto& [metric, unit] : metrics)
    html += fmt::format("<th class=\"value\">{}{}</th>", words(metric), unit.empty() ? "" : fmt::format(" ({})", unit));
  html += "</tr></thead><tbody>\n";
  for (const auto& [scope, rows] : scopes) {
    html += "<tr><td>" + words(scope) + "</td>";
    for (const auto& [metric, unit] : metrics) {
      const auto at =
          std::find_if(rows.begin(), rows.end(), [&name = metric](const auto* r) { return r->metric == name; });
      if (at == rows.end()) {
        html += "<td></td>";
        continue;
      }
      const ReportRow& row = **at;
      const char* tone = !row.judges() ? "" : row.passed() ? " good" : " bad";
      html += fmt::format("<td class=\"value{}\" title=\"{}\">{}</td>", tone, bound_text(row), readable(row.value));
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

/// Metrics with their units in the order of their first appearance.
std::vector<std::pair<std::string, std::string>> metrics_of(const RowsByScope& scopes) {
  std::vector<std::pair<std::string, std::string>> metrics;
  for (const auto& [scope, rows] : scopes)
    for (const ReportRow* row : rows) {
      const auto same = [row](const auto& m) { return m.first == row->metric; };
      if (std::none_of(metrics.begin(), metrics.end(), same))
        metrics.emplace_back(row->metric, row->unit == "1" || row->unit == "count" ? "" : escaped(row->unit));
    }
  return metrics;
}

/// Scopes that measure the same things, in the order of their first appearance: surfaces apart from regions.
std::vector<RowsByScope> scopes_alike(const RowsByScope& scopes) {
  std::vector<RowsByScope> tables;
  for (const auto& scope : scopes) {
    const auto shares_a_metric = [&](const RowsByScope& table) {
      for (const auto& [metric, unit] : metrics_of(table))
        for (const ReportRow* row : scope.second)
          if (row->metric == metric) return true;
      return false;
    };
    const auto at = std::find_if(tables.begin(), tables.end(), shares_a_metric);
    if (at == tables.end())
      tables.push_back({scope});
    else
      at->push_back(scope);
  }
  return tables;
}

/// A pivot where that is shorter than a list and fits the page.
std::string compact(const RowsByScope& scopes) {
  constexpr std::size_t fewest_scopes = 3, most_metrics = 9;
  const auto metrics = metrics_of(scopes);
  if (scopes.size() >= fewest_scopes && metrics.size() <= most_metrics) return pivot(scopes, metrics);
  std::vector<const ReportRow*> all;
  for (const auto& [scope, rows] : scopes) all.insert(all.end(), rows.begin(), rows.end());
  return table(all, true);
}

std::string block(const std::string& title, const std::string& pill_html, const std::string& inside) {
  return fmt::format("<details><summary>{}{}</summary>\n{}</details>\n", words(title), pill_html, inside);
}

/// "myocardium" and everything in "myocardium/...".
std::string scope_block(const std::string& top, const RowsByScope& scopes) {
  std::string inside, parts;
  std::vector<const ReportRow*> all;
  for (const auto& [scope, rows] : scopes) {
    if (scope == top) {
      inside += table(rows, false);
    } else if (scope.compare(0, top.size() + 1, top + "/") == 0) {
      parts += block(scope.substr(top.size() + 1), pill(counts_of_rows(rows)), table(rows, false));
    } else {
      continue;
    }
    all.insert(all.end(), rows.begin(), rows.end());
  }
  const Counts verdict = counts_of_rows(all);
  return block(top, pill(verdict), inside + parts);
}

std::string group_title(const std::string& group) {
  const std::map<std::string, std::string> titles = {
      {"mesh", "Meshes"}, {"fibers", "Fibres"}, {"fit", "Fit of the contours to the image"}, {"labels", "Label map"}};
  const auto at = titles.find(group);
  return at == titles.end() ? words(group) : at->second;
}

}  // namespace

Counts counts_of(const Report& report) {
  Counts verdict;
  for (const ReportRow& row : report) verdict.judged += row.judges(), verdict.failed += row.judges() && !row.passed();
  return verdict;
}

std::string readable(double value) {
  if (!std::isfinite(value)) return std::isnan(value) ? "not a number" : value > 0 ? "infinite" : "-infinite";
  if (value == 0) return "0";
  const bool whole = value == std::round(value) && std::abs(value) < 1e15;
  if (!whole && std::abs(value) < 1000) return fmt::format("{:.4g}", value);
  std::string digits = fmt::format("{:.0f}", std::abs(value));
  for (auto at = static_cast<std::ptrdiff_t>(digits.size()) - 3; at > 0; at -= 3)
    digits.insert(static_cast<std::size_t>(at), "\u202F");

  return fmt::format("{}{}", value < 0 ? "-" : "", digits);
}

std::optional<double> row_value(const Report& report, std::string_view group, std::string_view scope,
                                std::string_view metric) {
  for (const ReportRow& row : report)
    if (row.group == group && row.scope == scope && row.metric == metric) return row.value;
  return std::nullopt;
}

std::string failed_rows_html(const Report& report) {
  std::vector<const ReportRow*> failed;
  for (const ReportRow& row : report)
    if (row.judges() && !row.passed()) failed.push_back(&row);
  return failed.empty() ? "" : table(failed, true);
}

std::string certificate_html(const Report& report) {
  std::vector<std::string> groups;
  for (const ReportRow& row : report)
    if (std::find(groups.begin(), groups.end(), row.group) == groups.end()) groups.push_back(row.group);
  std::string html;
  for (const auto& group : groups) {
    html += "<h3>" + group_title(group) + "</h3>\n";
    const RowsByScope scopes = by_scope(report, group);
    if (group != "mesh") {
      for (const RowsByScope& alike : scopes_alike(scopes)) html += compact(alike);
      continue;
    }
    std::vector<std::string> tops;
    for (const auto& [scope, rows] : scopes) {
      const std::string top = scope.substr(0, scope.find('/'));
      if (std::find(tops.begin(), tops.end(), top) == tops.end()) tops.push_back(top);
    }
    for (const auto& top : tops) html += scope_block(top, scopes);
  }
  return html;
}

}  // namespace heart::validation
