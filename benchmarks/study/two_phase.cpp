// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/study/two_phase.hpp"

#include <algorithm>
#include <cmath>

#include "benchmarks/study/length.hpp"
#include "model/error.hpp"
#include "model/mathematics.hpp"

namespace heartgen::study {
namespace {

struct Step {
  const Domain& domain;
  const FlowSettings& s;
  Workspace& w;

  TimeStep time() const { return {s.time_step, s.mu}; }
};

void clamp_range(Field& phi) {
  for (double& value : phi.values) value = std::clamp(value, -1.0, 1.0);
}

/// (5.14): minus the gradient of the Heaviside length, in w.curvature.
void heaviside_curvature(const Field& phi, const Step& step) {
  Field side(phi.width, phi.height);
  for (int j = 0; j < phi.height; ++j)
    for (int i = 0; i < phi.width; ++i) side(i, j) = phi(i, j) >= 0;
  take_differences(side, step.domain, step.w.d);
  for (int j = 0; j < phi.height; ++j)
    for (int i = 0; i < phi.width; ++i) {
      const double squared =
          step.w.d.face_x(i, j) * step.w.d.face_x(i, j) + step.w.d.face_y(i, j) * step.w.d.face_y(i, j);
      step.w.c.x(i, j) = step.w.c.y(i, j) = squared > 0 ? 1 / std::sqrt(squared) : 0;
    }
  curvature_flux(step.w.d, step.w.c, step.w.curvature);
}

/// (5.21): minus the gradient of the length with δ_β, in w.curvature.
void delta_curvature(const Field& phi, const Step& step) {
  take_differences(phi, step.domain, step.w.d);
  for (int j = 0; j < phi.height; ++j)
    for (int i = 0; i < phi.width; ++i) {
      const double norm = math::hypot(step.w.d.face_x(i, j), step.w.d.face_y(i, j));
      step.w.norm(i, j) = norm;
      step.w.c.x(i, j) = step.w.c.y(i, j) = gaussian_delta(phi(i, j), step.s.beta) / (norm + flat_gradient);
    }
  curvature_flux(step.w.d, step.w.c, step.w.curvature);
  for (int j = 0; j < phi.height; ++j)
    for (int i = 0; i < phi.width; ++i)
      step.w.curvature(i, j) -= gaussian_delta_slope(phi(i, j), step.s.beta) * step.w.norm(i, j);
}

/// The last two methods: μ curvature stands alone, δ_β multiplies the force only (5.15).
void energy_gradient_step(Field& phi, const Step& step) {
  for (int j = 0; j < phi.height; ++j)
    for (int i = 0; i < phi.width; ++i)
      phi(i, j) += step.s.time_step * step.domain.inside(i, j) *
                   (step.s.mu * step.w.curvature(i, j) + gaussian_delta(phi(i, j), step.s.beta) * step.w.force(i, j));
}

void level_set_step(Field& phi, const Step& step) {
  Workspace& w = step.w;
  take_differences(phi, step.domain, w.d);
  if (step.s.method != Discretisation::central)
    face_coefficients(w.d, step.domain, FaceRule::midpoint, flat_gradient, w.c);
  if (step.s.method == Discretisation::semi_explicit) {
    two_sided_norm(w.d, w.norm);
    return semi_explicit_step(phi, step.domain, w, step.time(), w.norm, w.norm);
  }
  gradient_norm(w.d, w.norm);
  upwind_norm(w.d, w.force, w.upwind);
  if (step.s.method == Discretisation::central)
    curvature_central(w.d, step.domain, w.curvature);
  else
    curvature_flux(w.d, w.c, w.curvature);
  explicit_step(phi, step.domain, w, step.time(), w.norm, w.upwind);
}

void advance(Field& phi, const Step& step) {
  Workspace& w = step.w;
  switch (step.s.method) {
    case Discretisation::central:
    case Discretisation::midpoint:
    case Discretisation::semi_explicit:
      return level_set_step(phi, step);
    case Discretisation::global:
      take_differences(phi, step.domain, w.d);
      face_coefficients(w.d, step.domain, FaceRule::midpoint, flat_of_range, w.c);
      std::fill(w.norm.values.begin(), w.norm.values.end(), 1.0);
      semi_explicit_step(phi, step.domain, w, step.time(), w.norm, w.norm);
      return clamp_range(phi);
    case Discretisation::regularised_delta:
      take_differences(phi, step.domain, w.d);
      face_coefficients(w.d, step.domain, FaceRule::midpoint, flat_gradient, w.c);
      curvature_flux(w.d, w.c, w.curvature);
      std::transform(phi.values.begin(), phi.values.end(), w.norm.values.begin(),
                     [&](double value) { return gaussian_delta(value, step.s.beta); });
      return explicit_step(phi, step.domain, w, step.time(), w.norm, w.norm);
    case Discretisation::heaviside_energy:
      heaviside_curvature(phi, step);
      return energy_gradient_step(phi, step);
    case Discretisation::delta_energy:
      delta_curvature(phi, step);
      return energy_gradient_step(phi, step);
  }
}

void check(const FlowSettings& s) {
  if (!(s.lambda > 0) || !(s.mu >= 0))
    throw UserError("lambda must be positive and mu must not be negative", "Chan-Vese flow", "correct the parameters");
  if (!(s.time_step > 0) || !(s.beta > 0))
    throw UserError("the time step and beta must be positive", "Chan-Vese flow", "correct the parameters");
}

}  // namespace

std::string name_of(Discretisation method) {
  switch (method) {
    case Discretisation::central:
      return "1 |∇φ|, central differences (3.10)";
    case Discretisation::midpoint:
      return "2 |∇φ|, midpoints (3.12)";
    case Discretisation::semi_explicit:
      return "3 |∇φ|, semi-explicit (3.14)";
    case Discretisation::global:
      return "4 global minimiser (4.42)";
    case Discretisation::regularised_delta:
      return "5 regularised δ (5.8)";
    case Discretisation::heaviside_energy:
      return "6 Heaviside energy (5.14)";
    case Discretisation::delta_energy:
      return "7 δ energy (5.21)";
  }
  return "";
}

FlowResult chan_vese_flow(const Field& image, Field phi, const Domain& domain, const FlowSettings& settings,
                          const Watch& watch) {
  check(settings);
  Workspace workspace(image.width, image.height);
  const Step step{domain, settings, workspace};
  FlowResult result;
  PixelLabels sides = positive_side(phi, domain);
  while (result.iterations < settings.max_iterations && !result.steady) {
    result.c = grey_values(image, phi, domain, settings.norm, result.c);
    fidelity_force(image, result.c, settings.norm, settings.lambda, workspace.force);
    advance(phi, step);
    keep_finite(phi);
    ++result.iterations;
    PixelLabels now = positive_side(phi, domain);
    if (now.values != sides.values) result.last_change = result.iterations;
    sides = std::move(now);
    result.steady = result.iterations - result.last_change >= settings.calm_iterations;
    if (watch && !watch(result.iterations, phi)) break;
  }
  result.phi = std::move(phi);
  return result;
}

}  // namespace heartgen::study
