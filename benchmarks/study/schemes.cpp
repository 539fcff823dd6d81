// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/study/schemes.hpp"

#include <algorithm>
#include <cmath>

namespace heartgen::study {

void take_differences(const Field& phi, const Domain& domain, Differences& d) {
  for (int j = 0; j < phi.height; ++j) {
    const double *p = phi.row(j), *below = phi.row(j + 1), *open_x = domain.open_x.row(j),
                 *open_y = domain.open_y.row(j);
    double *x = d.face_x.row(j), *y = d.face_y.row(j);
    for (int i = 0; i < phi.width; ++i) x[i] = open_x[i] * (p[i + 1] - p[i]), y[i] = open_y[i] * (below[i] - p[i]);
  }
  for (int j = 0; j < phi.height; ++j) {
    const double *x = d.face_x.row(j), *y = d.face_y.row(j), *above = d.face_y.row(j - 1);
    double *cx = d.central_x.row(j), *cy = d.central_y.row(j);
    for (int i = 0; i < phi.width; ++i) cx[i] = 0.5 * (x[i] + x[i - 1]), cy[i] = 0.5 * (y[i] + above[i]);
  }
}

void curvature_central(const Differences& d, const Domain& domain, Field& curvature) {
  for (int j = 0; j < curvature.height; ++j)
    for (int i = 0; i < curvature.width; ++i) {
      const double x = d.central_x(i, j), y = d.central_y(i, j), squared = x * x + y * y;
      if (squared == 0) {
        curvature(i, j) = 0;
        continue;
      }
      const double xx = d.face_x(i, j) - d.face_x(i - 1, j), yy = d.face_y(i, j) - d.face_y(i, j - 1);
      const double xy = 0.5 * (domain.open_y(i, j) * (d.central_x(i, j + 1) - x) +
                               domain.open_y(i, j - 1) * (x - d.central_x(i, j - 1)));
      const double value = (y * y * xx - 2 * x * y * xy + x * x * yy) / (squared * std::sqrt(squared));
      curvature(i, j) = std::clamp(value, -1.0, 1.0);
    }
}

void face_coefficients(const Differences& d, const Domain& domain, FaceRule rule, double delta, FaceCoefficients& c) {
  const double own = rule == FaceRule::midpoint ? 0.5 : 1, other = 1 - own;
  for (int j = 0; j < c.x.height; ++j) {
    const double *open_x = domain.open_x.row(j), *open_y = domain.open_y.row(j);
    const double *face_x = d.face_x.row(j), *face_y = d.face_y.row(j);
    const double *x = d.central_x.row(j), *x_below = d.central_x.row(j + 1), *y = d.central_y.row(j);
    double *to_x = c.x.row(j), *to_y = c.y.row(j);
    for (int i = 0; i < c.x.width; ++i) {
      const double along_x = own * y[i] + other * y[i + 1], along_y = own * x[i] + other * x_below[i];
      to_x[i] = open_x[i] / (std::sqrt(face_x[i] * face_x[i] + along_x * along_x) + delta);
      to_y[i] = open_y[i] / (std::sqrt(face_y[i] * face_y[i] + along_y * along_y) + delta);
    }
  }
}

void curvature_flux(const Differences& d, const FaceCoefficients& c, Field& curvature) {
  for (int j = 0; j < curvature.height; ++j) {
    const double *face_x = d.face_x.row(j), *face_y = d.face_y.row(j), *above = d.face_y.row(j - 1);
    const double *cx = c.x.row(j), *cy = c.y.row(j), *cy_above = c.y.row(j - 1);
    double* to = curvature.row(j);
    for (int i = 0; i < curvature.width; ++i)
      to[i] = cx[i] * face_x[i] - cx[i - 1] * face_x[i - 1] + cy[i] * face_y[i] - cy_above[i] * above[i];
  }
}

void gradient_norm(const Differences& d, Field& norm) {
  for (int j = 0; j < norm.height; ++j) {
    const double *x = d.central_x.row(j), *y = d.central_y.row(j);
    double* to = norm.row(j);
    for (int i = 0; i < norm.width; ++i) to[i] = std::sqrt(x[i] * x[i] + y[i] * y[i]);
  }
}

void upwind_norm(const Differences& d, const Field& force, Field& norm) {
  for (int j = 0; j < norm.height; ++j) {
    const double *x = d.face_x.row(j), *y = d.face_y.row(j), *above = d.face_y.row(j - 1), *f = force.row(j);
    double* to = norm.row(j);
    for (int i = 0; i < norm.width; ++i) {
      const double up = f[i] > 0 ? 1 : -1;  // differences towards the neighbours, positive where they count
      const double right = std::max(up * x[i], 0.0), left = std::max(-up * x[i - 1], 0.0);
      const double below = std::max(up * y[i], 0.0), over = std::max(-up * above[i], 0.0);
      to[i] = std::sqrt(right * right + left * left + below * below + over * over);
    }
  }
}

void two_sided_norm(const Differences& d, Field& norm) {
  for (int j = 0; j < norm.height; ++j) {
    const double *x = d.face_x.row(j), *y = d.face_y.row(j), *above = d.face_y.row(j - 1);
    double* to = norm.row(j);
    for (int i = 0; i < norm.width; ++i)
      to[i] = std::sqrt(0.5 * (x[i] * x[i] + x[i - 1] * x[i - 1] + y[i] * y[i] + above[i] * above[i]));
  }
}

Workspace::Workspace(int width, int height)
    : d{Field(width, height), Field(width, height), Field(width, height), Field(width, height)},
      c{Field(width, height), Field(width, height)},
      curvature(width, height),
      norm(width, height),
      upwind(width, height),
      force(width, height) {}

void explicit_step(Field& phi, const Domain& domain, const Workspace& w, const TimeStep& step, const Field& a,
                   const Field& b) {
  for (int j = 0; j < phi.height; ++j) {
    double* p = phi.row(j);
    const double *k = w.curvature.row(j), *f = w.force.row(j), *inside = domain.inside.row(j);
    const double *weight = a.row(j), *pull = b.row(j);
    for (int i = 0; i < phi.width; ++i) p[i] += step.length * inside[i] * (step.mu * weight[i] * k[i] + pull[i] * f[i]);
  }
}

void semi_explicit_step(Field& phi, const Domain& domain, Workspace& w, const TimeStep& step, const Field& a,
                        const Field& b) {
  curvature_flux(w.d, w.c, w.curvature);
  for (int j = 0; j < phi.height; ++j) {
    double* p = phi.row(j);
    const double *k = w.curvature.row(j), *f = w.force.row(j), *inside = domain.inside.row(j);
    const double *cx = w.c.x.row(j), *cy = w.c.y.row(j), *cy_above = w.c.y.row(j - 1);
    const double *weight = a.row(j), *pull = b.row(j);
    for (int i = 0; i < phi.width; ++i) {
      // Σ C neighbour = curvature + phi Σ C, so the quotient is phi plus a damped explicit step.
      const double rate = step.length * inside[i], damping = cx[i] + cx[i - 1] + cy[i] + cy_above[i];
      p[i] += rate * (step.mu * weight[i] * k[i] + pull[i] * f[i]) / (1 + rate * step.mu * weight[i] * damping);
    }
  }
}

void keep_finite(Field& phi) {
  constexpr double too_large = 0x1p400, shrink = 0x1p-400, smallest = 0x1p-900;
  const auto large = [](double v) { return std::abs(v) > too_large; };
  if (std::any_of(phi.values.begin(), phi.values.end(), large))
    for (double& value : phi.values) value = std::copysign(std::max(std::abs(value) * shrink, smallest), value);
}

}  // namespace heartgen::study
