// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/report/report_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <span>
#include <vector>

#include "validation/report/glossary.hpp"
#include "validation/report/html_text.hpp"

namespace heartgen::report {
namespace {

struct Counts {
  std::int64_t passed = 0, warned = 0, failed = 0;
};

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

std::string between(const std::optional<double>& low, const std::optional<double>& high, const std::string& unit) {
  if (low && high) return readable(*low) + " to " + readable(*high) + unit;
  if (low) return "\u2265 " + readable(*low) + unit;
  return high ? (*high == 0 ? "must be 0" : "\u2264 " + readable(*high) + unit) : "";
}

/// "30 to 145\u00B0, usually 35 to 140\u00B0"
std::string bound_text(const ReportRow& row) {
  const std::string unit = unit_text(row.unit);
  const std::string bound = between(row.at_least, row.at_most, unit);
  const std::string usual = between(row.warn_below, row.warn_above, unit);
  if (usual.empty()) return bound;
  return bound + (bound.empty() ? "" : ", ") + "usually " + usual;
}

struct Tone {
  const char* css;
  const char* word;
};

Tone tone_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::failed:
      return {"bad", "failed"};
    case Verdict::warned:
      return {"note", "warning"};
    case Verdict::passed:
      return {"good", "passed"};
    default:
      return {"none", ""};
  }
}

std::string status(const ReportRow& row) {
  const Tone tone = tone_of(row.verdict());
  return row.judges() ? fmt::format("<span class=\"pill {}\">{}</span>", tone.css, tone.word) : "";
}

std::string pill(const Counts& counts) {
  std::string html;
  const auto add = [&](Verdict verdict, std::int64_t count) {
    if (count > 0)
      html += fmt::format("<span class=\"pill {}\">{} {}</span>", tone_of(verdict).css, count, tone_of(verdict).word);
  };
  add(Verdict::failed, counts.failed), add(Verdict::warned, counts.warned), add(Verdict::passed, counts.passed);
  return html.empty() ? "<span class=\"pill none\">measured</span>" : html;
}

/// The metric, which tells what it means when touched.
std::string term(const std::string& metric) {
  const std::string meaning = meaning_of(metric);
  if (meaning.empty()) return words(metric);
  return fmt::format("<button type=\"button\" class=\"term\" data-term=\"{}\" title=\"{}\">{}</button>",
                     escaped(metric), escaped(meaning), words(metric));
}

std::string reason_html(const ReportRow& row) {
  return row.reason.empty() ? "" : "<small>" + escaped(row.reason) + "</small>";
}

std::string table(const std::vector<const ReportRow*>& rows, bool with_scope) {
  std::string html = "<div class=\"scroll\"><table><thead><tr>";
  if (with_scope) html += "<th>where</th>";
  html += "<th>measure</th><th class=\"value\">value</th><th>bound</th><th></th></tr></thead><tbody>\n";
  for (const ReportRow* row : rows) {
    const Verdict verdict = row->verdict();
    html += verdict == Verdict::failed   ? "<tr class=\"fail\">"
            : verdict == Verdict::warned ? "<tr class=\"warn\">"
                                         : "<tr>";
    if (with_scope) html += "<td>" + words(row->scope) + "</td>";
    html += fmt::format("<td>{}</td><td class=\"value\">{}{}</td><td class=\"bound\">{}{}</td><td>{}</td></tr>\n",
                        term(row->metric), readable(row->value), unit_text(row->unit), bound_text(*row),
                        reason_html(*row), status(*row));
  }
  return html + "</tbody></table></div>\n";
}

Counts counts_of_rows(const std::vector<const ReportRow*>& rows) {
  Counts counts;
  for (const ReportRow* row : rows) {
    const Verdict verdict = row->verdict();
    counts.failed += verdict == Verdict::failed;
    counts.warned += verdict == Verdict::warned;
    counts.passed += verdict == Verdict::passed;
  }
  return counts;
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

/// Under a table without room for them: bounds and their reasons, each once.
std::string bounds_of_metrics(const RowsByScope& scopes) {
  std::vector<std::string> lines;
  for (const auto& [scope, rows] : scopes)
    for (const ReportRow* row : rows) {
      if (!row->judges() || row->reason.empty()) continue;
      std::string line = fmt::format("<li>{}: {}</li>\n", words(row->metric), escaped(row->reason));
      if (std::find(lines.begin(), lines.end(), line) == lines.end()) lines.push_back(std::move(line));
    }
  if (lines.empty()) return "";
  return fmt::format("<ul class=\"reasons\">\n{}</ul>\n", fmt::join(lines, ""));
}

/// One line per scope, one column per metric: for groups whose scopes share a few metrics.
std::string pivot(const RowsByScope& scopes, const std::vector<std::pair<std::string, std::string>>& metrics) {
  std::string html = "<div class=\"scroll\"><table><thead><tr><th></th>";
  for (const auto& [metric, unit] : metrics)
    html += fmt::format("<th class=\"value\">{}{}</th>", term(metric), unit.empty() ? "" : fmt::format(" ({})", unit));
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
      html += fmt::format("<td class=\"value {}\" title=\"{}\">{}</td>", tone_of(row.verdict()).css, bound_text(row),
                          readable(row.value));
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n" + bounds_of_metrics(scopes);
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
  constexpr std::size_t min_scopes = 3, max_metrics = 9;
  const auto metrics = metrics_of(scopes);
  if (scopes.size() >= min_scopes && metrics.size() <= max_metrics) return pivot(scopes, metrics);
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

/// What of the view a scope is about: the last of its names that it can show.
std::string shown_name(const std::string& scope, const ShownNames& shown) {
  std::string found, name;
  const auto end_name = [&] {
    if (shown.count(name)) found = name;
    name.clear();
  };
  for (const char c : scope)
    if (std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '.')
      name += c;
    else
      end_name();
  end_name();
  return found.empty() && scope == "ventricles" && shown.count("myocardium") ? "myocardium" : found;
}

/// The colour of the view that tells of a metric.
const char* color_of(const std::string& metric) {
  static constexpr std::pair<std::string_view, const char*> colors[] = {
      {"helix", "helix"},         {"wall_thickness", "thickness"},  {"rule_difference", "difference"},
      {"second", "difference"},   {"inpainted", "source"},          {"nodes_without", "source"},
      {"dihedral", "quality"},    {"radius_ratio", "quality"},      {"scaled_jacobian", "quality"},
      {"inverted", "quality"},    {"non_orthogonality", "quality"}, {"skewness", "quality"},
      {"neighbour_jump", "helix"}};
  for (const auto& [start, color] : colors)
    if (metric.starts_with(start)) return color;
  return "region";
}

std::string show_link(const ReportRow& row, const ShownNames& shown) {
  const std::string name = shown_name(row.scope, shown);
  if (name.empty()) return "";
  return fmt::format("<a class=\"show\" href=\"#view\" data-show=\"{}\" data-color=\"{}\">show in 3D</a>",
                     escaped(name), color_of(row.metric));
}

using Rows = std::vector<const ReportRow*>;

bool is_same_measure(const ReportRow& a, const ReportRow& b) {
  return a.metric == b.metric && a.verdict() == b.verdict() && bound_text(a) == bound_text(b) && a.reason == b.reason;
}

/// The failed rows, then those that warn; rows of the same measure stand together.
Rows flagged_rows(const Report& report) {
  Rows rows;
  for (const Verdict verdict : {Verdict::failed, Verdict::warned})
    for (const ReportRow& row : report) {
      if (row.verdict() != verdict) continue;
      const auto last =
          std::find_if(rows.rbegin(), rows.rend(), [&](const auto* r) { return is_same_measure(*r, row); });
      rows.insert(last == rows.rend() ? rows.end() : last.base(), &row);
    }
  return rows;
}

std::string flagged_place(const ReportRow& row, const ShownNames& shown) {
  return fmt::format("<p><b>{}</b> <strong>{}{}</strong>{}</p>\n", words(row.scope), readable(row.value),
                     unit_text(row.unit), show_link(row, shown));
}

/// An entry for each measure: what it is and its bound, then the places.
std::string flagged_list(std::span<const ReportRow* const> rows, const ShownNames& shown) {
  std::string html = "<ul class=\"flagged\">\n";
  for (auto row = rows.begin(); row != rows.end();) {
    const ReportRow& first = **row;
    html += fmt::format("<li class=\"{}\">{}<div>{} <span>{}</span>{}\n",
                        first.verdict() == Verdict::failed ? "fail" : "warn", status(first), term(first.metric),
                        bound_text(first), reason_html(first));
    for (; row != rows.end() && is_same_measure(**row, first); ++row) html += flagged_place(**row, shown);
    html += "</div></li>\n";
  }
  return html + "</ul>\n";
}

std::string group_title(const std::string& group) {
  const std::map<std::string, std::string> titles = {{"mesh", "Meshes"},
                                                     {"anatomy", "Anatomy"},
                                                     {"fibers", "Fibres"},
                                                     {"fit", "Fit of the contours to the image"},
                                                     {"labels", "Label map"},
                                                     {"cavities", "Cavities"},
                                                     {"insulation", "Insulation of atria and ventricles"},
                                                     {"regions", "Regions of the user's own"}};
  const auto at = titles.find(group);
  return at == titles.end() ? words(group) : at->second;
}

}  // namespace

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

std::string flagged_rows_html(const Report& report, const ShownNames& shown) {
  constexpr std::size_t max_open = 6;
  const Rows all = flagged_rows(report);
  const std::span<const ReportRow* const> rows(all);
  if (rows.empty()) return "";
  if (rows.size() <= max_open) return flagged_list(rows, shown);
  return flagged_list(rows.first(max_open), shown) + fmt::format("<details><summary>{} more</summary>\n{}</details>\n",
                                                                 rows.size() - max_open,
                                                                 flagged_list(rows.subspan(max_open), shown));
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

std::string terms_html(const Report& report) {
  std::map<std::string, std::string> terms;
  for (const ReportRow& row : report)
    if (auto meaning = meaning_of(row.metric); !meaning.empty()) terms[row.metric] = std::move(meaning);
  if (terms.empty()) return "";
  std::string html = "<dl>\n";
  for (const auto& [metric, meaning] : terms)
    html += fmt::format("<dt>{}</dt><dd id=\"term-{}\">{}</dd>\n", words(metric), escaped(metric), escaped(meaning));
  return html + "</dl>\n";
}

}  // namespace heartgen::report
