// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/study/study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>

#include "model/error.hpp"
#include "model/text.hpp"
#include "validation/report/html_text.hpp"

namespace heartgen::study {
namespace {

using report::Canvas;
using report::escaped;
using report::Rgb;

constexpr std::array<Rgb, 8> class_colors = {{{38, 70, 83},
                                              {42, 157, 143},
                                              {233, 196, 106},
                                              {231, 111, 81},
                                              {120, 90, 160},
                                              {90, 160, 220},
                                              {200, 200, 200},
                                              {0, 0, 0}}};

constexpr const char* style = R"(<style>
body { font: 15px/1.5 system-ui, sans-serif; max-width: 68rem; margin: 2rem auto; padding: 0 1rem; color: #222; background: #fff; }
table { border-collapse: collapse; margin: 1rem 0; display: block; overflow-x: auto; }
th, td { border: 1px solid #ccc; padding: .25rem .6rem; text-align: right; } th { background: #f3f3f3; }
th:first-child, td:first-child, table.claims td, table.claims th { text-align: left; }
.yes { color: #16703c; font-weight: 600; } .no { color: #a8231c; font-weight: 600; }
figure { display: inline-block; margin: .5rem; vertical-align: top; } figcaption { font-size: 13px; max-width: 24rem; }
img { image-rendering: pixelated; border: 1px solid #ddd; } svg { max-width: 100%; }
</style>
)";

std::string table_html(const Table& table) {
  std::string html = fmt::format("<h3>{}</h3>\n<table><tr>", escaped(table.title));
  for (const auto& column : table.columns) html += fmt::format("<th>{}</th>", escaped(column));
  html += "</tr>\n";
  for (const auto& row : table.rows) {
    html += "<tr>";
    for (const auto& cell : row) html += fmt::format("<td>{}</td>", escaped(cell));
    html += "</tr>\n";
  }
  return html + "</table>\n";
}

std::string claims_html(const StudyResult& study) {
  if (study.claims.empty()) return "";
  std::string html =
      "<h3>What the thesis says, measured</h3>\n<table "
      "class=\"claims\"><tr><th>thesis</th><th>statement</th><th></th><th>measured</th></tr>\n";
  for (const auto& claim : study.claims)
    html += fmt::format("<tr><td>{}</td><td>{}</td><td class=\"{}\">{}</td><td>{}</td></tr>\n", escaped(claim.source),
                        escaped(claim.statement), claim.holds ? "yes" : "no", claim.holds ? "holds" : "does not hold",
                        escaped(claim.measured));
  return html + "</table>\n";
}

std::string study_html(const StudyResult& study) {
  std::string html =
      fmt::format("<h2 id=\"{}\">{}</h2>\n<p>{}</p>\n", study.name, escaped(study.title), escaped(study.setup));
  html += claims_html(study);
  for (const auto& table : study.tables) html += table_html(table);
  for (const auto& plot : study.plots) html += fmt::format("<figure>{}</figure>\n", svg(plot));
  for (const auto& picture : study.pictures)
    html += fmt::format("<figure><img alt=\"{0}\" src=\"{1}\"><figcaption>{0}</figcaption></figure>\n",
                        escaped(picture.caption), report::png_source(report::encode_png(picture.pixels)));
  return html;
}

std::string page_html(const std::vector<StudyResult>& studies) {
  std::string html =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Studies of the Chan-Vese "
      "model</title>\n";
  html += style;
  html +=
      "</head><body>\n<h1>Studies of the Chan-Vese model</h1>\n<p>Chapter 5 of Olivier Rousseau, Geometrical Modeling "
      "of the "
      "Heart (University of Ottawa, 2009), repeated on images of our own.</p>\n<ul>\n";
  for (const auto& study : studies) {
    const auto held = std::count_if(study.claims.begin(), study.claims.end(), [](const Claim& c) { return c.holds; });
    html += fmt::format("<li><a href=\"#{}\">{}</a>: {} of {} statements hold</li>\n", study.name, escaped(study.title),
                        held, study.claims.size());
  }
  html += "</ul>\n";
  for (const auto& study : studies) html += study_html(study);
  return html + "</body></html>\n";
}

std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted(1, '"');
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  quoted += '"';
  return quoted;
}

void write_bytes(const std::filesystem::path& path, const std::vector<std::uint8_t>& bytes) {
  write_text(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace

Canvas grey_picture(const Field& image, double black, double white, int zoom) {
  Canvas canvas(image.width * zoom, image.height * zoom, {});
  for (int y = 0; y < canvas.height; ++y)
    for (int x = 0; x < canvas.width; ++x) {
      const double share = (image(x / zoom, y / zoom) - black) / (white - black);
      const auto grey = static_cast<std::uint8_t>(std::clamp(255 * share + 0.5, 0.0, 255.0));
      canvas.pixels[canvas.at(x, y)] = {grey, grey, grey};
    }
  return canvas;
}

Canvas grey_picture(const Field& image, int zoom) {
  double low = image(0, 0), high = low;
  for (int j = 0; j < image.height; ++j)
    for (int i = 0; i < image.width; ++i) low = std::min(low, image(i, j)), high = std::max(high, image(i, j));
  return grey_picture(image, low, high > low ? high : low + 1, zoom);
}

Canvas class_picture(const PixelLabels& classes, int zoom) {
  Canvas canvas(classes.width * zoom, classes.height * zoom, {});
  for (int y = 0; y < canvas.height; ++y)
    for (int x = 0; x < canvas.width; ++x)
      canvas.pixels[canvas.at(x, y)] = class_colors[classes(x / zoom, y / zoom) % class_colors.size()];
  return canvas;
}

void draw_border(Canvas& canvas, const PixelLabels& marked, int zoom, Rgb color) {
  for (int j = 0; j < marked.height; ++j)
    for (int i = 0; i < marked.width; ++i) {
      if (i + 1 < marked.width && (marked(i, j) != 0) != (marked(i + 1, j) != 0))
        for (int y = j * zoom; y < (j + 1) * zoom; ++y)
          canvas.pixels[canvas.at((i + 1) * zoom - (zoom > 1), y)] = color;
      if (j + 1 < marked.height && (marked(i, j) != 0) != (marked(i, j + 1) != 0))
        for (int x = i * zoom; x < (i + 1) * zoom; ++x)
          canvas.pixels[canvas.at(x, (j + 1) * zoom - (zoom > 1))] = color;
    }
}

std::string markdown(const Table& table) {
  std::string text = table.title + "\n\n|", rule = "|";
  for (const auto& column : table.columns) text += fmt::format(" {} |", column), rule += " --- |";
  text += "\n" + rule + "\n";
  for (const auto& row : table.rows) {
    text += "|";
    for (std::string cell : row) {
      for (std::size_t bar = 0; (bar = cell.find('|', bar)) != std::string::npos; bar += 2) cell.insert(bar, 1, '\\');
      text += fmt::format(" {} |", cell);
    }
    text += "\n";
  }
  return text;
}

std::string csv(const Table& table) {
  std::string text;
  const auto line = [&](const std::vector<std::string>& cells) {
    for (std::size_t n = 0; n < cells.size(); ++n) text += fmt::format("{}{}", n ? "," : "", csv_cell(cells[n]));
    text += "\n";
  };
  line(table.columns);
  for (const auto& row : table.rows) line(row);
  return text;
}

Table claim_table(const StudyResult& study) {
  Table table{"claims", study.title + ": what the thesis says, measured", {"thesis", "statement", "", "measured"}, {}};
  for (const auto& claim : study.claims)
    table.rows.push_back({claim.source, claim.statement, claim.holds ? "holds" : "does not hold", claim.measured});
  return table;
}

void write_studies(const std::filesystem::path& folder, const std::vector<StudyResult>& studies) {
  for (const auto& study : studies) {
    std::vector<Table> tables = study.tables;
    if (!study.claims.empty()) tables.push_back(claim_table(study));
    for (const auto& table : tables) {
      write_text(folder / fmt::format("{}-{}.csv", study.name, table.name), csv(table));
      write_text(folder / fmt::format("{}-{}.md", study.name, table.name), markdown(table));
    }
    for (const auto& plot : study.plots)
      write_text(folder / fmt::format("{}-{}.svg", study.name, plot.name), svg(plot));
    for (const auto& picture : study.pictures)
      write_bytes(folder / fmt::format("{}-{}.png", study.name, picture.name), report::encode_png(picture.pixels));
  }
  write_text(folder / "index.html", page_html(studies));
}

}  // namespace heartgen::study
