// SPDX-License-Identifier: GPL-3.0-or-later
// Small charts as inline SVG. Text and axes use the page's colour (currentColor), so they follow light and dark pages.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "validation/report/html_text.hpp"
#include "validation/report/pictures.hpp"

namespace heartgen::report {
namespace {

constexpr double chart_width = 420, chart_height = 250;
constexpr double plot_left = 46, plot_right = 408, plot_top = 14, plot_bottom = 208;

std::string open_svg(const std::string& title) {
  return fmt::format(
      "<svg class=\"chart\" viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"{}\" "
      "xmlns=\"http://www.w3.org/2000/svg\">\n",
      chart_width, chart_height, escaped(title));
}

std::string text(double x, double y, const std::string& words, const char* anchor = "middle") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor, escaped(words));
}

std::string axis_lines() {
  return fmt::format("<path class=\"axis\" d=\"M{0} {1}V{2}H{3}\"/>\n", plot_left, plot_top, plot_bottom, plot_right);
}

double x_of(double value, double from, double to) {
  return plot_left + (value - from) / (to - from) * (plot_right - plot_left);
}

double y_of(double value, double from, double to) {
  return plot_bottom - (value - from) / (to - from) * (plot_bottom - plot_top);
}

/// A band between two curves, or nothing where there are fewer than two points.
std::string band(const std::vector<std::array<double, 3>>& points, const char* style) {
  if (points.size() < 2) return "";
  std::string path;
  for (std::size_t i = 0; i < points.size(); ++i)
    path += fmt::format("{}{:.1f} {:.1f}", i ? "L" : "M", points[i][0], points[i][1]);
  for (std::size_t i = points.size(); i-- > 0;) path += fmt::format("L{:.1f} {:.1f}", points[i][0], points[i][2]);
  return fmt::format("<path d=\"{}Z\" {}/>\n", path, style);
}

}  // namespace

std::string histogram_svg(const HistogramSeries& series, double from, double to, int bins, const std::string& unit) {
  std::vector<double> share(static_cast<std::size_t>(bins), 0);
  double low = 1e300, high = -1e300;
  for (const double v : series.values) {
    const auto bin = std::clamp(static_cast<int>((v - from) / (to - from) * bins), 0, bins - 1);
    share[static_cast<std::size_t>(bin)] += 100.0 / static_cast<double>(series.values.size());
    low = std::min(low, v), high = std::max(high, v);
  }
  const double peak = *std::max_element(share.begin(), share.end());
  const double top = std::max(1e-9, peak * 1.1);
  std::string svg = open_svg("histogram: " + series.name);
  for (int b = 0; b < bins; ++b) {
    const double x0 = x_of(from + (to - from) * b / bins, from, to),
                 x1 = x_of(from + (to - from) * (b + 1) / bins, from, to);
    const double y = y_of(share[static_cast<std::size_t>(b)], 0, top);
    if (plot_bottom - y > 0.05)
      svg += fmt::format("<rect class=\"bar\" x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\"/>\n",
                         x0 + 0.4, y, x1 - x0 - 0.8, plot_bottom - y);
  }
  svg += axis_lines();
  for (int tick = 0; tick <= 6; ++tick) {
    const double value = from + (to - from) * tick / 6;
    svg += text(x_of(value, from, to), plot_bottom + 16, fmt::format("{:g}", value));
  }
  svg += text((plot_left + plot_right) / 2, plot_bottom + 34, fmt::format("{} ({})", series.name, unit));
  svg += text(plot_left - 6, plot_top + 26, fmt::format("{:.0f}%", peak), "end");
  if (!series.values.empty())
    for (const auto& [value, name] : {std::pair{low, "min"}, {high, "max"}}) {
      const double x = std::clamp(x_of(value, from, to), plot_left, plot_right);
      svg += fmt::format("<path class=\"mark\" d=\"M{0:.1f} {1}V{2}\"/>\n", x, plot_top + 14, plot_bottom);
      const char* anchor = x > plot_right - 40 ? "end" : x < plot_left + 40 ? "start" : "middle";
      svg += text(x, plot_top + 10, fmt::format("{} {:.1f}", name, value), anchor);
    }
  return svg + "</svg>\n";
}

std::string helix_profile_svg(const std::vector<ProfileSeries>& series) {
  constexpr double low = -90, high = 90;
  std::string svg = open_svg("helix angle against wall depth");
  // Left ventricles of man and dog (Streeter et al. 1969, Lombaert et al. 2012), the ranges of the fibre certificate.
  svg += band({{x_of(0, 0, 1), y_of(80, low, high), y_of(40, low, high)},
               {x_of(0.5, 0, 1), y_of(20, low, high), y_of(-10, low, high)},
               {x_of(1, 0, 1), y_of(-30, low, high), y_of(-80, low, high)}},
              "class=\"published\"");
  for (const double value : {-90.0, -60.0, -30.0, 0.0, 30.0, 60.0, 90.0}) {
    const double y = y_of(value, low, high);
    svg += fmt::format("<path class=\"grid\" d=\"M{} {:.1f}H{}\"/>\n", plot_left, y, plot_right);
    svg += text(plot_left - 6, y + 4, fmt::format("{:.0f}\u00B0", value), "end");
  }
  for (std::size_t s = 0; s < series.size(); ++s) {
    std::vector<std::array<double, 3>> spread;
    std::string line;
    const ProfileSeries& p = series[s];
    for (std::size_t i = 0; i < p.depth.size(); ++i) {
      if (!std::isfinite(p.median_deg[i])) continue;
      const double x = x_of(p.depth[i], 0, 1);
      spread.push_back({x, y_of(p.p90_deg[i], low, high), y_of(p.p10_deg[i], low, high)});
      line += fmt::format("{}{:.1f} {:.1f}", line.empty() ? "M" : "L", x, y_of(p.median_deg[i], low, high));
    }
    svg += band(spread, fmt::format("class=\"spread s{}\"", s).c_str());
    if (!line.empty()) svg += fmt::format("<path class=\"line s{}\" d=\"{}\"/>\n", s, line);
    const double y = plot_top + 10 + 16 * static_cast<double>(s);
    svg += fmt::format("<path class=\"line s{0}\" d=\"M{1} {2}h18\"/>\n", s, plot_right - 128, y - 4);
    svg += text(plot_right - 104, y, p.name, "start");
  }
  svg += axis_lines();
  svg += text(plot_left, plot_bottom + 16, "endocardium", "start") +
         text(plot_right, plot_bottom + 16, "epicardium", "end");
  svg += text((plot_left + plot_right) / 2, plot_bottom + 34,
              "wall depth; colour: 10\u201390 % of the nodes; grey: published (LV)");
  return svg + "</svg>\n";
}

}  // namespace heartgen::report
