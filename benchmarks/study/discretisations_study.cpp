// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "benchmarks/study/convergence.hpp"
#include "benchmarks/study/global_minimum.hpp"
#include "benchmarks/study/initial_conditions.hpp"
#include "benchmarks/study/studies.hpp"
#include "benchmarks/study/test_images.hpp"

namespace heartgen::study {
namespace {

constexpr std::array<std::pair<Length, const char*>, 3> lengths = {
    {{Length::heaviside, "Heaviside"}, {Length::smereka, "Smereka"}, {Length::piecewise_linear, "piecewise linear"}}};

/// Of the seven methods, by one length.
using Energies = std::array<double, discretisation_count>;

/// 100 circles: of the four starts, the one from which all that the thesis says of Table 5.2 and Fig 5.6 comes out.
constexpr std::size_t compared_start = 2;

std::vector<FollowedFlow> seven_flows(const Field& start, bool quick) {
  std::vector<FollowedFlow> flows;
  for (int n = 1; n <= discretisation_count; ++n) {
    FlowSettings settings;
    settings.method = static_cast<Discretisation>(n);
    settings.max_iterations = quick ? 1500 : 5000;
    flows.push_back({name_of(settings.method), start, settings});
  }
  return flows;
}

double energy_of(const Field& image, const Field& phi, const Domain& plane, Length length) {
  const FlowSettings s;
  return energy(image, phi, plane, s.norm, s.mu, s.lambda, length);
}

/// By each of the lengths.
std::array<Energies, 3> energies_of(const Field& image, const Domain& plane, const std::vector<FollowedFlow>& flows) {
  std::array<Energies, 3> all{};
  for (std::size_t k = 0; k < all.size(); ++k)
    for (std::size_t n = 0; n < flows.size(); ++n)
      all[k][n] = energy_of(image, flows[n].result.phi, plane, lengths[k].first);
  return all;
}

/// The methods' numbers by rising energy: "5 4 3 2 1 7 6".
std::string order_of(const Energies& e) {
  std::array<std::size_t, discretisation_count> order{};
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return e[a] < e[b]; });
  std::string text;
  for (const auto n : order) text += fmt::format("{}{}", text.empty() ? "" : " ", n + 1);
  return text;
}

/// Whether every method of `low` has less energy than every method of `high` (numbers from 1).
bool below(const Energies& e, const std::vector<std::size_t>& low, const std::vector<std::size_t>& high) {
  for (const auto a : low)
    for (const auto b : high)
      if (!(e[a - 1] < e[b - 1])) return false;
  return true;
}

/// The statements of Table 5.2, each by each length.
std::vector<Claim> ordering_claims(const std::array<Energies, 3>& all) {
  struct Statement {
    const char* text;
    std::vector<std::size_t> low, high;
  };
  static const std::vector<Statement> statements = {
      {"methods 4 and 5 have the least energy", {4, 5}, {1, 2, 3, 6, 7}},
      {"methods 2 and 3 come next", {2, 3}, {1, 6, 7}},
      {"method 1 is better than 6 and 7 only", {1}, {6, 7}},
      {"method 6 is the worst", {1, 2, 3, 4, 5, 7}, {6}},
  };
  std::vector<Claim> claims;
  for (const auto& statement : statements)
    for (std::size_t k = 0; k < lengths.size(); ++k)
      claims.push_back({"Table 5.2", fmt::format("{} ({} length)", statement.text, lengths[k].second),
                        below(all[k], statement.low, statement.high),
                        fmt::format("order of the methods, least energy first: {}", order_of(all[k]))});
  return claims;
}

std::vector<Claim> claims(const std::array<Energies, 3>& all, const std::vector<FollowedFlow>& flows,
                          double reference_energy, double close) {
  const auto at = [&](int method) {
    return settled_within(flows[static_cast<std::size_t>(method - 1)].distance, close);
  };
  const auto text = [&](int method) {
    return settled_text(flows[static_cast<std::size_t>(method - 1)].distance, close);
  };
  bool fourth_first = at(4) >= 0;
  for (const int other : {1, 2, 3, 5, 6, 7}) fourth_first = fourth_first && (at(other) < 0 || at(4) <= at(other));
  const Curve& sixth = flows[5].distance;
  const double best_of_sixth = *std::min_element(sixth.y.begin(), sixth.y.end());
  const double least = *std::min_element(all[0].begin(), all[0].end());
  std::vector<Claim> found = ordering_claims(all);
  const std::vector<Claim> more = {
      {"Fig 5.6", "of the methods that converge, method 4 is the fastest", fourth_first,
       fmt::format("iterations until at most {:.0f} pixels differ for good, methods 1 to 7: {}, {}, {}, {}, {}, {}, {}",
                   close, text(1), text(2), text(3), text(4), text(5), text(6), text(7))},
      {"Fig 5.6", "method 6 stagnates", at(6) < 0 && sixth.y.back() > 4 * close,
       fmt::format("it ends with {:.0f} differing pixels", sixth.y.back())},
      {"Fig 5.6", "method 6 is very fast at first", best_of_sixth < 0.5 * sixth.y.front(),
       fmt::format("from {:.0f} differing pixels it never gets below {:.0f}", sixth.y.front(), best_of_sixth)},
      {"beyond", "the convex solver's energy (Heaviside) is not above that of any of the seven",
       reference_energy <= least, fmt::format("{:.2f}, least of the seven {:.2f}", reference_energy, least)},
  };
  found.insert(found.end(), more.begin(), more.end());
  return found;
}

Table energy_table(const Field& image, const Domain& plane, const std::vector<FollowedFlow>& flows,
                   const GlobalMinimum& reference, double close) {
  Table table{"table-5-2",
              "Energies of the segmentations by three lengths, in the order of the thesis's Table 5.2",
              {"method", "Heaviside", "Smereka", "piecewise linear", "iterations", "steady", "pixels that differ",
               "settled at"},
              {}};
  const auto row = [&](const std::string& name, const Field& phi) {
    std::vector<std::string> cells{name};
    for (const auto& length : lengths)
      cells.push_back(fmt::format("{:.3f}", energy_of(image, phi, plane, length.first)));
    return cells;
  };
  for (const auto& flow : flows) {
    auto cells = row(flow.name, flow.result.phi);
    cells.insert(cells.end(), {std::to_string(flow.result.iterations), flow.result.steady ? "yes" : "no",
                               fmt::format("{:.0f}", flow.distance.y.back()), settled_text(flow.distance, close)});
    table.rows.push_back(cells);
  }
  auto cells = row(fmt::format("convex solver (gap {:.1e})", reference.relative_gap), reference.phi);
  cells.insert(cells.end(), {std::to_string(reference.iterations), "yes", "0", ""});
  table.rows.push_back(cells);
  return table;
}

Plot energy_plot(const std::array<Energies, 3>& all) {
  Plot plot{"table-5-2", "Energies of the segmentations", "method", "energy", false, false, {}};
  for (std::size_t k = 0; k < all.size(); ++k) {
    plot.curves.push_back({std::string(lengths[k].second) + " length", {}, {all[k].begin(), all[k].end()}});
    for (int method = 1; method <= discretisation_count; ++method) plot.curves.back().x.push_back(method);
  }
  return plot;
}

/// The seven methods from one start.
struct Comparison {
  const char* start;
  std::vector<FollowedFlow> flows;
  std::array<Energies, 3> energies;
};

std::vector<Comparison> compare(const Field& image, const Domain& plane, const GlobalMinimum& reference,
                                const StudySettings& settings) {
  std::vector<Comparison> all;
  for (const auto& start : four_starts(image, plane)) {
    if (settings.progress)
      settings.progress(
          fmt::format("seven discretisations on {} × {} pixels, from {}", image.width, image.height, start.name));
    auto flows = seven_flows(start.phi, settings.quick);
    follow(image, plane, positive_side(reference.phi, plane), flows);
    const auto energies = energies_of(image, plane, flows);
    all.push_back({start.name, std::move(flows), energies});
  }
  return all;
}

Table order_table(const std::vector<Comparison>& comparisons) {
  Table table{"table-5-2-starts",
              "Order of the methods from the four starts of 5.2, least energy first",
              {"start", "Heaviside", "Smereka", "piecewise linear", "statements on Table 5.2 that hold"},
              {{"thesis, Table 5.2 (start not told)", "5 4 3 2 1 7 6", "4 5 3 2 1 7 6", "5 4 3 2 1 7 6", ""}}};
  for (const auto& c : comparisons) {
    const auto said = ordering_claims(c.energies);
    const auto held = std::count_if(said.begin(), said.end(), [](const Claim& claim) { return claim.holds; });
    table.rows.push_back({c.start, order_of(c.energies[0]), order_of(c.energies[1]), order_of(c.energies[2]),
                          fmt::format("{} of {}", held, said.size())});
  }
  return table;
}

}  // namespace

StudyResult study_discretisations(const StudySettings& settings) {
  const int size = settings.quick ? 128 : 256;
  const Field image = photographer(size);
  const Domain plane = whole_plane(size, size);
  if (settings.progress) settings.progress("the convex reference");
  GlobalSettings tight;
  tight.relative_gap = 1e-5;
  const GlobalMinimum reference = global_minimum(image, plane, tight);
  const auto comparisons = compare(image, plane, reference, settings);
  const auto& [start, flows, energies] = comparisons[compared_start];

  const double close = 1.5e-3 * size * size;
  StudyResult study{
      "discretisations",
      "Seven discretisations (5.1.2)",
      fmt::format(
          "μ = 2, λ = 0.00004, β = 5, Δt = 0.1 as in the thesis, on {0} × {0} pixels of an image of our own (the "
          "thesis's is not free), from {2}; the thesis names neither its start nor its |∇φ|, and the order of the "
          "methods depends on the start (see the second table). Here |∇φ| is central for the curvature and upwind for "
          "the force in methods 1 and 2, and one two-sided norm in method 3. \"Settled\" means that at most {1:.0f} "
          "pixels differ from the convex solution for good.",
          size, close, start),
      {energy_table(image, plane, flows, reference, close), order_table(comparisons)},
      {{"fig-5-6", "Distance to the minimum (5.22)", "iteration", "pixels that differ", true, true, {}},
       energy_plot(energies)},
      {{"image", "the image", grey_picture(image, 0, 255)},
       {"reference", "convex solver", class_picture(positive_side(reference.phi, plane))}},
      claims(energies, flows, reference.energy, close)};
  for (std::size_t n = 0; n < flows.size(); ++n) {
    study.plots[0].curves.push_back(flows[n].distance);
    study.pictures.push_back(
        {fmt::format("sides-{}", n + 1), flows[n].name, class_picture(positive_side(flows[n].result.phi, plane))});
  }
  for (std::size_t n = 0; n < flows.size(); ++n)
    study.pictures.push_back(
        {fmt::format("phi-{}", n + 1), "final φ of " + flows[n].name, grey_picture(flows[n].result.phi)});
  return study;
}

}  // namespace heartgen::study
