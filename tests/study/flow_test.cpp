// SPDX-License-Identifier: GPL-3.0-or-later
// The Chan-Vese flows and their references (thesis 4.4, 5.1.2, 5.2, 5.3).
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "benchmarks/study/convergence.hpp"
#include "benchmarks/study/global_minimum.hpp"
#include "benchmarks/study/initial_conditions.hpp"
#include "benchmarks/study/phases.hpp"
#include "benchmarks/study/schemes.hpp"
#include "benchmarks/study/test_images.hpp"
#include "model/error.hpp"

namespace heartgen::study {
namespace {

constexpr int size = 96;

Field curvature_of(const Field& phi, Discretisation scheme) {
  const Domain plane = whole_plane(phi.width, phi.height);
  Workspace w(phi.width, phi.height);
  take_differences(phi, plane, w.d);
  if (scheme == Discretisation::central) {
    curvature_central(w.d, plane, w.curvature);
  } else {
    face_coefficients(w.d, plane, FaceRule::midpoint, flat_gradient, w.c);
    curvature_flux(w.d, w.c, w.curvature);
  }
  return w.curvature;
}

/// Every segmentation's energy with the Heaviside length, with the default weights.
double heaviside_energy(const Field& image, const Field& phi) {
  const FlowSettings s;
  return energy(image, phi, whole_plane(image.width, image.height), s.norm, s.mu, s.lambda, Length::heaviside);
}

TEST(Schemes, CurvatureOfACircle) {
  const Field phi = circle_start(64, 64, 31.3, 31.8, 20);
  for (const auto scheme : {Discretisation::central, Discretisation::midpoint}) {
    const Field curvature = curvature_of(phi, scheme);
    for (int j = 2; j < 62; ++j)
      for (int i = 2; i < 62; ++i)
        if (std::abs(phi(i, j)) < 2) {
          EXPECT_NEAR(curvature(i, j), -1 / (20 - phi(i, j)), 2e-3);
        }
  }
}

TEST(Schemes, NothingFlowsThroughTheBorderOfADomain) {
  PixelLabels part(40, 30, 1);
  for (int j = 0; j < 30; ++j)
    for (int i = 0; i < 40; ++i) part(i, j) = i + j > 20 && i < 35;
  const Domain domain = part_of_plane(part);
  Workspace w(40, 30);
  take_differences(random_start(40, 30), domain, w.d);
  face_coefficients(w.d, domain, FaceRule::midpoint, flat_gradient, w.c);
  curvature_flux(w.d, w.c, w.curvature);
  double sum = 0;
  for (int j = 0; j < 30; ++j)
    for (int i = 0; i < 40; ++i) {
      sum += w.curvature(i, j);
      if (!part(i, j)) {
        EXPECT_EQ(w.curvature(i, j), 0);
      }
    }
  EXPECT_NEAR(sum, 0, 1e-9);
}

TEST(Regions, BestTwoClassesByTrial) {
  const Field image = photographer(24);
  const Domain plane = whole_plane(24, 24);
  for (const Norm norm : {Norm::l1, Norm::l2}) {
    const auto cost = [&](double threshold) {
      Field phi(24, 24);
      for (int j = 0; j < 24; ++j)
        for (int i = 0; i < 24; ++i) phi(i, j) = image(i, j) - threshold;
      return energy(image, phi, plane, norm, 0, 1, Length::heaviside);
    };
    double least = 1e300;
    for (int threshold = 1; threshold < 255; ++threshold) least = std::min(least, cost(threshold));
    const GreyValues c = two_means(image, plane, norm);
    EXPECT_NEAR(energy(image, two_class_start(image, plane, norm), plane, norm, 0, 1, Length::heaviside), least,
                1e-6 * least);
    EXPECT_GT(c.positive, c.negative);
  }
  EXPECT_THROW(two_means(Field(5, 5, 7), whole_plane(5, 5), Norm::l1), UserError);
}

TEST(Flow, MeanCurvatureShrinksACircleAtTheRightSpeed) {
  // No contrast, hence no force: r² = r0² - 2 μ t.
  FlowSettings settings;
  settings.mu = 1, settings.time_step = 0.1, settings.max_iterations = 600, settings.calm_iterations = 1000;
  for (const auto method : {Discretisation::central, Discretisation::midpoint}) {
    settings.method = method;
    const Field flat(64, 64, 1);
    const FlowResult result = chan_vese_flow(flat, circle_start(64, 64, 31.6, 31.2, 20), whole_plane(64, 64), settings);
    double area = 0;
    for (const auto side : positive_side(result.phi, whole_plane(64, 64)).values) area += side;
    EXPECT_NEAR(area / std::numbers::pi, 20 * 20 - 2 * 60, 8);
  }
}

TEST(Flow, SevenMethodsAgainstTheConvexSolver) {
  const Field image = photographer(size);
  const Domain plane = whole_plane(size, size);
  const Field start = two_class_start(image, plane, Norm::l2);
  GlobalSettings tight;
  tight.relative_gap = 1e-5;
  const GlobalMinimum reference = global_minimum(image, plane, tight);
  EXPECT_LE(reference.relative_gap, 1e-5);
  const double first = heaviside_energy(image, start);
  std::vector<double> found;
  for (int n = 1; n <= discretisation_count; ++n) {
    FlowSettings settings;
    settings.method = static_cast<Discretisation>(n);
    settings.max_iterations = 800;
    found.push_back(heaviside_energy(image, chan_vese_flow(image, start, plane, settings).phi));
    EXPECT_LE(reference.energy, found.back() * (1 + 1e-5)) << name_of(settings.method);
    if (n != 6) {
      EXPECT_LT(found.back(), first) << name_of(settings.method);
    }
  }
  for (const std::size_t better : {1u, 2u, 3u, 4u, 5u, 7u}) EXPECT_LT(found[better - 1], found[5]) << better;
  EXPECT_LT(found[3], found[0]);
  EXPECT_LT(found[4], found[0]);
}

TEST(Flow, ConvexSolverIsOptimalAmongPerturbedContours) {
  const Field image = photographer(48);
  const Domain plane = whole_plane(48, 48);
  GlobalSettings tight;
  tight.relative_gap = 1e-6;
  tight.max_iterations = 20000;
  const GlobalMinimum best = global_minimum(image, plane, tight);
  for (int trial = 0; trial < 200; ++trial) {
    Field phi = best.phi;
    const int x = (trial * 37) % 48, y = (trial * 53) % 48, reach = 1 + trial % 4;
    for (int j = 0; j < 48; ++j)
      for (int i = 0; i < 48; ++i)
        if (std::hypot(i - x, j - y) < reach) phi(i, j) = trial % 2 ? 1 : -1;
    EXPECT_GE(heaviside_energy(image, phi), best.energy * (1 - 2e-3));
  }
}

TEST(Flow, L1UsesMediansAndIsInvariantUnderContrast) {
  // u -> 3u + 20 with lambda / 3 is the same problem.
  const Field image = photographer(48);
  Field brighter = image;
  for (int j = 0; j < 48; ++j)
    for (int i = 0; i < 48; ++i) brighter(i, j) = 4 * image(i, j) + 20;
  const Domain plane = whole_plane(48, 48);
  FlowSettings settings;
  settings.norm = Norm::l1, settings.mu = 1, settings.lambda = 0.04, settings.max_iterations = 300;
  const FlowResult a = chan_vese_flow(image, random_start(48, 48), plane, settings);
  settings.lambda = 0.01;
  const FlowResult b = chan_vese_flow(brighter, random_start(48, 48), plane, settings);
  EXPECT_EQ(positive_side(a.phi, plane).values, positive_side(b.phi, plane).values);
  EXPECT_EQ(b.c.positive, 4 * a.c.positive + 20);
}

TEST(Flow, RefusesImpossibleParameters) {
  const Field image(8, 8, 1);
  FlowSettings settings;
  settings.time_step = 0;
  EXPECT_THROW(chan_vese_flow(image, random_start(8, 8), whole_plane(8, 8), settings), UserError);
  settings.time_step = 0.1, settings.lambda = 0;
  EXPECT_THROW(chan_vese_flow(image, random_start(8, 8), whole_plane(8, 8), settings), UserError);
}

TEST(Initial, CirclesAndRandomValues) {
  const Field circles = many_circles_start(100, 100);
  const PixelLabels inside = positive_side(circles, whole_plane(100, 100));
  double covered = 0;
  for (const auto side : inside.values) covered += side;
  EXPECT_NEAR(covered / 10000, std::numbers::pi * 0.09, 0.04);  // discs of radius 0.3 of their pitch
  const Field random = random_start(100, 100);
  double sum = 0, squares = 0;
  for (int j = 0; j < 100; ++j)
    for (int i = 0; i < 100; ++i) {
      EXPECT_LE(std::abs(random(i, j)), 1);
      sum += random(i, j), squares += random(i, j) * random(i, j);
    }
  EXPECT_NEAR(sum / 1e4, 0, 0.03);
  EXPECT_NEAR(squares / 1e4, 1.0 / 3, 0.02);
}

TEST(Initial, TwoClassesThenRandomThenManyCirclesThenOne) {
  // Fig 5.13 with the recommended method.
  const Field image = noisy_shapes(size).image;
  const Domain plane = whole_plane(size, size);
  GlobalSettings problem;
  problem.mu = 1, problem.lambda = 2;
  const PixelLabels reference = positive_side(global_minimum(image, plane, problem).phi, plane);
  FlowSettings settings;
  settings.method = Discretisation::global;
  settings.mu = 1, settings.lambda = 2, settings.max_iterations = settings.calm_iterations = 600;
  std::vector<FollowedFlow> flows = {{"two classes", two_class_start(image, plane, Norm::l2), settings},
                                     {"random", random_start(size, size), settings},
                                     {"100 circles", many_circles_start(size, size), settings},
                                     {"one circle", circle_start(size, size), settings}};
  follow(image, plane, reference, flows);
  // Pixels that differ, summed over the first iterations: less is faster.
  std::vector<double> area;
  for (const auto& flow : flows) {
    area.push_back(0);
    for (std::size_t n = 0; n < flow.distance.x.size() && flow.distance.x[n] <= 600; ++n)
      area.back() += flow.distance.y[n];
  }
  EXPECT_LT(area[0], area[1]);
  const int random = settled_within(flows[1].distance, 0.02 * size * size);
  EXPECT_GT(random, 0);
  for (const std::size_t slower : {2u, 3u}) {
    const int settled = settled_within(flows[slower].distance, 0.02 * size * size);
    EXPECT_TRUE(settled < 0 || settled > random) << flows[slower].name;
  }
}

TEST(Phases, TriplePointsSpoilTwoLevelSetsAndNotTheHierarchy) {
  const FlatRegions scene = bricks(60);
  PhaseSettings light, heavy;
  heavy.mu = 30000;
  EXPECT_EQ(compare_classes(four_phases(scene.image, light).classes, scene.truth).wrong, 0);
  EXPECT_GT(compare_classes(four_phases(scene.image, heavy).classes, scene.truth).foreign, 10);
  const PhaseResult tree = hierarchical_phases(scene.image, heavy, {30000, 30000, 30000});
  EXPECT_EQ(compare_classes(tree.classes, scene.truth).foreign, 0);
}

TEST(Phases, LayersHoldNestedRegions) {
  const FlatRegions egg = nested(60);
  PhaseSettings settings;
  settings.mu = 500;
  const PhaseResult result = three_layers(egg.image, settings);
  EXPECT_EQ(compare_classes(result.classes, egg.truth).wrong, 0);
  EXPECT_NEAR(result.c[2], 200, 1e-9);
}

TEST(Phases, ForeignPixelsAreFarFromTheirClass) {
  PixelLabels truth(20, 20), found(20, 20);
  for (int j = 0; j < 20; ++j)
    for (int i = 10; i < 20; ++i) truth(i, j) = found(i, j) = 1;
  found(8, 5) = 1;   // two pixels from the border: wrong
  found(2, 15) = 1;  // eight pixels: foreign
  const Misclassified bad = compare_classes(found, truth);
  EXPECT_EQ(bad.wrong, 2);
  EXPECT_EQ(bad.foreign, 1);
}

}  // namespace
}  // namespace heartgen::study
