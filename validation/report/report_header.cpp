// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/report/report_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "validation/report/html_text.hpp"
#include "validation/report/report_tables.hpp"

namespace heartgen::report {
namespace {

constexpr std::array<const char*, 3> level_css = {"none", "note", "bad"};    // by WarningLevel
constexpr std::array<const char*, 3> fitness_css = {"good", "note", "bad"};  // by Fitness

std::string use_words(const std::string& use) {
  static constexpr std::pair<const char*, const char*> names[] = {
      {"eikonal", "eikonal activation"}, {"monodomain", "monodomain and bidomain"},
      {"mechanics", "mechanics"},        {"ecg", "ECG and torso potentials"},
      {"blood_flow", "blood flow"},      {"finite_volumes", "finite volumes"}};
  for (const auto& [name, words] : names)
    if (use == name) return words;
  std::string words = use;
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 < words.size() ? ", " : " and ") + words[i];
  return text;
}

bool has_level(const Certificate& certificate, WarningLevel level) {
  return std::any_of(certificate.warnings.begin(), certificate.warnings.end(),
                     [level](const Warning& w) { return w.level == level; });
}

struct Headline {
  const char* tone;
  const char* text;
};

Headline headline(const Certificate& certificate) {
  switch (verdict_of(certificate)) {
    case Verdict::failed:
      return has_level(certificate, WarningLevel::doubt) ? Headline{"bad", "This model may be wrong as a whole."}
                                                         : Headline{"bad", "This model fails its certificate."};
    case Verdict::warned:
      return {"note", "This model passes its certificate, with warnings."};
    case Verdict::passed:
      return {"good", "This model passes its certificate."};
    default:
      return {"", "Nothing was judged."};
  }
}

std::string counts_sentence(const Report& rows) {
  const auto told = count_of(rows, Verdict::told), failed = count_of(rows, Verdict::failed);
  const auto warned = count_of(rows, Verdict::warned), judged = static_cast<std::int64_t>(rows.size()) - told;
  if (judged == 0) return "No measure in this report has a bound: it shows, and does not certify.";
  std::string text = fmt::format("Of {} judged measures ", judged);
  if (failed == 0 && warned == 0)
    text += "none fails and none warns";
  else
    text += fmt::format("{} fail{} and {} warn{}", failed, failed == 1 ? "s" : "", warned, warned == 1 ? "s" : "");
  return text + fmt::format("; {} more inform.", told);
}

std::string verdict_html(const Certificate& certificate) {
  const Headline head = headline(certificate);
  return fmt::format(
      "<div class=\"verdict {}\"><i class=\"lamp\"></i><div><strong>{}</strong><span>{} {}</span></div></div>\n",
      head.tone, head.text, counts_sentence(certificate.rows), escaped(uses_sentence(certificate.uses)));
}

std::string warning_html(const Warning& warning) {
  const auto level = static_cast<std::size_t>(warning.level);
  return fmt::format("<li><span class=\"pill {}\">{}</span> {} <code>{}</code></li>\n", level_css[level],
                     warning_level_names[level], escaped(warning.text), escaped(warning.code));
}

/// Doubts, then warnings; the notes folded where there are many.
std::string warnings_html(std::vector<Warning> warnings) {
  constexpr std::size_t max_open = 4;
  std::stable_sort(warnings.begin(), warnings.end(),
                   [](const Warning& a, const Warning& b) { return a.level > b.level; });
  const auto first_note =
      std::find_if(warnings.begin(), warnings.end(), [](const Warning& w) { return w.level == WarningLevel::note; });
  std::string open, folded;
  for (auto w = warnings.begin(); w != warnings.end(); ++w)
    (w < first_note || warnings.size() <= 2 ? open : folded) += warning_html(*w);
  if (static_cast<std::size_t>(first_note - warnings.begin()) > max_open) {
    folded.clear(), open.clear();
    for (std::size_t w = 0; w < warnings.size(); ++w) (w < max_open ? open : folded) += warning_html(warnings[w]);
  }
  std::string html;
  if (!open.empty()) html += "<ul class=\"notes\">\n" + open + "</ul>\n";
  if (!folded.empty()) {
    const auto count = std::count(folded.begin(), folded.end(), '\n');
    const bool are_notes = folded.find("pill note") == std::string::npos;
    html += fmt::format(
        "<details class=\"quiet\"><summary>{} {}{}</summary><ul class=\"notes plain\">\n{}</ul></details>\n", count,
        are_notes ? "note" : "more warning", count == 1 ? "" : "s", folded);
  }
  return html;
}

std::string use_row(const UseVerdict& use) {
  constexpr std::size_t open_reasons = 1;
  const auto fitness = static_cast<std::size_t>(use.fitness);
  std::string why, more;
  for (std::size_t r = 0; r < use.reasons.size(); ++r)
    (r < open_reasons ? why : more) += "<p>" + escaped(use.reasons[r]) + "</p>";
  if (!more.empty())
    why += fmt::format("<details><summary>{} more</summary>{}</details>", use.reasons.size() - open_reasons, more);
  if (!use.remedy.empty()) why += "<p class=\"remedy\">" + escaped(use.remedy) + "</p>";
  std::string words = use_words(use.use);
  words[0] = static_cast<char>(words[0] >= 'a' && words[0] <= 'z' ? words[0] - 'a' + 'A' : words[0]);
  return fmt::format("<tr><th>{}{}</th><td><span class=\"pill {}\">{}</span></td><td>{}</td></tr>\n", escaped(words),
                     use.is_asked ? " <small>asked for</small>" : "", fitness_css[fitness], fitness_names[fitness],
                     why);
}

std::string uses_html(const std::vector<UseVerdict>& uses) {
  if (uses.empty()) return "";
  std::string html =
      "<table class=\"uses\" id=\"uses\"><thead><tr><th>use</th><th>verdict</th><th>why, and what mends "
      "it</th></tr></thead><tbody>\n";
  for (const UseVerdict& use : uses) html += use_row(use);
  return html + "</tbody></table>\n";
}

std::string card(const std::string& value, const std::string& unit, const std::string& meaning) {
  return fmt::format("<div><b>{} <i>{}</i></b><span>{}</span></div>\n", value, unit, meaning);
}

std::string measured_cards(const Report& rows) {
  struct Figure {
    const char *group, *scope, *metric, *unit, *meaning;
    int decimals;
  };
  static constexpr Figure figures[] = {
      {"labels", "lv_blood", "volume", "ml", "left ventricle, blood", 0},
      {"labels", "rv_blood", "volume", "ml", "right ventricle, blood", 0},
      {"labels", "lv_myocardium", "volume", "ml", "left ventricle, wall", 0},
      {"labels", "lv_myocardium", "wall_thickness_median", "mm", "left wall, median thickness", 1}};
  std::string cards;
  for (const Figure& f : figures)
    if (const auto v = row_value(rows, f.group, f.scope, f.metric))
      cards += card(fmt::format("{:.{}f}", *v, f.decimals), f.unit, f.meaning);
  const auto low = row_value(rows, "mesh", "myocardium", "dihedral_min");
  const auto high = row_value(rows, "mesh", "myocardium", "dihedral_max");
  if (low && high)
    cards += card(fmt::format("{:.0f}\u2013{:.0f}", *low, *high), "\u00B0", "dihedral angles, myocardium");
  return cards;
}

std::string figures_html(const ReportInput& input) {
  std::string cards;
  if (input.certificate) cards += measured_cards(input.certificate->rows);
  for (const char* name : {"myocardium", "chambers", "torso"}) {
    if (!input.meshes || !input.meshes->count(name)) continue;
    const std::size_t cells = input.meshes->at(name).cells.size();
    if (cells > 0) cards += card(readable(static_cast<double>(cells)), "", fmt::format("tetrahedra, {}", name));
  }
  return cards.empty() ? "" : "<div class=\"figures\">\n" + cards + "</div>\n";
}

bool is_synthetic(const Certificate& certificate) {
  return std::any_of(certificate.warnings.begin(), certificate.warnings.end(),
                     [](const Warning& w) { return w.code == "image.synthetic"; });
}

/// What is not there, beside the certificate's own warnings.
std::vector<Warning> missing(const ReportInput& input) {
  std::vector<Warning> list;
  const auto add = [&](const char* code, const char* text) { list.push_back({code, WarningLevel::note, text}); };
  const auto walls = input.meshes ? input.meshes->find("myocardium") : std::map<std::string, TetMesh>::const_iterator{};
  if (!input.labels) add("report.labels", "There is no label map in this report.");
  if (!input.meshes || walls == input.meshes->end() || walls->second.cells.empty())
    add("report.myocardium", "There is no mesh of the myocardium.");
  else if (walls->second.node_fibers.fiber.empty())
    add("report.fibres", "The myocardium carries no fibres.");
  return list;
}

}  // namespace

std::string uses_sentence(const std::vector<UseVerdict>& uses) {
  std::array<std::vector<std::string>, 3> by_fitness;
  for (const UseVerdict& use : uses) by_fitness[static_cast<std::size_t>(use.fitness)].push_back(use_words(use.use));
  std::string text;
  for (std::size_t f = 0; f < by_fitness.size(); ++f)
    if (!by_fitness[f].empty())
      text += fmt::format("{}{} for {}", text.empty() ? "" : "; ", fitness_names[f], listed(by_fitness[f]));
  if (text.empty()) return text;
  text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text + ".";
}

std::string header_html(const ReportInput& input) {
  const Certificate none;
  const Certificate& certificate = input.certificate ? *input.certificate : none;
  std::string html = "<p class=\"eyebrow\">Heart model report";
  if (is_synthetic(certificate)) html += " <span class=\"pill note\">phantom: a synthetic image, not a patient</span>";
  html += "</p>\n<h1>" + escaped(input.name) + "<small>" + escaped(input.version) + "</small></h1>\n";
  auto warnings = certificate.warnings;
  for (Warning& warning : missing(input)) warnings.push_back(std::move(warning));
  return html + verdict_html(certificate) + warnings_html(std::move(warnings)) + uses_html(certificate.uses) +
         figures_html(input);
}

}  // namespace heartgen::report
