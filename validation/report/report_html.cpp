// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/report/report_html.hpp"

#include <fmt/format.h>

#include <set>

#include "model/labels.hpp"
#include "validation/report/html_text.hpp"
#include "validation/report/report_header.hpp"
#include "validation/report/report_methods.hpp"
#include "validation/report/report_sections.hpp"
#include "validation/report/report_tables.hpp"
#include "web_assets.hpp"

namespace heartgen::report {
namespace {

std::string pairs_table(const std::vector<std::pair<std::string, std::string>>& pairs, const char* left,
                        const char* right, const char* cell_class) {
  std::string html =
      fmt::format("<div class=\"scroll\"><table><thead><tr><th>{}</th><th>{}</th></tr></thead><tbody>\n", left, right);
  for (const auto& [a, b] : pairs)
    html += fmt::format("<tr><td>{}</td><td class=\"{}\">{}</td></tr>\n", escaped(a), cell_class, escaped(b));
  return html + "</tbody></table></div>\n";
}

std::string provenance_html(const ReportInput& input) {
  std::string html;
  if (!input.atlas_name.empty()) html += "<p>Fibre atlas: " + escaped(input.atlas_name) + "</p>\n";
  if (!input.inputs.empty()) html += "<h3>Inputs</h3>\n" + pairs_table(input.inputs, "input", "SHA-256", "hash");
  if (!input.tools.empty()) html += "<h3>Libraries</h3>\n" + pairs_table(input.tools, "library", "version", "");
  if (html.empty()) return "";
  return "<h2 id=\"provenance\">Where it comes from</h2>\n<details><summary>Atlas, inputs, libraries</summary><div "
         "class=\"inside\">\n" +
         html + "</div></details>\n";
}

/// What the 3D view knows by name.
ShownNames shown_names(const ReportInput& input) {
  ShownNames names;
  if (!input.meshes) return names;
  for (const auto& [mesh_name, mesh] : *input.meshes) {
    if (mesh.cells.empty()) continue;
    names.insert(mesh_name);
    for (const auto region : std::set(mesh.region.begin(), mesh.region.end())) names.insert(region_name(region));
    for (const auto surface : std::set(mesh.surface.begin(), mesh.surface.end())) names.insert(surface_name(surface));
  }
  return names;
}

Pieces flagged_section(const ReportInput& input, const Shared&) {
  if (!input.certificate) return {};
  const std::string rows = flagged_rows_html(input.certificate->rows, shown_names(input));
  if (rows.empty()) return {};
  return {[rows] { return "<h2 id=\"flagged\">What fails and what warns</h2>\n" + rows; }};
}

std::string certificate_section(const ReportInput& input) {
  if (!input.certificate || input.certificate->rows.empty()) return "";
  const Report& rows = input.certificate->rows;
  const std::string terms = terms_html(rows);
  return fmt::format(
             "<h2 id=\"certificate\">Certificate</h2>\n<details><summary>All {} measures</summary><div "
             "class=\"inside\">\n{}</div></details>\n",
             rows.size(), certificate_html(rows)) +
         (terms.empty() ? ""
                        : "<details id=\"terms\"><summary>What the words mean</summary>\n" + terms + "</details>\n");
}

/// Links to those sections that exist.
std::string navigation(const std::string& body) {
  std::string html = "<nav>";
  for (const auto& [id, title] : {std::pair{"view", "3D"},
                                  {"image", "Slices"},
                                  {"flagged", "What fails and warns"},
                                  {"charts", "Charts"},
                                  {"certificate", "Certificate"},
                                  {"methods", "Methods"},
                                  {"provenance", "Provenance"}})
    if (body.find(fmt::format("<h2 id=\"{}\"", id)) != std::string::npos)
      html += fmt::format("<a href=\"#{}\">{}</a>", id, title);
  return html + "</nav>\n";
}

}  // namespace

std::string make_report(const ReportInput& input) {
  const Shared shared = shared_by_pieces(input);
  Pieces pieces;
  for (const auto section : {viewer_section, slices_section, flagged_section, charts_section})
    for (auto& piece : section(input, shared)) pieces.push_back(std::move(piece));
  const std::string body = joined(pieces) + certificate_section(input) + methods_html(input) + provenance_html(input);
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<title>" +
      escaped(input.name) + " " + escaped(input.version) + " \u2013 heart model report</title>\n<style>\n";
  html += report_style;
  html += "</style>\n</head>\n<body>\n<header>\n" + header_html(input) + navigation(body);
  html += "</header>\n<main>\n" + body +
          "</main>\n<footer>Made by heartgen. For research; not a medical device. All coordinates "
          "are LPS millimetres.</footer>\n<script>\n";
  html += viewer_script;
  return html + "</script>\n</body>\n</html>\n";
}

}  // namespace heartgen::report
