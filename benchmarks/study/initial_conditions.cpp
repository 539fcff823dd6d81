// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/study/initial_conditions.hpp"

#include <algorithm>
#include <cmath>

#include "datasets/phantom/shapes.hpp"
#include "model/mathematics.hpp"

namespace heartgen::study {

Field circle_start(int width, int height, double center_x, double center_y, double radius) {
  Field phi(width, height);
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) phi(i, j) = radius - math::hypot(i - center_x, j - center_y);
  return phi;
}

Field circle_start(int width, int height) {
  return circle_start(width, height, 0.5 * (width - 1), 0.5 * (height - 1), std::min(width, height) / 3.0);
}

Field many_circles_start(int width, int height, int across) {
  const double pitch_x = static_cast<double>(width) / across, pitch_y = static_cast<double>(height) / across;
  const double radius = 0.3 * std::min(pitch_x, pitch_y);
  Field phi(width, height);
  // All circles are alike, so the nearest is the one whose cell the pixel lies in.
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      const double x = std::fmod(i + 0.5, pitch_x) - pitch_x / 2, y = std::fmod(j + 0.5, pitch_y) - pitch_y / 2;
      phi(i, j) = radius - math::hypot(x, y);
    }
  return phi;
}

Field random_start(int width, int height, std::uint64_t key) {
  Field phi(width, height);
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i)
      phi(i, j) = phantom::random_symmetric(key, static_cast<std::uint64_t>(j) * 65536 + static_cast<std::uint64_t>(i));
  return phi;
}

Field two_class_start(const Field& image, const Domain& domain, Norm norm) {
  const GreyValues c = two_means(image, domain, norm);
  const double threshold = 0.5 * (c.positive + c.negative);
  Field phi(image.width, image.height);
  for (int j = 0; j < image.height; ++j)
    for (int i = 0; i < image.width; ++i) phi(i, j) = image(i, j) > threshold ? 1 : -1;
  return phi;
}

std::vector<NamedStart> four_starts(const Field& image, const Domain& domain) {
  return {{"two classes", two_class_start(image, domain, Norm::l2)},
          {"random", random_start(image.width, image.height)},
          {"100 circles", many_circles_start(image.width, image.height)},
          {"one circle", circle_start(image.width, image.height)}};
}

}  // namespace heartgen::study
