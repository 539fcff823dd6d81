#include "validation/report_html.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/labels.hpp"
#include "validation/html_text.hpp"
#include "validation/report_sections.hpp"
#include "validation/report_tables.hpp"
#include "web_assets.hpp"

namespace heart::validation {
namespace {

std::string verdict_html(const Certificate* certificate) {
  const auto box = [](const char* tone, const std::string& title, const std::string& text) {
    return fmt::format(
        "<div class=\"verdict {}\"><i class=\"lamp\"></i><div><strong>{}</strong><span>{}</span></div></div>\n", tone,
        title, text);
  };
  const Report* report = certificate ? &certificate->rows : nullptr;
  const Counts verdict = report ? counts_of(*report) : Counts{};
  if (verdict.judged == 0)
    return box("", "Nothing was judged", "No measure in this report has a bound. It shows, and does not certify.");
  if (verdict.failed == 0)
    return box("good", fmt::format("All {} checks passed", verdict.judged),
               fmt::format("{} measures in all; those without a bound inform and do not judge.", report->size()));
  return box("bad", fmt::format("{} of {} checks failed", verdict.failed, verdict.judged),
             "The failed ones are listed first, under Certificate.");
}

bool has_mesh(const ReportInput& input, const char* name) {
  return input.meshes && input.meshes->count(name) && !input.meshes->at(name).cells.empty();
}

/// What a reader must know before trusting a picture.
std::vector<std::string> notes(const ReportInput& input) {
  std::vector<std::string> list;
  if (input.certificate)
    for (const auto& warning : input.certificate->warnings) list.push_back(warning.text);
  if (!input.labels) list.push_back("There is no label map in this report.");
  if (!has_mesh(input, "myocardium"))
    list.push_back("There is no mesh of the myocardium.");
  else if (input.meshes->at("myocardium").node_fibers.fiber.empty())
    list.push_back("The myocardium carries no fibres.");
  return list;
}

std::string notes_html(const ReportInput& input) {
  const auto list = notes(input);
  if (list.empty()) return "";
  std::string html = "<ul class=\"notes\">\n";
  for (const auto& note : list) html += "<li>" + escaped(note) + "</li>\n";
  return html + "</ul>\n";
}

std::string card(const std::string& value, const std::string& unit, const std::string& meaning) {
  return fmt::format("<div><b>{} <i>{}</i></b><span>{}</span></div>\n", value, unit, meaning);
}

std::string figures_html(const ReportInput& input) {
  std::string cards;
  if (input.certificate) {
    const auto value = [&](const char* group, const char* scope, const char* metric) {
      return row_value(input.certificate->rows, group, scope, metric);
    };
    const auto one = [](double v) { return fmt::format("{:.1f}", v); };
    const auto whole = [](double v) { return readable(std::round(v)); };
    if (const auto v = value("labels", "lv_blood", "volume")) cards += card(whole(*v), "ml", "left ventricle, blood");
    if (const auto v = value("labels", "rv_blood", "volume")) cards += card(whole(*v), "ml", "right ventricle, blood");
    if (const auto v = value("labels", "lv_myocardium", "volume"))
      cards += card(whole(*v), "ml", "left ventricle, wall");
    if (const auto v = value("labels", "lv_myocardium", "wall_thickness_median"))
      cards += card(one(*v), "mm", "left wall, median thickness");
    const auto low = value("mesh", "myocardium", "dihedral_min"), high = value("mesh", "myocardium", "dihedral_max");
    if (low && high)
      cards += card(fmt::format("{:.0f}\u2013{:.0f}", *low, *high), "\u00B0", "dihedral angles, myocardium");
  }
  for (const char* name : {"myocardium", "chambers", "torso", "trachea", "carotid"})
    if (has_mesh(input, name))
      cards += card(readable(static_cast<double>(input.meshes->at(name).cells.size())), "",
                    fmt::format("tetrahedra, {}", name));
  return cards.empty() ? "" : "<div class=\"figures\">\n" + cards + "</div>\n";
}

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
  return html.empty() ? "" : "<h2 id=\"provenance\">Where it comes from</h2>\n" + html;
}

std::string certificate_section(const ReportInput& input) {
  if (!input.certificate || input.certificate->rows.empty()) return "";
  std::string html = "<h2 id=\"certificate\">Certificate</h2>\n";
  const std::string failed = failed_rows_html(input.certificate->rows);
  if (!failed.empty()) html += "<h3>Failed</h3>\n" + failed;
  return html + certificate_html(input.certificate->rows);
}

/// Links to those sections that exist.
std::string navigation(const std::string& body) {
  std::string html = "<nav>";
  for (const auto& [id, title] : {std::pair{"view", "3D view"},
                                  {"image", "Contours"},
                                  {"meshes", "Meshes"},
                                  {"fibres", "Fibres"},
                                  {"certificate", "Certificate"},
                                  {"provenance", "Provenance"}})
    if (body.find(fmt::format("<h2 id=\"{}\"", id)) != std::string::npos)
      html += fmt::format("<a href=\"#{}\">{}</a>", id, title);
  return html + "</nav>\n";
}

}  // namespace

std::string make_report(const ReportInput& input) {
  const Shared shared = shared_by_pieces(input);
  Pieces pieces;
  for (const auto section : {viewer_section, slices_section, meshes_section, fibers_section})
    for (auto& piece : section(input, shared)) pieces.push_back(std::move(piece));
  const std::string body = joined(pieces) + certificate_section(input) + provenance_html(input);
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<title>" +
      escaped(input.name) + " " + escaped(input.version) + " \u2013 heart model report</title>\n<style>\n";
  html += report_style;
  html += "</style>\n</head>\n<body>\n<header>\n<p class=\"eyebrow\">Heart model report</p>\n<h1>" +
          escaped(input.name) + "<small>" + escaped(input.version) + "</small></h1>\n";
  html += verdict_html(input.certificate) + notes_html(input) + figures_html(input) + navigation(body);
  html += "</header>\n<main>\n" + body +
          "</main>\n<footer>Made by heartgen. For research; not a medical device. All coordinates "
          "are LPS millimetres.</footer>\n<script>\n";
  html += viewer_script;
  return html + "</script>\n</body>\n</html>\n";
}

}  // namespace heart::validation
