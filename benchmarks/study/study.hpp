// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What a study finds, as plain data, and writing it down: tables as CSV and Markdown, curves as SVG, pictures as PNG,
/// and one HTML page that holds them all. The same study gives the same bytes.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "benchmarks/study/field.hpp"
#include "validation/report/canvas.hpp"

namespace heartgen::study {

struct Table {
  std::string name;   ///< file name without extension
  std::string title;  ///< one sentence
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;
};

struct Curve {
  std::string name;
  std::vector<double> x, y;
};

/// On a logarithmic axis, values of 0 and below are drawn at the lower end.
struct Plot {
  std::string name, title, x_label, y_label;
  bool log_x = false, log_y = false;
  std::vector<Curve> curves;
};

struct Picture {
  std::string name, caption;
  report::Canvas pixels;
};

/// A statement of the thesis and what we measured of it.
struct Claim {
  std::string source;     ///< "5.1.1", "Table 5.2"
  std::string statement;  ///< in our words
  bool holds = false;
  std::string measured;
};

struct StudyResult {
  std::string name, title;
  std::string setup;  ///< a paragraph: what was computed, with which parameters, and what the thesis leaves open
  std::vector<Table> tables;
  std::vector<Plot> plots;
  std::vector<Picture> pictures;
  std::vector<Claim> claims;
};

/// Grey values from `black` to `white`, every pixel drawn `zoom` × `zoom`.
report::Canvas grey_picture(const Field& image, double black, double white, int zoom = 1);
/// From the least to the greatest value.
report::Canvas grey_picture(const Field& image, int zoom = 1);
/// One colour per class, 0 to 7.
report::Canvas class_picture(const PixelLabels& classes, int zoom = 1);
/// The border of the marked pixels, drawn over a picture of the same image and zoom.
void draw_border(report::Canvas& canvas, const PixelLabels& marked, int zoom, report::Rgb color);

std::string markdown(const Table& table);
std::string csv(const Table& table);
std::string svg(const Plot& plot);
/// "claims": source, statement, holds or not, measured.
Table claim_table(const StudyResult& study);

/// Writes FOLDER/NAME-*.{csv,md,svg,png} of every study and FOLDER/index.html. Throws UserError when it cannot.
void write_studies(const std::filesystem::path& folder, const std::vector<StudyResult>& studies);

}  // namespace heartgen::study
