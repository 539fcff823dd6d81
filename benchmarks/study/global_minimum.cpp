// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/study/global_minimum.hpp"

#include <algorithm>
#include <cmath>

#include "benchmarks/study/schemes.hpp"

namespace heartgen::study {
namespace {

struct Iterates {
  Field u, ahead, dual_x, dual_y;
};

/// -div of the dual field, the transpose of the forward differences.
double transposed_gradient(const Iterates& it, int i, int j) {
  return it.dual_x(i - 1, j) - it.dual_x(i, j) + it.dual_y(i, j - 1) - it.dual_y(i, j);
}

void dual_step(Iterates& it, const Domain& domain, double mu, double sigma) {
  for (int j = 0; j < it.u.height; ++j) {
    const double *a = it.ahead.row(j), *below = it.ahead.row(j + 1);
    const double *open_x = domain.open_x.row(j), *open_y = domain.open_y.row(j);
    double *x = it.dual_x.row(j), *y = it.dual_y.row(j);
    for (int i = 0; i < it.u.width; ++i) {
      const double px = open_x[i] * (x[i] + sigma * (a[i + 1] - a[i]));
      const double py = open_y[i] * (y[i] + sigma * (below[i] - a[i]));
      const double scale = std::max(1.0, std::sqrt(px * px + py * py) / mu);
      x[i] = px / scale, y[i] = py / scale;
    }
  }
}

void primal_step(Iterates& it, const Field& force, double tau) {
  for (int j = 0; j < it.u.height; ++j) {
    double *u = it.u.row(j), *ahead = it.ahead.row(j);
    const double *x = it.dual_x.row(j), *y = it.dual_y.row(j), *above = it.dual_y.row(j - 1), *f = force.row(j);
    for (int i = 0; i < it.u.width; ++i) {
      const double next = std::clamp(u[i] - tau * (x[i - 1] - x[i] + above[i] - y[i] - f[i]), 0.0, 1.0);
      ahead[i] = 2 * next - u[i];
      u[i] = next;
    }
  }
}

struct Bounds {
  double primal = 0, dual = 0;
};

/// The energy of u and the lower bound by the dual field, both without the part that does not depend on u.
Bounds bounds(const Iterates& it, const Domain& domain, const Field& force, double mu) {
  Bounds b;
  for (int j = 0; j < it.u.height; ++j)
    for (int i = 0; i < it.u.width; ++i) {
      const double x = domain.open_x(i, j) * (it.u(i + 1, j) - it.u(i, j));
      const double y = domain.open_y(i, j) * (it.u(i, j + 1) - it.u(i, j));
      const double inside = domain.inside(i, j);
      b.primal += mu * std::sqrt(x * x + y * y) - inside * force(i, j) * it.u(i, j);
      b.dual += inside * std::min(0.0, transposed_gradient(it, i, j) - force(i, j));
    }
  return b;
}

/// What the energy has beside the convex functional: λ Σ |g - c2|^p.
double constant_part(const Field& image, const Domain& domain, const GreyValues& c, const GlobalSettings& s) {
  double sum = 0;
  for (int j = 0; j < image.height; ++j)
    for (int i = 0; i < image.width; ++i) {
      const double d = std::abs(image(i, j) - c.negative);
      sum += domain.inside(i, j) * (s.norm == Norm::l1 ? d : d * d);
    }
  return s.lambda * sum;
}

/// Returns the iterations done; the gap reached goes to `relative_gap`.
int solve(Iterates& it, const Domain& domain, const Field& force, double constant, const GlobalSettings& s,
          double& relative_gap) {
  constexpr int check_every = 25;
  // The operator's squared norm is at most 8; the range of u is 1 and that of the dual μ.
  const double sigma = s.mu / std::sqrt(8.0), tau = 1 / (8 * sigma);
  for (int n = 1; n <= s.max_iterations; ++n) {
    dual_step(it, domain, s.mu, sigma);
    primal_step(it, force, tau);
    if (n % check_every && n < s.max_iterations) continue;
    const Bounds b = bounds(it, domain, force, s.mu);
    relative_gap = (b.primal - b.dual) / (b.primal + constant);
    if (relative_gap <= s.relative_gap) return n;
  }
  return s.max_iterations;
}

Field level_half(const Field& u) {
  Field phi(u.width, u.height);
  for (int j = 0; j < u.height; ++j)
    for (int i = 0; i < u.width; ++i) phi(i, j) = u(i, j) - 0.5;
  return phi;
}

}  // namespace

GlobalMinimum global_minimum(const Field& image, const Domain& domain, const GlobalSettings& settings) {
  return global_minimum(image, domain, settings, two_means(image, domain, settings.norm));
}

GlobalMinimum global_minimum(const Field& image, const Domain& domain, const GlobalSettings& settings,
                             const GreyValues& start) {
  const int width = image.width, height = image.height;
  GlobalMinimum result;
  result.c = start;
  Iterates it{Field(width, height), Field(width, height), Field(width, height), Field(width, height)};
  Field force(width, height);
  PixelLabels sides(width, height);
  for (int update = 0; update < settings.max_updates; ++update) {
    fidelity_force(image, result.c, settings.norm, settings.lambda, force);
    result.iterations +=
        solve(it, domain, force, constant_part(image, domain, result.c, settings), settings, result.relative_gap);
    result.phi = level_half(it.u);
    const GreyValues c = grey_values(image, result.phi, domain, settings.norm, result.c);
    PixelLabels now = positive_side(result.phi, domain);
    const bool same = now.values == sides.values;
    sides = std::move(now);
    if (same) break;
    result.c = c;
  }
  result.energy = energy(image, result.phi, domain, settings.norm, settings.mu, settings.lambda, Length::heaviside);
  return result;
}

}  // namespace heartgen::study
