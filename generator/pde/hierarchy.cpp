// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/hierarchy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "generator/pde/chan_vese.hpp"
#include "generator/pde/diffusion.hpp"
#include "model/error.hpp"

namespace heartgen::pde {
namespace {

constexpr const char* whole_image = "all";

std::string key(const SegmentationStep& step) { return fmt::format("segmentation step \"{}\"", step.name); }

/// "blood.above" -> {"blood", true}; nothing known about the name yet.
std::pair<std::string, bool> split_side(const std::string& name) {
  const auto dot = name.rfind('.');
  const std::string suffix = dot == std::string::npos ? "" : name.substr(dot + 1);
  if (suffix != "above" && suffix != "below")
    throw UserError(fmt::format("\"{}\" names no side of a step", name), "segmentation",
                    "write STEP.above or STEP.below");
  return {name.substr(0, dot), suffix == "above"};
}

const SegmentationSide& find_step(const SegmentationTree& tree, const std::string& step, const std::string& name) {
  const auto found = std::find_if(tree.begin(), tree.end(), [&](const auto& s) { return s.name == step; });
  if (found != tree.end()) return *found;
  std::string known;
  for (const auto& s : tree) known += (known.empty() ? "" : ", ") + s.name;
  throw UserError(fmt::format("\"{}\" refers to no earlier step", name), "segmentation",
                  known.empty() ? "the first step's domain is \"all\"" : "earlier steps: " + known);
}

Mask domain_of(const SegmentationStep& step, const SegmentationTree& tree, const Grid& grid) {
  Mask domain = step.domain == whole_image ? Mask(grid, 1) : side(tree, step.domain);
  if (std::find(domain.voxels.begin(), domain.voxels.end(), std::uint8_t{1}) == domain.voxels.end())
    throw UserError(fmt::format("the domain \"{}\" is empty", step.domain), key(step),
                    "the step before found only one side: check the image and that step's lambda and mu");
  return domain;
}

SegmentationSide split(const Volume<float>& image, const SegmentationStep& step, const SegmentationTree& tree,
                       const parallel::Comm& comm) {
  const Mask domain = parallel::run_on_root(comm, [&] { return domain_of(step, tree, image.grid); });
  const ChanVeseSettings settings{.norm = step.norm == "L1" ? Norm::l1 : Norm::l2,
                                  .lambda = step.lambda,
                                  .mu = step.mu,
                                  .max_iterations = step.max_iterations};
  ChanVeseMasks cut;
  if (step.smoothing > 0)
    cut = chan_vese(heat(image, {.iterations = step.smoothing}, comm), domain, settings, comm);
  else
    cut = chan_vese(image, domain, settings, comm);
  SegmentationSide result{step.name, {}, std::move(cut.above), cut.c_below, cut.c_above, cut.iterations};
  if (comm.is_root()) {
    result.below = domain;
    for (std::size_t v = 0; v < domain.voxels.size(); ++v) result.below.voxels[v] &= result.above.voxels[v] == 0;
  }
  return result;
}

}  // namespace

void check_steps(const std::vector<SegmentationStep>& steps) {
  SegmentationTree seen;
  for (const auto& step : steps) {
    const bool repeated = std::any_of(seen.begin(), seen.end(), [&](const auto& s) { return s.name == step.name; });
    if (step.name.empty() || repeated)
      throw UserError(step.name.empty() ? "a step has no name" : "the name is used twice", key(step),
                      "give every step a name of its own");
    if (step.norm != "L1" && step.norm != "L2")
      throw UserError(fmt::format("unknown norm \"{}\"", step.norm), key(step), "use \"L1\" or \"L2\"");
    if (step.domain != whole_image) find_step(seen, split_side(step.domain).first, step.domain);
    if (!(step.lambda > 0) || !(step.mu >= 0) || step.smoothing < 0 || step.max_iterations < 0)
      throw UserError("lambda must be positive, and mu, smoothing and max_iterations not negative", key(step),
                      "correct the recipe");
    seen.push_back({step.name, {}, {}, 0, 0});
  }
}

void check_side(const std::vector<SegmentationStep>& steps, const std::string& name, const std::string& where) {
  SegmentationTree names;
  for (const auto& step : steps) names.push_back({step.name, {}, {}, 0, 0});
  try {
    find_step(names, split_side(name).first, name);
  } catch (const UserError& error) {
    throw UserError(error.problem, where, error.remedy);
  }
}

SegmentationTree segment(const Volume<float>& image_on_root, const std::vector<SegmentationStep>& steps,
                         const parallel::Comm& comm) {
  check_steps(steps);
  SegmentationTree tree;
  for (const auto& step : steps) tree.push_back(split(image_on_root, step, tree, comm));
  return tree;
}

const Mask& side(const SegmentationTree& tree, const std::string& name) {
  const auto [step, above] = split_side(name);
  const auto& found = find_step(tree, step, name);
  return above ? found.above : found.below;
}

double grey_value(const SegmentationTree& tree, const std::string& name) {
  const auto [step, above] = split_side(name);
  const auto& found = find_step(tree, step, name);
  return above ? found.c_above : found.c_below;
}

}  // namespace heartgen::pde
