// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/app/segment_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <nlohmann/json.hpp>

#include "generator/adapters/itk_io.hpp"
#include "generator/pde/diffusion.hpp"
#include "generator/pipeline/stage_files.hpp"
#include "model/recipe.hpp"

namespace heartgen::app {
namespace {

using Json = nlohmann::ordered_json;

struct Timer {
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); }
};

std::int64_t voxels_in(const Mask& mask) {
  return static_cast<std::int64_t>(std::count(mask.voxels.begin(), mask.voxels.end(), std::uint8_t{1}));
}

Json steps_json(const std::vector<SegmentationStep>& steps, const pde::SegmentationTree& tree) {
  Json list = Json::array();
  for (std::size_t n = 0; n < tree.size(); ++n)
    list.push_back({{"name", tree[n].name},
                    {"domain", steps[n].domain},
                    {"norm", steps[n].norm},
                    {"mu", steps[n].mu},
                    {"c_below", tree[n].c_below},
                    {"c_above", tree[n].c_above},
                    {"voxels_below", voxels_in(tree[n].below)},
                    {"voxels_above", voxels_in(tree[n].above)},
                    {"iterations", tree[n].iterations}});
  return list;
}

Json leaves_json(const pipeline::LeafImage& leaves) {
  std::array<std::int64_t, 256> count{};
  for (const auto value : leaves.leaf.voxels) ++count[value];
  Json list = Json::array();
  for (std::size_t n = 0; n < leaves.sides.size(); ++n)
    list.push_back({{"value", n + 1}, {"voxels", count[n + 1]}, {"sides", leaves.sides[n]}});
  return list;
}

void print_table(const Json& result) {
  fmt::print("{:<12} {:<16} {:<4} {:>10} {:>10} {:>12} {:>12} {:>10}\n", "step", "domain", "norm", "c below", "c above",
             "voxels below", "voxels above", "iterations");
  for (const auto& step : result["steps"])
    fmt::print("{:<12} {:<16} {:<4} {:>10.2f} {:>10.2f} {:>12} {:>12} {:>10}\n", step["name"].get<std::string>(),
               step["domain"].get<std::string>(), step["norm"].get<std::string>(), step["c_below"].get<double>(),
               step["c_above"].get<double>(), step["voxels_below"].get<std::int64_t>(),
               step["voxels_above"].get<std::int64_t>(), step["iterations"].get<int>());
  for (const auto& leaf : result["leaves"])
    fmt::print("value {:>3}  {:>12} voxels  {}\n", leaf["value"].get<int>(), leaf["voxels"].get<std::int64_t>(),
               fmt::join(leaf["sides"].get<std::vector<std::string>>(), " and "));
  fmt::print("denoising {:.2f} s, tree {:.2f} s\n{}\n", result["denoise_seconds"].get<double>(),
             result["tree_seconds"].get<double>(), result["labels"].get<std::string>());
}

}  // namespace

int segment_command(const SegmentCommand& command, const parallel::Comm& comm) {
  const Recipe recipe = read_recipe(command.recipe);
  adapters::check_image_output(command.output);
  const auto image = parallel::run_on_root(comm, [&] { return adapters::read_image(command.image); });
  const Timer denoising;
  const auto smooth = pde::perona_malik(image, recipe.denoise, comm);
  const double denoise_seconds = denoising.seconds();
  const Timer splitting;
  const auto tree = pde::segment(smooth, recipe.segmentation, comm);
  const double tree_seconds = splitting.seconds();
  parallel::run_on_root(comm, [&] {
    const pipeline::LeafImage leaves = pipeline::leaf_image(tree);
    adapters::write_volume(command.output, leaves.leaf);
    const Json result{{"labels", command.output},
                      {"steps", steps_json(recipe.segmentation, tree)},
                      {"leaves", leaves_json(leaves)},
                      {"denoise_seconds", denoise_seconds},
                      {"tree_seconds", tree_seconds}};
    if (command.json)
      fmt::print("{}\n", result.dump(1));
    else
      print_table(result);
  });
  return 0;
}

}  // namespace heartgen::app
