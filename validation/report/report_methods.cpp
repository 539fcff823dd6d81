// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/report/report_methods.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "validation/report/html_text.hpp"
#include "validation/report/report_tables.hpp"

namespace heartgen::report {
namespace {

struct Paper {
  const char* key;
  const char* text;
};

constexpr Paper thesis = {"Rousseau 2009",
                          "O. Rousseau. Geometrical Modeling of the Heart. PhD thesis, University of Ottawa, 2009."};
constexpr Paper bayer = {
    "Bayer 2012",
    "J. D. Bayer, R. C. Blake, G. Plank, N. A. Trayanova. A novel rule-based algorithm for assigning "
    "myocardial fiber orientation to computational heart models. Ann. Biomed. Eng. 40:2243-2254, "
    "2012."};
constexpr Paper doste = {
    "Doste 2019",
    "R. Doste et al. A rule-based method to model myocardial fiber orientation in cardiac "
    "biventricular geometries with outflow tracts. Int. J. Numer. Meth. Biomed. Eng. 35:e3185, 2019."};
constexpr Paper piersanti = {"Piersanti 2021",
                             "R. Piersanti et al. Modeling cardiac muscle fibers in ventricular and atrial "
                             "electrophysiology simulations. Comput. Methods Appl. Mech. Eng. 373:113468, 2021."};
constexpr Paper streeter = {"Streeter 1969",
                            "D. D. Streeter et al. Fiber orientation in the canine left ventricle during diastole and "
                            "systole. Circ. Res. 24:339-347, 1969."};
constexpr Paper lombaert = {"Lombaert 2012",
                            "H. Lombaert et al. Human atlas of the cardiac fiber architecture: study on a healthy "
                            "population. IEEE Trans. Med. Imaging 31:1436-1447, 2012."};

const TetMesh* walls_of(const ReportInput& input) {
  if (!input.meshes) return nullptr;
  const auto at = input.meshes->find("myocardium");
  return at == input.meshes->end() || at->second.cells.empty() ? nullptr : &at->second;
}

bool has_input(const ReportInput& input, const std::string& role) {
  return std::any_of(input.inputs.begin(), input.inputs.end(),
                     [&](const auto& file) { return file.first.starts_with(role + ":"); });
}

std::string program(const ReportInput& input) {
  for (const auto& [tool, version] : input.tools)
    if (tool == "heartgen") return "heartgen " + version;
  return "heartgen";
}

bool has_source(const TetMesh& walls, FiberSource source) {
  return std::count(walls.fiber_source.begin(), walls.fiber_source.end(), static_cast<std::uint8_t>(source)) > 0;
}

/// Sentences, and the papers that they name.
struct Methods {
  std::string text;
  std::vector<Paper> papers;

  void cite(const Paper& paper) { papers.push_back(paper); }
};

void add_origin(Methods& methods, const ReportInput& input) {
  methods.text += fmt::format("The heart model {} {} was made with {}, which follows the method of {}. ", input.name,
                              input.version, program(input), thesis.key);
  methods.cite(thesis);
  if (has_input(input, "labels"))
    methods.text += "Its label map was given, and completed from the image where it lacked regions. ";
  else if (has_input(input, "ct"))
    methods.text += "Chambers, walls and surroundings were segmented in the CT. ";
}

void add_meshes(Methods& methods, const ReportInput& input) {
  if (!input.meshes || input.meshes->empty()) return;
  std::string list;
  for (const auto& [name, mesh] : *input.meshes) {
    if (mesh.cells.empty()) continue;
    list += fmt::format("{}{} ({} cells", list.empty() ? "" : ", ", name, readable(double(mesh.cells.size())));
    if (input.certificate)
      if (const auto edge = row_value(input.certificate->rows, "mesh", name, "edge_mean"))
        list += fmt::format(", mean edge {:.2f} mm", *edge);
    list += ")";
  }
  methods.text += "The label map was meshed with conforming tetrahedra: " + list + ". ";
}

void add_fibers(Methods& methods, const ReportInput& input) {
  const TetMesh* walls = walls_of(input);
  if (!walls || walls->node_fibers.fiber.empty()) return;
  if (!input.atlas_name.empty() && has_source(*walls, FiberSource::atlas))
    methods.text += fmt::format("Fibres of the ventricles were carried from the atlas \"{}\". ", input.atlas_name);
  if (has_source(*walls, FiberSource::inpainted))
    methods.text += "Where the atlas says nothing they were filled in from their surroundings. ";
  if (has_source(*walls, FiberSource::rule)) {
    methods.text += fmt::format("Elsewhere they follow rules: {} and {} in the ventricles, {} in the atria. ",
                                bayer.key, doste.key, piersanti.key);
    methods.cite(bayer), methods.cite(doste), methods.cite(piersanti);
  }
  methods.text += fmt::format("Helix angles are compared with {} and {}. ", streeter.key, lombaert.key);
  methods.cite(streeter), methods.cite(lombaert);
}

void add_certificate(Methods& methods, const ReportInput& input) {
  if (!input.certificate || input.certificate->rows.empty()) return;
  const Report& rows = input.certificate->rows;
  const auto judged = static_cast<std::int64_t>(rows.size()) - count_of(rows, Verdict::told);
  methods.text += fmt::format("Its certificate judges {} measures: {} fail, {} warn. ", judged,
                              count_of(rows, Verdict::failed), count_of(rows, Verdict::warned));
}

std::string copied(const char* id, const std::string& text, const char* element) {
  return fmt::format(
      "<button type=\"button\" class=\"copy\" data-copy=\"{0}\">copy</button><{2} id=\"{0}\">{1}</{2}>\n", id, text,
      element);
}

/// Braces and backslashes mean something in BibTeX.
std::string bibtex_text(const std::string& text) {
  std::string safe;
  for (const char c : text) safe += c == '{' || c == '}' || c == '\\' ? ' ' : c;
  return safe;
}

std::string bibtex(const ReportInput& input) {
  return fmt::format(
      "@misc{{heartmodel,\n  title = {{{} {}: a heart model made with heartgen}},\n  note = {{Model bundle; its "
      "content id is in manifest.json}}\n}}\n@software{{heartgen,\n  author = {{{{The heartgen developers}}}},\n  "
      "title = {{{}}},\n  note = {{GPL-3.0-or-later}}\n}}\n@phdthesis{{rousseau2009,\n  author = {{Olivier "
      "Rousseau}},\n"
      "  title = {{Geometrical Modeling of the Heart}},\n  school = {{University of Ottawa}},\n  year = {{2009}}\n}}\n",
      bibtex_text(input.name), bibtex_text(input.version), bibtex_text(program(input)));
}

}  // namespace

std::string methods_html(const ReportInput& input) {
  Methods methods;
  add_origin(methods, input), add_meshes(methods, input), add_fibers(methods, input), add_certificate(methods, input);
  std::string text = "<p>" + escaped(methods.text) + "</p>\n<ol class=\"papers\">\n";
  for (const Paper& paper : methods.papers) text += fmt::format("<li>{}: {}</li>\n", paper.key, paper.text);
  return "<h2 id=\"methods\">Methods and how to cite</h2>\n<details><summary>A paragraph to paste</summary>\n" +
         copied("methods-text", text + "</ol>", "div") + "</details>\n<details><summary>How to cite</summary>\n" +
         copied("cite-text", escaped(bibtex(input)), "pre") + "</details>\n";
}

}  // namespace heartgen::report
