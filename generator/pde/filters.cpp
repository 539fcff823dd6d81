// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/filters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "generator/parallel/slab.hpp"
#include "generator/pde/curvature.hpp"
#include "generator/pde/diffusion.hpp"
#include "generator/pde/fast_sweeping.hpp"
#include "generator/pde/redistance.hpp"
#include "generator/pde/sobolev.hpp"
#include "generator/pde/total_variation.hpp"
#include "model/error.hpp"
#include "model/text.hpp"

namespace heartgen::pde {
namespace {

using parallel::Comm;
using Image = parallel::Slab<float>;

/// The parameters of one call, all present.
struct Values {
  const std::map<std::string, double>& by_name;
  double operator[](const char* name) const { return by_name.at(name); }
  int count(const char* name) const { return static_cast<int>(by_name.at(name)); }
};

struct Filter {
  FilterInfo info;
  void (*apply)(Image& image, const Values& p, const Comm& comm);
};

FilterParameter iterations(int value) { return {"iterations", static_cast<double>(value), "number of steps"}; }
FilterParameter time_step(double value, const std::string& bound) {
  return {"time_step", value, "in units of the smallest squared spacing" + bound};
}

Filter make_curvature() {
  const CurvatureSettings d;
  return {{"curvature",
           "motion by mean curvature (thesis 3.4)",
           "u_t = |∇u| div(∇u / |∇u|), in flux form (3.12)",
           {iterations(d.iterations), time_step(d.time_step, "")}},
          [](Image& image, const Values& p, const Comm& comm) {
            curvature_motion(image, {p.count("iterations"), p["time_step"]}, comm);
          }};
}

Filter make_heat() {
  const HeatSettings d;
  return {{"heat",
           "heat equation (thesis 3.1)",
           "u_t = Δu (3.1)",
           {iterations(d.iterations), time_step(d.time_step, ", at most 1/6")}},
          [](Image& image, const Values& p, const Comm& comm) {
            heat(image, {p.count("iterations"), p["time_step"]}, comm);
          }};
}

Filter make_marquina_osher() {
  const MarquinaOsherSettings d;
  return {{"marquina_osher",
           "total variation in the form of Marquina and Osher (thesis 3.4)",
           "u_t = |∇u| (div(∇u / |∇u|) + lambda (g - u)) (3.15)",
           {{"lambda", d.lambda, "pull to the image, per mm and grey value"},
            iterations(d.iterations),
            time_step(d.time_step, "")}},
          [](Image& image, const Values& p, const Comm& comm) {
            marquina_osher(image, {p["lambda"], p.count("iterations"), p["time_step"]}, comm);
          }};
}

Filter make_perona_malik() {
  const DenoiseSettings d;
  return {{"perona_malik",
           "edge-preserving diffusion of Perona and Malik (thesis 3.2)",
           "u_t = div(c ∇u) (3.2), c = 1 / (1 + (d / edge_hu)²), d the difference of two neighbours",
           {iterations(d.iterations),
            time_step(d.time_step, ", at most 1/6"),
            {"edge_hu", d.edge_hu, "contrast at which diffusion falls to a half"}}},
          [](Image& image, const Values& p, const Comm& comm) {
            perona_malik(image, {p.count("iterations"), p["time_step"], p["edge_hu"]}, comm);
          }};
}

// Without one there is nothing to measure from: the image would come back as it is.
void require_zero_level(const Image& image, const char* filter, const Comm& comm) {
  const auto count = [&](const auto& is_counted) {
    return sum_rows(image, comm, [&](std::int64_t j, std::int64_t k) {
      const float* row = image.row(j, k);
      return static_cast<double>(std::count_if(row, row + image.grid.size[0], is_counted));
    });
  };
  const bool has_inside = count([](float v) { return v < 0; }) > 0;
  if (has_inside && count([](float v) { return v >= 0; }) > 0) return;
  throw UserError(has_inside ? "the image is negative everywhere: it has no zero level"
                             : "the image is negative nowhere: it has no zero level",
                  std::string("filter ") + filter,
                  "give one that is negative inside and positive outside: of a mask, 0.5 minus its values");
}

Filter make_redistance() {
  return {{"redistance",
           "signed distance to the zero level, mm, negative inside, by fast sweeping",
           "|∇φ| = 1, φ = 0 where the image is 0 (the steady state of 8.3); errors of a hundredth of a voxel",
           {}},
          [](Image& image, const Values&, const Comm& comm) {
            require_zero_level(image, "redistance", comm);
            fast_sweeping(image, comm);
          }};
}

Filter make_reinitialise() {
  const RedistanceSettings d;
  return {{"reinitialise",
           "the same by the evolution equation of thesis 8.2, near the zero level",
           "φ_t = S(φ0) (1 - |∇φ|) (8.3), |∇φ| upwind (8.6, 8.7)",
           {{"iterations", static_cast<double>(d.iterations), "number of steps; distances spread half a voxel each"}}},
          [](Image& image, const Values& p, const Comm& comm) {
            require_zero_level(image, "reinitialise", comm);
            redistance(image, {p.count("iterations")}, comm);
          }};
}

Filter make_sobolev() {
  const SobolevSettings d;
  return {{"sobolev",
           "Sobolev smoothing (thesis 3.3)",
           "min ∫ length² |∇u|² + (u - g)² (3.4)",
           {{"length_mm", d.smoothing_mm, "details smaller than this are smoothed"},
            {"tolerance", d.tolerance, "relative error of the solution"}}},
          [](Image& image, const Values& p, const Comm& comm) {
            sobolev(image, {p["length_mm"], p["tolerance"]}, comm);
          }};
}

Filter make_total_variation(const char* name, const char* help, const char* equation, double lambda, const char* unit,
                            void (*apply)(Image&, const Values&, const Comm&)) {
  return {{name, help, equation, {{"lambda", lambda, unit}, iterations(TotalVariationSettings{}.iterations)}}, apply};
}

const std::vector<Filter>& registry() {
  static const std::vector<Filter> all{
      make_curvature(),
      make_heat(),
      make_marquina_osher(),
      make_perona_malik(),
      make_redistance(),
      make_reinitialise(),
      make_sobolev(),
      make_total_variation("tv_l1", "total variation with L1 fidelity (thesis 3.4)",
                           "min ∫ |∇u| + lambda |u - g| (3.17)", 1,
                           "weight of the fidelity, per mm: discs with radii below 2 / lambda vanish",
                           [](Image& image, const Values& p, const Comm& comm) {
                             total_variation_l1(image, {p["lambda"], p.count("iterations")}, comm);
                           }),
      make_total_variation("tv_l2", "total variation with L2 fidelity (thesis 3.4)",
                           "min ∫ |∇u| + lambda (u - g)² (3.8)", 0.02, "weight of the fidelity, per mm and grey value",
                           [](Image& image, const Values& p, const Comm& comm) {
                             total_variation_l2(image, {p["lambda"], p.count("iterations")}, comm);
                           }),
  };
  return all;
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& known) {
  std::string list;
  for (const auto& name : known) list += (list.empty() ? "" : ", ") + name;
  if (known.empty()) return std::string("it takes none");
  return "did you mean \"" + nearest_name(word, known) + "\"? Known: " + list;
}

const Filter& find(const std::string& name) {
  for (const auto& filter : registry())
    if (filter.info.name == name) return filter;
  throw UserError("unknown filter \"" + name + "\"", "filter", did_you_mean(name, filter_names()));
}

std::map<std::string, double> complete(const FilterInfo& info, const std::map<std::string, double>& given) {
  std::map<std::string, double> values;
  std::vector<std::string> names;
  for (const auto& parameter : info.parameters) {
    values[parameter.name] = parameter.default_value;
    names.push_back(parameter.name);
  }
  for (const auto& [name, value] : given) {
    const std::string where = "filter " + info.name;
    if (!values.contains(name)) throw UserError("unknown parameter \"" + name + "\"", where, did_you_mean(name, names));
    if (!std::isfinite(value)) throw UserError(name + " must be a finite number", where, "");
    if (name == "iterations" && (value != std::floor(value) || value < 0 || value > 1e6))
      throw UserError("iterations must be a whole number from 0 to 1000000", where, "");
    values[name] = value;
  }
  return values;
}

void check_image(const Volume<float>& image) {
  if (image.voxels.empty()) throw UserError("the image is empty", "filter", "check the input file");
  if (!std::ranges::all_of(image.voxels, [](float v) { return std::isfinite(v); }))
    throw UserError("the image holds values that are not finite", "filter", "replace NaN and infinity first");
}

/// 32-bit floats end at 3e38, their squares' roots at 1e19: images that mark holes by -3.4e38 reach that.
void check_result(const Volume<float>& image, const Volume<float>& result) {
  if (std::ranges::all_of(result.voxels, [](float v) { return std::isfinite(v); })) return;
  const auto [least, most] = std::ranges::minmax(image.voxels);
  throw UserError(fmt::format("the result is not finite: the image's values reach from {:g} to {:g}", least, most),
                  "filter", "replace such values first, and take shorter time steps");
}

}  // namespace

const std::vector<FilterInfo>& filters() {
  static const std::vector<FilterInfo> infos = [] {
    std::vector<FilterInfo> list;
    for (const auto& filter : registry()) list.push_back(filter.info);
    return list;
  }();
  return infos;
}

std::vector<std::string> filter_names() {
  std::vector<std::string> names;
  for (const auto& filter : registry()) names.push_back(filter.info.name);
  return names;
}

Volume<float> apply_filter(const std::string& name, const Volume<float>& image_on_root,
                           const std::map<std::string, double>& parameters, const Comm& comm) {
  const Filter& filter = find(name);
  const auto values = complete(filter.info, parameters);
  parallel::run_on_root(comm, [&] { check_image(image_on_root); });
  auto slab = parallel::scatter(image_on_root, comm);
  filter.apply(slab, Values{values}, comm);
  auto result = parallel::gather(slab, comm);
  parallel::run_on_root(comm, [&] { check_result(image_on_root, result); });
  return result;
}

}  // namespace heartgen::pde
