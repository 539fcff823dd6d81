// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "benchmarks/study/initial_conditions.hpp"
#include "benchmarks/study/studies.hpp"
#include "benchmarks/study/two_phase.hpp"
#include "datasets/phantom/phantom.hpp"
#include "generator/parallel/threads.hpp"
#include "generator/pde/hierarchy.hpp"
#include "model/labels.hpp"

namespace heartgen::study {
namespace {

/// One row of Tables 5.3 to 5.6.
struct RoadStep {
  double mu, lambda;
  int smoothing;  ///< steps of the heat equation, Δt = 0.1
};

struct Road {
  std::string name, title, table;
  Norm norm;
  std::vector<RoadStep> steps;
};

const std::vector<Road>& roads() {
  static const std::vector<Road> all = {
      {"l2", "L2, original image", "Table 5.3", Norm::l2, {{0, 1, 0}, {1, 0.01, 0}, {1, 0.00008, 0}, {1, 0.0002, 0}}},
      {"l2-smoothed",
       "L2, smoothed images",
       "Table 5.4",
       Norm::l2,
       {{0, 1, 0}, {1, 0.01, 5}, {1, 0.001, 5}, {1, 0.0002, 15}}},
      {"l1", "L1, original image", "Table 5.5", Norm::l1, {{0, 1, 0}, {1, 0.01, 0}, {1, 0.005, 0}}},
      {"l1-smoothed", "L1, smoothed images", "Table 5.6", Norm::l1, {{0, 1, 5}, {1, 2, 5}, {1, 1, 15}}},
  };
  return all;
}

/// A slice of the phantom through the ventricles, with what is muscle and where the heart is.
struct Slice {
  Field image;            ///< HU
  PixelLabels muscle;     ///< walls of ventricles and atria, papillary muscles
  PixelLabels heart;      ///< muscle and the blood of the chambers, and a rim of three pixels around them
  PixelLabels left_wall;  ///< the wall that the road must follow
};

bool is_chamber(Region region) {
  return region == Region::lv_blood || region == Region::rv_blood || region == Region::la_blood ||
         region == Region::ra_blood;
}

PixelLabels grown(const PixelLabels& marked, int reach) {
  PixelLabels result(marked.width, marked.height);
  for (int j = 0; j < marked.height; ++j)
    for (int i = 0; i < marked.width; ++i)
      for (int y = std::max(0, j - reach); y <= std::min(marked.height - 1, j + reach); ++y)
        for (int x = std::max(0, i - reach); x <= std::min(marked.width - 1, i + reach); ++x)
          if (marked(x, y) && (x - i) * (x - i) + (y - j) * (y - j) <= reach * reach) result(i, j) = 1;
  return result;
}

Slice phantom_slice(bool quick) {
  phantom::PhantomSettings settings;
  const int size = quick ? 128 : 256;
  const double spacing = 0.7 * 256 / size;
  settings.size = {size, size, 9};
  settings.spacing_mm = {spacing, spacing, 1.9};
  settings.companions = false;
  const phantom::Phantom phantom = phantom::make_phantom(settings);
  constexpr std::int64_t middle = 4;
  Slice slice{Field(size, size), PixelLabels(size, size), PixelLabels(size, size), PixelLabels(size, size)};
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) {
      const auto region = static_cast<Region>(phantom.labels(i, j, middle));
      slice.image(i, j) = phantom.ct(i, j, middle);
      slice.muscle(i, j) = is_myocardium(region);
      slice.heart(i, j) = is_myocardium(region) || is_chamber(region);
      slice.left_wall(i, j) = region == Region::lv_myocardium;
    }
  slice.heart = grown(slice.heart, 3);
  return slice;
}

/// The heat equation (3.1), explicit, on the whole image.
Field smoothed(const Field& image, int steps) {
  const Domain plane = whole_plane(image.width, image.height);
  Field u = image;
  Workspace w(image.width, image.height);
  for (int n = 0; n < steps; ++n) {
    take_differences(u, plane, w.d);
    for (int j = 0; j < u.height; ++j)
      for (int i = 0; i < u.width; ++i)
        u(i, j) += 0.1 * (w.d.face_x(i, j) - w.d.face_x(i - 1, j) + w.d.face_y(i, j) - w.d.face_y(i, j - 1));
  }
  return u;
}

std::int64_t common(const PixelLabels& a, const PixelLabels& b) {
  std::int64_t count = 0;
  for (std::size_t n = 0; n < a.values.size(); ++n) count += a.values[n] && b.values[n];
  return count;
}

double dice(const PixelLabels& a, const PixelLabels& b) {
  const auto sum = common(a, a) + common(b, b);
  return sum ? 2.0 * static_cast<double>(common(a, b)) / static_cast<double>(sum) : 1;
}

PixelLabels within(const PixelLabels& a, const PixelLabels& b) {
  PixelLabels both = a;
  for (std::size_t n = 0; n < a.values.size(); ++n) both.values[n] = a.values[n] && b.values[n];
  return both;
}

/// Both sides of a step, and the one that holds more of the left ventricle's wall.
struct Cut {
  PixelLabels below, above;
  double c_below = 0, c_above = 0;
  int iterations = 0;
};

bool above_is_kept(const Cut& cut, const Slice& slice) {
  return common(cut.above, slice.left_wall) >= common(cut.below, slice.left_wall);
}

/// A step by the thesis's flow (method 3), from the two best classes, until no pixel changes sides.
Cut flow_cut(const Field& image, const PixelLabels& domain_labels, const RoadStep& step, Norm norm) {
  const Domain domain = part_of_plane(domain_labels);
  FlowSettings settings;
  settings.norm = norm, settings.mu = step.mu, settings.lambda = step.lambda;
  settings.max_iterations = 3000, settings.calm_iterations = 50;
  const FlowResult flow = chan_vese_flow(image, two_class_start(image, domain, norm), domain, settings);
  Cut cut{domain_labels, domain_labels, flow.c.negative, flow.c.positive, flow.last_change};
  const bool positive_above = flow.c.positive >= flow.c.negative;
  for (int j = 0; j < image.height; ++j)
    for (int i = 0; i < image.width; ++i) {
      const bool above = (flow.phi(i, j) >= 0) == positive_above;
      cut.above(i, j) = domain_labels(i, j) && above;
      cut.below(i, j) = domain_labels(i, j) && !above;
    }
  if (!positive_above) std::swap(cut.c_below, cut.c_above);
  return cut;
}

Volume<float> as_volume(const Field& image) {
  Grid grid;
  grid.size = {image.width, image.height, 1};
  Volume<float> volume(grid);
  for (int j = 0; j < image.height; ++j)
    for (int i = 0; i < image.width; ++i) volume(i, j, 0) = static_cast<float>(image(i, j));
  return volume;
}

PixelLabels as_labels(const Mask& mask) {
  PixelLabels labels(static_cast<int>(mask.grid.size[0]), static_cast<int>(mask.grid.size[1]));
  labels.values = mask.voxels;
  return labels;
}

/// The recipe's step with the same weights: its fidelity is divided by |c1 - c2|^p, so lambda is multiplied by it.
SegmentationStep recipe_step(std::size_t number, const std::string& domain, const RoadStep& step, Norm norm,
                             double contrast) {
  SegmentationStep result;
  result.name = fmt::format("step{}", number);
  result.domain = domain;
  result.norm = norm == Norm::l1 ? "L1" : "L2";
  result.mu = step.mu;
  result.lambda = step.lambda * (norm == Norm::l1 ? contrast : contrast * contrast);
  result.smoothing = step.smoothing;
  result.max_iterations = 2000;
  return result;
}

/// The last step of a recipe's tree.
Cut tree_cut(const Field& image, const std::vector<SegmentationStep>& steps) {
  const pde::SegmentationTree tree = pde::segment(as_volume(image), steps, parallel::self());
  const auto& last = tree.back();
  return {as_labels(last.below), as_labels(last.above), last.c_below, last.c_above, last.iterations};
}

/// Ignored grey, the side that is left dark, the side that is kept light.
report::Canvas step_picture(const Slice& slice, const Cut& cut, bool above_kept, int zoom) {
  report::Canvas canvas = grey_picture(slice.image, -200, 500, zoom);
  const PixelLabels &kept = above_kept ? cut.above : cut.below, &left = above_kept ? cut.below : cut.above;
  for (int y = 0; y < canvas.height; ++y)
    for (int x = 0; x < canvas.width; ++x) {
      auto& pixel = canvas.pixels[canvas.at(x, y)];
      if (kept(x / zoom, y / zoom)) pixel = report::mix(pixel, {215, 70, 60}, 0.55);
      if (left(x / zoom, y / zoom)) pixel = report::mix(pixel, {60, 110, 210}, 0.55);
    }
  return canvas;
}

std::vector<std::string> step_row(std::size_t number, const RoadStep& step, const char* by, const Cut& cut,
                                  bool above_kept, double muscle, const std::string& agreement) {
  return {std::to_string(number),
          by,
          fmt::format("{:g}", step.mu),
          fmt::format("{:g}", step.lambda),
          std::to_string(step.smoothing),
          std::to_string(cut.iterations),
          fmt::format("{:.0f} | {:.0f}", cut.c_below, cut.c_above),
          above_kept ? "brighter" : "darker",
          fmt::format("{:.3f}", muscle),
          agreement};
}

struct RoadEnd {
  double flow_muscle = 0, tree_muscle = 0;  ///< Dice with the true walls, in the heart
  double agreement = 1;                     ///< least Dice between the two over the steps, of the side that is kept
};

/// All steps of a road by the thesis's flow.
std::vector<Cut> flow_cuts(const Slice& slice, const Road& road) {
  PixelLabels domain(slice.image.width, slice.image.height, 1);
  std::vector<Cut> cuts;
  for (const auto& step : road.steps) {
    cuts.push_back(flow_cut(smoothed(slice.image, step.smoothing), domain, step, road.norm));
    domain = above_is_kept(cuts.back(), slice) ? cuts.back().above : cuts.back().below;
  }
  return cuts;
}

struct Travelled {
  StudyResult part;  ///< a road's table, pictures and statements
  RoadEnd end;
};

Travelled travel(const Slice& slice, const Road& road, const std::vector<Cut>& flows, int zoom) {
  StudyResult study;
  Table table{
      road.name,
      fmt::format("{} ({})", road.title, road.table),
      {"step", "by", "μ", "λ", "smoothing", "iterations", "c (HU)", "kept", "Dice of the walls", "Dice of the two"},
      {}};
  PixelLabels domain(slice.image.width, slice.image.height, 1);
  std::vector<SegmentationStep> recipe;
  std::string recipe_domain = "all";
  RoadEnd end;
  for (std::size_t n = 1; n <= road.steps.size(); ++n) {
    const RoadStep& step = road.steps[n - 1];
    const Cut& flow = flows[n - 1];
    recipe.push_back(recipe_step(n, recipe_domain, step, road.norm, flow.c_above - flow.c_below));
    const Cut tree = tree_cut(slice.image, recipe);
    const bool flow_above = above_is_kept(flow, slice), tree_above = above_is_kept(tree, slice);
    domain = flow_above ? flow.above : flow.below;
    const PixelLabels tree_side = tree_above ? tree.above : tree.below;
    recipe_domain = recipe.back().name + (tree_above ? ".above" : ".below");
    end.flow_muscle = dice(within(domain, slice.heart), slice.muscle);
    end.tree_muscle = dice(within(tree_side, slice.heart), slice.muscle);
    const double same = dice(domain, tree_side);
    end.agreement = std::min(end.agreement, same);
    table.rows.push_back(step_row(n, step, "flow of the thesis", flow, flow_above, end.flow_muscle, ""));
    table.rows.push_back(
        step_row(n, step, "tree of the recipe", tree, tree_above, end.tree_muscle, fmt::format("{:.3f}", same)));
    study.pictures.push_back({fmt::format("{}-step-{}", road.name, n),
                              fmt::format("{}, step {}: kept red, left blue", road.title, n),
                              step_picture(slice, flow, flow_above, zoom)});
  }
  report::Canvas walls = grey_picture(slice.image, -200, 500, zoom);
  draw_border(walls, within(domain, slice.heart), zoom, {230, 60, 50});
  study.pictures.push_back({road.name + "-walls", road.title + ": what is kept, near the heart", walls});
  study.tables.push_back(table);
  study.claims = {{road.table, "the road ends at the walls of the heart", end.flow_muscle >= 0.8,
                   fmt::format("Dice {:.3f} (flow), {:.3f} (tree)", end.flow_muscle, end.tree_muscle)},
                  {road.table, "the recipe's tree takes the same road", end.agreement >= 0.95,
                   fmt::format("least Dice of the two over the steps {:.3f}", end.agreement)}};
  return {std::move(study), end};
}

/// Section 5.4 on the flows: original L2, smoothed L2, original L1, smoothed L1, in the order of `roads`.
std::vector<Claim> comparisons(const std::vector<RoadEnd>& ends) {
  const auto both = [&](std::size_t a, std::size_t b) {
    return fmt::format("Dice of the walls {:.3f} and {:.3f}", ends[a].flow_muscle, ends[b].flow_muscle);
  };
  return {{"5.4", "on the original image L1 gets the muscle in three steps, cleaner than L2 in four",
           ends[2].flow_muscle > ends[0].flow_muscle, both(2, 0)},
          {"5.4", "smoothing first shifts the L1 contour", ends[3].flow_muscle < ends[2].flow_muscle, both(3, 2)}};
}

template <class T>
void append(std::vector<T>& to, const std::vector<T>& more) {
  to.insert(to.end(), more.begin(), more.end());
}

}  // namespace

StudyResult study_hierarchy(const StudySettings& settings) {
  if (settings.progress) settings.progress("a slice of the phantom");
  const Slice slice = phantom_slice(settings.quick);
  const int zoom = settings.quick ? 2 : 1;
  StudyResult study{
      "hierarchy",
      "The hierarchy on a slice of a heart (5.3, 5.4)",
      "A slice through the ventricles of the phantom (256 × 256 pixels of 0.7 mm, noise 22 HU), with the parameters "
      "that the thesis gives for its own slice, in HU and pixels. At each step the side with more of the left "
      "ventricle's wall is kept. The Dice of the walls is against all true walls, within three pixels of the heart. "
      "The recipe's tree gets the same λ, times the contrast by which it divides.",
      {},
      {},
      {{"slice", "the slice", grey_picture(slice.image, -200, 500, zoom)}},
      {}};
  report::Canvas truth = grey_picture(slice.image, -200, 500, zoom);
  draw_border(truth, slice.muscle, zoom, {60, 200, 90});
  study.pictures.push_back({"truth", "the true walls", truth});
  if (settings.progress) settings.progress("the four roads");
  // The flows side by side; the trees, which have threads of their own, one after the other.
  std::vector<std::vector<Cut>> flows(roads().size());
  parallel::parallel_for(0, static_cast<std::int64_t>(flows.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = begin; n < end; ++n)
      flows[static_cast<std::size_t>(n)] = flow_cuts(slice, roads()[static_cast<std::size_t>(n)]);
  });
  std::vector<RoadEnd> ends;
  for (std::size_t n = 0; n < flows.size(); ++n) {
    const auto [part, end] = travel(slice, roads()[n], flows[n], zoom);
    ends.push_back(end);
    append(study.tables, part.tables);
    append(study.pictures, part.pictures);
    append(study.claims, part.claims);
  }
  append(study.claims, comparisons(ends));
  return study;
}

}  // namespace heartgen::study
