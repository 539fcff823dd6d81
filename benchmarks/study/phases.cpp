// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/study/phases.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "benchmarks/study/initial_conditions.hpp"
#include "benchmarks/study/length.hpp"
#include "model/mathematics.hpp"

namespace heartgen::study {
namespace {

double squared(double x) { return x * x; }

/// Means of the image per class of `classes` (0 to count - 1); an empty class keeps its old value.
void update_means(const Field& image, const PixelLabels& classes, std::vector<double>& c) {
  std::vector<double> sum(c.size(), 0), pixels(c.size(), 0);
  for (int j = 0; j < image.height; ++j)
    for (int i = 0; i < image.width; ++i) sum[classes(i, j)] += image(i, j), ++pixels[classes(i, j)];
  for (std::size_t k = 0; k < c.size(); ++k)
    if (pixels[k] > 0) c[k] = sum[k] / pixels[k];
}

/// Renumbers the classes by rising grey value.
void sort_classes(PhaseResult& result) {
  std::vector<std::size_t> order(result.c.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return result.c[a] < result.c[b]; });
  std::vector<std::uint8_t> rank(order.size());
  std::vector<double> c;
  for (std::size_t k = 0; k < order.size(); ++k)
    rank[order[k]] = static_cast<std::uint8_t>(k), c.push_back(result.c[order[k]]);
  for (auto& value : result.classes.values) value = rank[value];
  result.c = c;
}

/// +1 in the brighter of the two best classes of the pixels that `part` marks, -1 in the darker one; 0 elsewhere.
void add_two_classes(const Field& image, const PixelLabels& part, Field& phi) {
  const Domain domain = part_of_plane(part);
  const Field split = two_class_start(image, domain, Norm::l2);
  for (int j = 0; j < phi.height; ++j)
    for (int i = 0; i < phi.width; ++i) phi(i, j) += domain.inside(i, j) * split(i, j);
}

PixelLabels where(const Field& phi, bool positive) {
  PixelLabels part(phi.width, phi.height);
  for (int j = 0; j < phi.height; ++j)
    for (int i = 0; i < phi.width; ++i) part(i, j) = (phi(i, j) >= 0) == positive;
  return part;
}

/// Steps until no class changes. `classify` reads the phases off the level sets, `advance` moves them.
void run(PhaseResult& result, const PhaseSettings& s, const std::function<PixelLabels()>& classify,
         const std::function<void(const PhaseResult&)>& advance, const Field& image) {
  result.classes = classify();
  int calm = 0;
  while (result.iterations < s.max_iterations && !result.steady) {
    update_means(image, result.classes, result.c);
    advance(result);
    PixelLabels now = classify();
    calm = now.values == result.classes.values ? calm + 1 : 0;
    result.classes = std::move(now);
    ++result.iterations;
    result.steady = calm >= s.calm_iterations;
  }
  result.contours = result.classes;
  sort_classes(result);
}

/// One semi-explicit step with |∇phi| for δ; the force is in the work space.
void level_set_step(Field& phi, const Domain& domain, Workspace& w, const PhaseSettings& s) {
  take_differences(phi, domain, w.d);
  face_coefficients(w.d, domain, FaceRule::midpoint, flat_gradient, w.c);
  two_sided_norm(w.d, w.norm);
  semi_explicit_step(phi, domain, w, {s.time_step, s.mu}, w.norm, w.norm);
  keep_finite(phi);
}

/// The braces of (4.35) without the curvature: `bit` is the level set that moves, the class has its bit set where that
/// level set is >= 0, and the other bit follows the other level set.
void four_phase_force(const Field& image, const Field& other, const std::vector<double>& c, int bit, double lambda,
                      Field& force) {
  const std::size_t own = bit == 0 ? 1 : 2, second = bit == 0 ? 2 : 1;
  for (int j = 0; j < image.height; ++j)
    for (int i = 0; i < image.width; ++i) {
      const std::size_t base = other(i, j) >= 0 ? second : 0;
      force(i, j) = lambda * (squared(image(i, j) - c[base]) - squared(image(i, j) - c[base + own]));
    }
}

PixelLabels two_bits(const Field& first, const Field& second) {
  PixelLabels classes(first.width, first.height);
  for (int j = 0; j < first.height; ++j)
    for (int i = 0; i < first.width; ++i)
      classes(i, j) = static_cast<std::uint8_t>((first(i, j) >= 0 ? 1 : 0) + (second(i, j) >= 0 ? 2 : 0));
  return classes;
}

/// 0 below the level 0, 1 between, 2 from the level 1 on.
PixelLabels layers_of(const Field& phi) {
  PixelLabels classes(phi.width, phi.height);
  for (int j = 0; j < phi.height; ++j)
    for (int i = 0; i < phi.width; ++i)
      classes(i, j) = static_cast<std::uint8_t>((phi(i, j) >= 0 ? 1 : 0) + (phi(i, j) >= 1 ? 1 : 0));
  return classes;
}

/// The gradient of (4.37): the curvature counts at both levels, the force at each level compares its two layers.
void layer_step(Field& phi, const Field& image, const std::vector<double>& c, const Domain& domain, Workspace& w,
                const PhaseSettings& s) {
  constexpr double beta = 0.25;
  for (int j = 0; j < phi.height; ++j)
    for (int i = 0; i < phi.width; ++i) {
      const double low = gaussian_delta(phi(i, j), beta), high = gaussian_delta(phi(i, j) - 1, beta);
      const double g = image(i, j);
      w.norm(i, j) = low + high;
      w.force(i, j) =
          s.lambda * (low * (squared(g - c[0]) - squared(g - c[1])) + high * (squared(g - c[1]) - squared(g - c[2])));
      w.upwind(i, j) = 1;
    }
  take_differences(phi, domain, w.d);
  face_coefficients(w.d, domain, FaceRule::midpoint, flat_of_range, w.c);
  // The force is explicit: the step is in units of what moves phi fastest.
  const double fastest = std::max(s.mu, s.lambda * squared(c.back() - c.front()));
  semi_explicit_step(phi, domain, w, {s.time_step / fastest, s.mu}, w.norm, w.upwind);
  // Between the levels nothing may run away: beyond half a layer outside, δ_β has died out.
  for (double& value : phi.values) value = std::clamp(value, -0.5, 1.5);
}

/// Sum of the squared deviations from the mean in the marked part.
double spread(const Field& image, const PixelLabels& part) {
  std::vector<double> mean{0, 0};
  update_means(image, part, mean);
  double sum = 0;
  for (int j = 0; j < image.height; ++j)
    for (int i = 0; i < image.width; ++i)
      if (part(i, j)) sum += squared(image(i, j) - mean[1]);
  return sum;
}

/// -1/2, 1/2, 3/2 by the two best classes, of which the one that spreads more is halved again.
Field three_class_start(const Field& image, const Domain& plane) {
  const Field halves = two_class_start(image, plane, Norm::l2);
  const bool halve_bright = spread(image, where(halves, true)) >= spread(image, where(halves, false));
  Field quarters(image.width, image.height), phi(image.width, image.height);
  add_two_classes(image, where(halves, halve_bright), quarters);
  for (int j = 0; j < phi.height; ++j)
    for (int i = 0; i < phi.width; ++i) {
      const bool halved = (halves(i, j) >= 0) == halve_bright;
      const double middle = halve_bright ? 1 : 0;  // between the two layers of the halved class
      phi(i, j) = halved ? middle + 0.5 * quarters(i, j) : halve_bright ? -0.5 : 1.5;
    }
  return phi;
}

FlowResult split(const Field& image, const PixelLabels& part, const PhaseSettings& s, double mu) {
  const Domain domain = part_of_plane(part);
  FlowSettings flow;
  flow.mu = mu, flow.lambda = s.lambda, flow.time_step = s.time_step;
  flow.max_iterations = s.max_iterations, flow.calm_iterations = s.calm_iterations;
  return chan_vese_flow(image, two_class_start(image, domain, Norm::l2), domain, flow);
}

}  // namespace

PhaseResult four_phases(const Field& image, const PhaseSettings& settings) {
  const Domain plane = whole_plane(image.width, image.height);
  Workspace w(image.width, image.height);
  Field first(image.width, image.height), second = two_class_start(image, plane, Norm::l2);
  add_two_classes(image, where(second, true), first);
  add_two_classes(image, where(second, false), first);
  PhaseResult result;
  result.c.assign(4, 0);
  const auto advance = [&](const PhaseResult& now) {
    const Field old_first = first;
    four_phase_force(image, second, now.c, 0, settings.lambda, w.force);
    level_set_step(first, plane, w, settings);
    four_phase_force(image, old_first, now.c, 1, settings.lambda, w.force);
    level_set_step(second, plane, w, settings);
  };
  run(
      result, settings, [&] { return two_bits(first, second); }, advance, image);
  return result;
}

PhaseResult three_layers(const Field& image, const PhaseSettings& settings) {
  const Domain plane = whole_plane(image.width, image.height);
  Workspace w(image.width, image.height);
  Field phi = three_class_start(image, plane);
  PhaseResult result;
  result.c.assign(3, 0);
  run(
      result, settings, [&] { return layers_of(phi); },
      [&](const PhaseResult& now) { layer_step(phi, image, now.c, plane, w, settings); }, image);
  return result;
}

PhaseResult hierarchical_phases(const Field& image, const PhaseSettings& settings, const std::array<double, 3>& mu) {
  const FlowResult whole = split(image, PixelLabels(image.width, image.height, 1), settings, mu[0]);
  const bool bright_is_positive = whole.c.positive > whole.c.negative;
  PhaseResult result;
  result.classes = PixelLabels(image.width, image.height);
  result.iterations = whole.iterations, result.steady = whole.steady;
  result.c.assign(4, 0);
  for (const std::size_t side : {0u, 1u}) {
    const PixelLabels part = where(whole.phi, (side == 1) == bright_is_positive);
    const FlowResult half = split(image, part, settings, mu[1 + side]);
    const bool upper_is_positive = half.c.positive > half.c.negative;
    for (int j = 0; j < image.height; ++j)
      for (int i = 0; i < image.width; ++i)
        if (part(i, j))
          result.classes(i, j) = static_cast<std::uint8_t>(2 * side + ((half.phi(i, j) >= 0) == upper_is_positive));
    result.iterations += half.iterations, result.steady = result.steady && half.steady;
  }
  result.contours = result.classes;
  update_means(image, result.classes, result.c);
  return result;
}

Misclassified compare_classes(const PixelLabels& classes, const PixelLabels& truth, double reach_px) {
  const int reach = static_cast<int>(std::ceil(reach_px));
  const auto near = [&](int i, int j, std::uint8_t wanted) {
    for (int y = std::max(0, j - reach); y <= std::min(truth.height - 1, j + reach); ++y)
      for (int x = std::max(0, i - reach); x <= std::min(truth.width - 1, i + reach); ++x)
        if (math::hypot(x - i, y - j) <= reach_px && truth(x, y) == wanted) return true;
    return false;
  };
  Misclassified found;
  for (int j = 0; j < truth.height; ++j)
    for (int i = 0; i < truth.width; ++i) {
      if (classes(i, j) == truth(i, j)) continue;
      ++found.wrong;
      found.foreign += !near(i, j, classes(i, j));
    }
  return found;
}

}  // namespace heartgen::study
