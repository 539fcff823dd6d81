// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "benchmarks/study/initial_conditions.hpp"
#include "benchmarks/study/length.hpp"
#include "benchmarks/study/studies.hpp"
#include "model/mathematics.hpp"

namespace heartgen::study {
namespace {

struct Estimator {
  std::string name;
  std::function<double(const Field&)> length;
  double printed;  ///< in Table 5.1
};

const std::vector<Estimator>& estimators() {
  static const std::vector<Estimator> all = {
      {"Gaussian (β = 2.5)", [](const Field& phi) { return gaussian_length(phi, 2.5); }, 623.0148349},
      {"Gaussian (β = 10)", [](const Field& phi) { return gaussian_length(phi, 10); }, 623.0177399},
      {"Heaviside", [](const Field& phi) { return heaviside_length(phi); }, 722.2914139},
      {"Smereka", [](const Field& phi) { return smereka_length(phi); }, 622.7586591},
      {"piecewise linear", [](const Field& phi) { return piecewise_linear_length(phi); }, 623.0202264},
  };
  return all;
}

constexpr int plane = 320;  // pixels; the Gaussian of width 10 fits around the circle
constexpr double radius = 100;
constexpr double on_a_pixel = 0.5 * plane, between_pixels = on_a_pixel - 0.5;  // centres of the circle
/// The radius for which the piecewise linear length is the one that the thesis prints.
constexpr double printed_radius = 99.1572214;
constexpr double real_length = 2 * std::numbers::pi * radius;

Field circle(double center, double r) { return circle_start(plane, plane, center, center, r); }

struct Sampled {
  std::string name;
  double center, radius;
};

const std::vector<Sampled>& sampled_circles() {
  static const std::vector<Sampled> all = {{"between pixels", between_pixels, radius},
                                           {"on a pixel", on_a_pixel, radius},
                                           {"between pixels, radius 99.1572214", between_pixels, printed_radius}};
  return all;
}

Table circumference_table() {
  Table table{"table-5-1",
              "Circumference of a circle of radius 100 (real length 628.3185307) from its signed distance function, "
              "pixels of side 1",
              {"centre", "Gaussian (β = 2.5)", "Gaussian (β = 10)", "Heaviside", "Smereka", "piecewise linear", "edges",
               "corners"},
              {}};
  std::vector<std::string> printed{"thesis, Table 5.1 (edges and corners follow from its Heaviside length)"};
  for (const auto& e : estimators()) printed.push_back(fmt::format("{:.7f}", e.printed));
  printed.insert(printed.end(), {"792", "119"});
  table.rows.push_back(printed);
  for (const auto& sampled : sampled_circles()) {
    const Field phi = circle(sampled.center, sampled.radius);
    std::vector<std::string> row{sampled.name};
    for (const auto& e : estimators()) row.push_back(fmt::format("{:.7f}", e.length(phi)));
    const EdgeCrossings found = edge_crossings(phi);
    row.insert(row.end(), {std::to_string(found.edges), std::to_string(found.corners)});
    table.rows.push_back(row);
  }
  return table;
}

/// The table's errors, each against the circle that was sampled (the thesis's: against the radius 100 that it states).
Plot circumference_plot() {
  const std::vector<double> numbers = {1, 2, 3, 4, 5};
  const auto percent = [](double length, double r) { return 100 * std::abs(length / (2 * std::numbers::pi * r) - 1); };
  Plot plot{"table-5-1",
            "Errors of the five lengths",
            "length, as in the table: 1, 2 Gaussian, 3 Heaviside, 4 Smereka",
            "error, percent",
            false,
            true,
            {{"thesis", numbers, {}}}};
  for (const auto& e : estimators()) plot.curves[0].y.push_back(percent(e.printed, radius));
  for (const auto& sampled : sampled_circles()) {
    const Field phi = circle(sampled.center, sampled.radius);
    plot.curves.push_back({sampled.name, numbers, {}});
    for (const auto& e : estimators()) plot.curves.back().y.push_back(percent(e.length(phi), sampled.radius));
  }
  return plot;
}

/// All estimators for a family of rescaled circles; x is the family's parameter.
Plot rescaled(const std::string& name, const std::string& title, const std::string& label, bool log_y,
              const std::vector<double>& parameters,
              const std::function<double(double phi, double parameter)>& rescale) {
  Plot plot{name, title, label, "length", false, log_y, {}};
  for (const auto& e : estimators()) plot.curves.push_back({e.name, parameters, {}});
  const Field distance = circle(between_pixels, radius);
  for (const double parameter : parameters) {
    Field phi = distance;
    for (int j = 0; j < plane; ++j)
      for (int i = 0; i < plane; ++i) phi(i, j) = rescale(distance(i, j), parameter);
    for (std::size_t n = 0; n < estimators().size(); ++n) plot.curves[n].y.push_back(estimators()[n].length(phi));
  }
  return plot;
}

Table table_of(const Plot& plot) {
  Table table{plot.name, plot.title, {plot.x_label}, {}};
  for (const auto& curve : plot.curves) table.columns.push_back(curve.name);
  for (std::size_t row = 0; row < plot.curves[0].x.size(); ++row) {
    table.rows.push_back({fmt::format("{:g}", plot.curves[0].x[row])});
    for (const auto& curve : plot.curves) table.rows.back().push_back(fmt::format("{:.4f}", curve.y[row]));
  }
  return table;
}

/// Largest relative deviation from the value at the parameter 1.
double drift(const Curve& curve) {
  const auto one = std::find(curve.x.begin(), curve.x.end(), 1.0) - curve.x.begin();
  double largest = 0;
  for (const double y : curve.y) largest = std::max(largest, std::abs(y / curve.y[static_cast<std::size_t>(one)] - 1));
  return largest;
}

double largest_error(const Curve& curve) {
  double largest = 0;
  for (const double y : curve.y) largest = std::max(largest, std::abs(y / real_length - 1));
  return largest;
}

Volume<double> sphere(int size, double r) {
  Grid grid;
  grid.size = {size, size, size};
  Volume<double> phi(grid);
  const double center = 0.5 * (size - 1);
  for (int k = 0; k < size; ++k)
    for (int j = 0; j < size; ++j)
      for (int i = 0; i < size; ++i)
        phi(i, j, k) =
            r - std::sqrt((i - center) * (i - center) + (j - center) * (j - center) + (k - center) * (k - center));
  return phi;
}

/// Relative errors of lengths and areas as the circle and the sphere grow: the order of each estimator.
Table refinement_table(bool quick) {
  Table table{"refinement",
              "Relative error in percent against the radius in pixels (centre between pixels)",
              {"radius", "circle: Gaussian (β = 2.5)", "Heaviside", "Smereka", "piecewise linear",
               "sphere: Gaussian (β = 2.5)", "Heaviside", "Smereka", "marching tetrahedra"},
              {}};
  for (const int r : quick ? std::vector<int>{5, 10, 20} : std::vector<int>{5, 10, 20, 40}) {
    const Field phi = circle_start(2 * r + 20, 2 * r + 20, r + 9.5, r + 9.5, r);
    const Volume<double> ball = sphere(2 * r + 20, r);
    const double length = 2 * std::numbers::pi * r, area = 4 * std::numbers::pi * r * r;
    std::vector<std::string> row{std::to_string(r)};
    for (const double found :
         {gaussian_length(phi, 2.5), heaviside_length(phi), smereka_length(phi), piecewise_linear_length(phi)})
      row.push_back(fmt::format("{:+.4f}", 100 * (found / length - 1)));
    for (const double found :
         {gaussian_area(ball, 2.5), heaviside_area(ball), smereka_area(ball), tetrahedra_area(ball)})
      row.push_back(fmt::format("{:+.4f}", 100 * (found / area - 1)));
    table.rows.push_back(row);
  }
  return table;
}

std::vector<Claim> claims(const Plot& powers, const Plot& multiples) {
  const auto percent = [](double share) { return fmt::format("{:.3g} %", 100 * share); };
  const Field phi = circle(between_pixels, radius);
  double worst = 0;
  for (const std::size_t n : {0u, 1u, 3u, 4u})
    worst = std::max(worst, std::abs(estimators()[n].length(phi) / real_length - 1));
  const double heaviside = std::abs(heaviside_length(phi) / real_length - 1);
  const double smereka = largest_error(powers.curves[3]), linear = largest_error(powers.curves[4]);
  return {
      {"Table 5.1", "the printed lengths come out to the printed digits", false,
       "not for any centre. The printed Heaviside length is 554 + 119 √2, that is 792 pixel edges and 119 corners on "
       "pixels of side 1: a disc that spans 198 pixels, not 200. A search over centres (in steps of 1/40 pixel) and "
       "radii (1/100) found no sampled circle with these two numbers. The thesis measured another shape, of "
       "effective radius 99.157 (last row: Gaussian, Smereka's and piecewise linear lengths then agree within 0.05 "
       "%, Heaviside within 0.4 %)"},
      {"Table 5.1", "on a signed distance function every method but the Heaviside one is accurate",
       worst < 1e-3 && heaviside > 0.1,
       fmt::format("largest error {}, Heaviside {}", percent(worst), percent(heaviside))},
      {"Fig 5.2", "the Gaussian is not robust to φ^d", drift(powers.curves[0]) > 0.2 && drift(powers.curves[1]) > 0.2,
       fmt::format("drift {} and {}", percent(drift(powers.curves[0])), percent(drift(powers.curves[1])))},
      {"Fig 5.2", "the Heaviside length is the same for every d", drift(powers.curves[2]) == 0,
       fmt::format("drift {}", percent(drift(powers.curves[2])))},
      {"Fig 5.2", "Smereka's and the piecewise linear length drift slowly with d",
       drift(powers.curves[3]) < 0.3 && drift(powers.curves[4]) < 0.3,
       fmt::format("at most {} and {} up to d = 11", percent(drift(powers.curves[3])),
                   percent(drift(powers.curves[4])))},
      {"Fig 5.2", "Smereka's stays the best approximation", smereka < linear,
       fmt::format("largest error {}, piecewise linear {}", percent(smereka), percent(linear))},
      {"Fig 5.3", "Smereka's and the piecewise linear length are the same for every m, the Gaussian is not",
       drift(multiples.curves[3]) < 1e-6 && drift(multiples.curves[4]) < 1e-12 && drift(multiples.curves[1]) > 0.01,
       fmt::format("drift {}, {} and {} (β = 10)", percent(drift(multiples.curves[3])),
                   percent(drift(multiples.curves[4])), percent(drift(multiples.curves[1])))},
  };
}

}  // namespace

StudyResult study_lengths(const StudySettings& settings) {
  if (settings.progress) settings.progress("five lengths of a circle and four areas of a sphere");
  const Plot powers = rescaled("fig-5-2", "Circumference against the power d of φ^d", "d", true, {1, 3, 5, 7, 9, 11},
                               [](double phi, double d) { return math::pow(phi, d); });
  const Plot multiples = rescaled("fig-5-3", "Circumference against the factor m of m φ", "m", false,
                                  {0.1, 0.25, 0.5, 1, 2, 4, 6, 8, 10}, [](double phi, double m) { return m * phi; });
  return {
      "lengths",
      "Length of an implicit curve (5.1.1)",
      fmt::format(
          "A circle of radius 100 on {0} × {0} pixels of side 1, φ its exact signed distance, forward differences, ε "
          "= 1e-10 in Smereka's formula. The thesis says neither the size of its plane nor where the centre lies.",
          plane),
      {circumference_table(), table_of(powers), table_of(multiples), refinement_table(settings.quick)},
      {circumference_plot(), powers, multiples},
      {},
      claims(powers, multiples)};
}

}  // namespace heartgen::study
