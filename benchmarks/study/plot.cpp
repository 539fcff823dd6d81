// SPDX-License-Identifier: GPL-3.0-or-later
// A line plot as SVG.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "benchmarks/study/study.hpp"
#include "model/mathematics.hpp"
#include "validation/report/html_text.hpp"

namespace heartgen::study {
namespace {

using report::escaped;

constexpr double left = 78, right = 470, top = 34, bottom = 330, width = 740, height = 384;
constexpr std::array<const char*, 8> inks = {"#1f5fa8", "#d1602a", "#2d8a4e", "#a83265",
                                             "#7a5cc2", "#8c6d1f", "#2a9aa5", "#555555"};

/// One axis: values to pixels, and where its ticks lie.
struct Axis {
  bool logarithmic = false;
  double low = 0, high = 1;  ///< in the axis's own measure: the value, or its decimal logarithm
  double pixel_low = 0, pixel_high = 1;

  double measure(double value) const { return logarithmic ? math::log10(std::max(value, 1e-300)) : value; }
  double pixel(double value) const {
    const double share = std::clamp((measure(value) - low) / (high - low), 0.0, 1.0);
    return pixel_low + share * (pixel_high - pixel_low);
  }
};

/// 1, 2 or 5 times a power of ten, about a fifth of the range.
double tick_step(double range) {
  const double power = math::pow(10, std::floor(math::log10(range / 5)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (range / (factor * power) <= 7) return factor * power;
  return 10 * power;
}

Axis make_axis(bool logarithmic, const std::vector<double>& values, double pixel_low, double pixel_high) {
  Axis axis{logarithmic, 1e300, -1e300, pixel_low, pixel_high};
  for (const double value : values) {
    if (!std::isfinite(value) || (logarithmic && value <= 0)) continue;
    axis.low = std::min(axis.low, axis.measure(value)), axis.high = std::max(axis.high, axis.measure(value));
  }
  if (axis.low > axis.high) axis.low = 0, axis.high = 1;
  if (axis.high - axis.low < 1e-12 * std::max(1.0, std::abs(axis.high))) axis.low -= 0.5, axis.high += 0.5;
  if (!logarithmic) {
    const double step = tick_step(axis.high - axis.low);
    axis.low = step * std::floor(axis.low / step), axis.high = step * std::ceil(axis.high / step);
  }
  return axis;
}

std::vector<double> ticks(const Axis& axis) {
  std::vector<double> at;
  if (axis.logarithmic) {
    const bool few = axis.high - axis.low < 2;
    for (int power = static_cast<int>(std::floor(axis.low)); power <= axis.high; ++power)
      for (const double factor : {1.0, 2.0, 5.0}) {
        const double place = power + math::log10(factor);
        if ((factor == 1 || few) && place >= axis.low - 1e-9 && place <= axis.high + 1e-9)
          at.push_back(factor * math::pow(10, power));
      }
    return at;
  }
  const double step = tick_step(axis.high - axis.low);
  const double first = std::round(axis.low / step);
  const int count = static_cast<int>(std::round((axis.high - axis.low) / step));
  for (int n = 0; n <= count; ++n) at.push_back((first + n) * step);
  return at;
}

std::string text(double x, double y, const std::string& words, const char* anchor, const char* more = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" {}>{}</text>\n", x, y, anchor, more,
                     escaped(words));
}

std::string frame(const Plot& plot, const Axis& x, const Axis& y) {
  std::string out;
  for (const double value : ticks(x)) {
    const double at = x.pixel(value);
    out += fmt::format("<path d=\"M{:.1f} {}V{}\" stroke=\"#e4e4e4\"/>\n", at, top, bottom);
    out += text(at, bottom + 18, fmt::format("{:g}", value), "middle");
  }
  for (const double value : ticks(y)) {
    const double at = y.pixel(value);
    out += fmt::format("<path d=\"M{} {:.1f}H{}\" stroke=\"#e4e4e4\"/>\n", left, at, right);
    out += text(left - 6, at + 4, fmt::format("{:g}", value), "end");
  }
  out += fmt::format("<path d=\"M{0} {1}V{2}H{3}\" fill=\"none\" stroke=\"#333\"/>\n", left, top, bottom, right);
  out += text((left + right) / 2, bottom + 40, plot.x_label, "middle");
  out += text(0, 0, plot.y_label, "middle",
              fmt::format("transform=\"translate(18 {:.1f}) rotate(-90)\"", (top + bottom) / 2).c_str());
  return out + text(left, 18, plot.title, "start", "font-weight=\"600\"");
}

std::string line(const Curve& curve, const Axis& x, const Axis& y, const char* ink) {
  std::string path, dots;
  for (std::size_t n = 0; n < curve.x.size(); ++n) {
    if (!std::isfinite(curve.y[n])) continue;
    const double px = x.pixel(curve.x[n]), py = y.pixel(curve.y[n]);
    path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", px, py);
    if (curve.x.size() <= 12)
      dots += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.6\" fill=\"{}\"/>\n", px, py, ink);
  }
  return fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.8\"/>\n", path, ink) + dots;
}

}  // namespace

std::string svg(const Plot& plot) {
  std::vector<double> all_x, all_y;
  for (const auto& curve : plot.curves) {
    all_x.insert(all_x.end(), curve.x.begin(), curve.x.end());
    all_y.insert(all_y.end(), curve.y.begin(), curve.y.end());
  }
  const Axis x = make_axis(plot.log_x, all_x, left, right), y = make_axis(plot.log_y, all_y, bottom, top);
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
      "font-family=\"system-ui, sans-serif\" font-size=\"12\" role=\"img\" aria-label=\"{2}\">\n"
      "<rect width=\"{0}\" height=\"{1}\" fill=\"#fff\"/>\n",
      width, height, escaped(plot.title));
  out += frame(plot, x, y);
  for (std::size_t n = 0; n < plot.curves.size(); ++n) {
    const char* ink = inks[n % inks.size()];
    const double at = top + 12 + 20 * static_cast<double>(n);
    out += line(plot.curves[n], x, y, ink);
    out += fmt::format("<path d=\"M{} {:.1f}h18\" stroke=\"{}\" stroke-width=\"2.4\"/>\n", right + 12, at - 4, ink);
    out += text(right + 36, at, plot.curves[n].name, "start");
  }
  return out + "</svg>\n";
}

}  // namespace heartgen::study
