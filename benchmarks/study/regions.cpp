// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/study/regions.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "benchmarks/study/length.hpp"
#include "model/error.hpp"
#include "model/quantile.hpp"

namespace heartgen::study {
namespace {

double cost(double grey, double c, Norm norm) {
  return norm == Norm::l1 ? std::abs(grey - c) : (grey - c) * (grey - c);
}

GreyValues means(const Field& image, const Field& phi, const Domain& domain, const GreyValues& before) {
  double sum[2] = {0, 0}, count[2] = {0, 0};
  for (int j = 0; j < image.height; ++j) {
    double row_all = 0, row_positive = 0, pixels = 0, positive = 0;
    const double *g = image.row(j), *p = phi.row(j), *inside = domain.inside.row(j);
    for (int i = 0; i < image.width; ++i) {
      const double side = p[i] >= 0 ? inside[i] : 0;
      row_all += inside[i] * g[i], row_positive += side * g[i];
      pixels += inside[i], positive += side;
    }
    sum[0] += row_all - row_positive, sum[1] += row_positive;
    count[0] += pixels - positive, count[1] += positive;
  }
  return {count[1] > 0 ? sum[1] / count[1] : before.positive, count[0] > 0 ? sum[0] / count[0] : before.negative};
}

double median_of(std::vector<double>& values, double otherwise) {
  return values.empty() ? otherwise : lower_median(values);
}

GreyValues medians(const Field& image, const Field& phi, const Domain& domain, const GreyValues& before) {
  std::vector<double> positive, negative;
  for (int j = 0; j < image.height; ++j)
    for (int i = 0; i < image.width; ++i)
      if (domain.inside(i, j) != 0) (phi(i, j) >= 0 ? positive : negative).push_back(image(i, j));
  return {median_of(positive, before.positive), median_of(negative, before.negative)};
}

/// Cost of a run of sorted values around its mean or median, from prefix sums of the values and of their squares.
struct SortedCosts {
  std::vector<double> sum{0}, squares{0};

  explicit SortedCosts(const std::vector<double>& sorted) {
    for (const double v : sorted) sum.push_back(sum.back() + v), squares.push_back(squares.back() + v * v);
  }
  double operator()(std::size_t begin, std::size_t end, Norm norm) const {
    const double n = static_cast<double>(end - begin);
    if (norm == Norm::l2) {
      const double s = sum[end] - sum[begin];
      return squares[end] - squares[begin] - s * s / n;
    }
    const std::size_t middle = begin + (end - begin - 1) / 2;
    const double median = sum[middle + 1] - sum[middle];
    const double below = static_cast<double>(middle - begin), above = static_cast<double>(end - middle);
    return median * below - (sum[middle] - sum[begin]) + (sum[end] - sum[middle]) - median * above;
  }
};

}  // namespace

GreyValues grey_values(const Field& image, const Field& phi, const Domain& domain, Norm norm,
                       const GreyValues& before) {
  return norm == Norm::l1 ? medians(image, phi, domain, before) : means(image, phi, domain, before);
}

void fidelity_force(const Field& image, const GreyValues& c, Norm norm, double lambda, Field& force) {
  for (int j = 0; j < image.height; ++j) {
    const double* g = image.row(j);
    double* f = force.row(j);
    for (int i = 0; i < image.width; ++i) f[i] = lambda * (cost(g[i], c.negative, norm) - cost(g[i], c.positive, norm));
  }
}

double contour_length(const Field& phi, Length length) {
  switch (length) {
    case Length::heaviside:
      return heaviside_length(phi);
    case Length::smereka:
      return smereka_length(phi);
    case Length::piecewise_linear:
      return piecewise_linear_length(phi);
  }
  return 0;
}

double energy(const Field& image, const Field& phi, const Domain& domain, Norm norm, double mu, double lambda,
              Length length) {
  const GreyValues c = grey_values(image, phi, domain, norm);
  double fidelity = 0;
  for (int j = 0; j < image.height; ++j)
    for (int i = 0; i < image.width; ++i)
      fidelity += domain.inside(i, j) * cost(image(i, j), phi(i, j) >= 0 ? c.positive : c.negative, norm);
  return mu * contour_length(phi, length) + lambda * fidelity;
}

GreyValues two_means(const Field& image, const Domain& domain, Norm norm) {
  std::vector<double> sorted;
  for (int j = 0; j < image.height; ++j)
    for (int i = 0; i < image.width; ++i)
      if (domain.inside(i, j) != 0) sorted.push_back(image(i, j));
  std::sort(sorted.begin(), sorted.end());
  if (sorted.empty() || sorted.front() == sorted.back())
    throw UserError("all grey values are the same", "two-class division", "give an image with contrast");
  const SortedCosts costs(sorted);
  const std::size_t n = sorted.size();
  std::size_t best = 0;
  double least = 0;
  for (std::size_t cut = 1; cut < n; ++cut) {
    if (sorted[cut] == sorted[cut - 1]) continue;
    const double total = costs(0, cut, norm) + costs(cut, n, norm);
    if (best == 0 || total < least) best = cut, least = total;
  }
  const auto value = [&](std::size_t begin, std::size_t end) {
    return norm == Norm::l1 ? sorted[begin + (end - begin - 1) / 2]
                            : (costs.sum[end] - costs.sum[begin]) / static_cast<double>(end - begin);
  };
  return {value(best, n), value(0, best)};
}

}  // namespace heartgen::study
