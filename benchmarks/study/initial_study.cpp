// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <utility>

#include "benchmarks/study/convergence.hpp"
#include "benchmarks/study/global_minimum.hpp"
#include "benchmarks/study/initial_conditions.hpp"
#include "benchmarks/study/studies.hpp"
#include "benchmarks/study/test_images.hpp"

namespace heartgen::study {
namespace {

struct Case {
  std::string name, title, figure;
  Field image;
  double mu, lambda;
  int iterations;
};

std::vector<FollowedFlow> four_flows(const Case& c, const Domain& plane, Discretisation method) {
  FlowSettings settings;
  settings.method = method;
  settings.mu = c.mu, settings.lambda = c.lambda;
  settings.time_step = 0.1 / c.mu;
  settings.max_iterations = settings.calm_iterations = c.iterations;
  std::vector<FollowedFlow> flows;
  for (auto& start : four_starts(c.image, plane)) flows.push_back({start.name, std::move(start.phi), settings});
  return flows;
}

/// Whether the starts settle in the order in which they stand. Those that never do come last, by what they lack.
bool in_order(const std::vector<FollowedFlow>& flows, double close) {
  constexpr double never = 1e9;
  double before = -1;
  for (const auto& flow : flows) {
    const int settled = settled_within(flow.distance, close);
    const double rank = settled < 0 ? never + flow.distance.y.back() : settled;
    if (rank <= before) return false;
    before = rank;
  }
  return true;
}

std::string settled_list(const std::vector<FollowedFlow>& flows, double close) {
  std::string text;
  for (const auto& flow : flows)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", flow.name, settled_text(flow.distance, close));
  return text;
}

void add_case(StudyResult& study, const Case& c, Discretisation method, const GlobalMinimum& reference) {
  const Domain plane = whole_plane(c.image.width, c.image.height);
  const double close = 0.01 * static_cast<double>(c.image.pixels());
  std::vector<FollowedFlow> flows = four_flows(c, plane, method);
  follow(c.image, plane, positive_side(reference.phi, plane), flows);
  const std::string file = fmt::format("{}-method-{}", c.name, static_cast<int>(method));
  Plot plot{file,        fmt::format("{}, method {}", c.title, static_cast<int>(method)),
            "iteration", "pixels that differ",
            true,        true,
            {}};
  Table table{file,
              fmt::format("{}: method {}, μ = {:g}, λ = {:g}, Δt = 0.1/μ", c.title, name_of(method), c.mu, c.lambda),
              {"start", fmt::format("settled within {:.0f} pixels at iteration", close),
               "pixels that differ at the end", "energy (Heaviside)"},
              {}};
  for (const auto& flow : flows) {
    plot.curves.push_back(flow.distance);
    table.rows.push_back(
        {flow.name, settled_text(flow.distance, close), fmt::format("{:.0f}", flow.distance.y.back()),
         fmt::format("{:.6g}", energy(c.image, flow.result.phi, plane, Norm::l2, c.mu, c.lambda, Length::heaviside))});
  }
  table.rows.push_back({"convex solver", "", "0", fmt::format("{:.6g}", reference.energy)});
  study.tables.push_back(table);
  study.plots.push_back(plot);
  study.claims.push_back(
      {c.figure,
       fmt::format("method {}: two classes, then random, then 100 circles, then one circle", static_cast<int>(method)),
       in_order(flows, close), settled_list(flows, close)});
}

}  // namespace

StudyResult study_initial(const StudySettings& settings) {
  const int size = settings.quick ? 96 : 256;
  const std::vector<Case> cases = {
      {"photographer", "The photographer", "Fig 5.9", photographer(size), 10000, 1, settings.quick ? 400 : 1000},
      {"shapes", "Shapes with 50 % salt and pepper", "Fig 5.13", noisy_shapes(size).image, 1, 2,
       settings.quick ? 1000 : 2000}};
  StudyResult study{"initial",
                    "Four initial conditions (5.2)",
                    "μ and λ as in the thesis. Its scheme and time step are not told; method 4, which it recommends, "
                    "and method 3, which it uses later, are both followed, with μ Δt = 0.1. The shapes have grey "
                    "values 0 and 1. The distance is to the convex solver's result.",
                    {},
                    {},
                    {},
                    {}};
  for (const auto& c : cases) {
    const Domain plane = whole_plane(size, size);
    GlobalSettings problem;
    problem.mu = c.mu, problem.lambda = c.lambda;
    const GlobalMinimum reference = global_minimum(c.image, plane, problem);
    study.pictures.push_back({c.name, c.title, grey_picture(c.image)});
    study.pictures.push_back(
        {c.name + "-steady", c.title + ": the steady state", class_picture(positive_side(reference.phi, plane))});
    for (const auto method : {Discretisation::global, Discretisation::semi_explicit}) {
      if (settings.progress)
        settings.progress(fmt::format("four starts, {}, method {}", c.name, static_cast<int>(method)));
      add_case(study, c, method, reference);
    }
  }
  const Field photo = photographer(size);
  study.pictures.push_back({"start-random", "the random start", grey_picture(random_start(size, size), -1, 1)});
  study.pictures.push_back({"start-circles", "100 circles",
                            class_picture(positive_side(many_circles_start(size, size), whole_plane(size, size)))});
  study.pictures.push_back({"start-two-classes", "the two best classes of the photographer",
                            grey_picture(two_class_start(photo, whole_plane(size, size), Norm::l2), -1, 1)});
  return study;
}

}  // namespace heartgen::study
