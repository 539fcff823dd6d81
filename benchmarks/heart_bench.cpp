// SPDX-License-Identifier: GPL-3.0-or-later
// The image stages on a phantom of the thesis's size.
#include <fmt/format.h>

#include <algorithm>

#include "benchmarks/benchmarks.hpp"
#include "datasets/phantom/phantom.hpp"
#include "generator/anatomy/epicardium.hpp"
#include "generator/image/distance.hpp"
#include "generator/parallel/threads.hpp"
#include "generator/pde/diffusion.hpp"
#include "generator/pde/hierarchy.hpp"
#include "model/labels.hpp"
#include "model/recipe.hpp"

namespace heartgen::benchmarks {
namespace {

using parallel::Comm;

phantom::Phantom phantom_of(const Settings& settings) {
  phantom::PhantomSettings phantom;
  phantom.size = settings.size;
  phantom.spacing_mm = settings.spacing_mm;
  phantom.companions = phantom.fibers = false;
  return phantom::make_phantom(phantom);
}

std::string size_of(const Grid& grid) { return fmt::format("{} x {} x {}", grid.size[0], grid.size[1], grid.size[2]); }

Row memory_row(const char* bench, double voxels) {
  return {bench, "peak memory of the root, besides the image", peak_bytes() / voxels, "bytes/voxel", ""};
}

bool is_ventricle(std::uint8_t label) { return label == tag(Region::lv_blood) || label == tag(Region::rv_blood); }

bool is_cavity(std::uint8_t label) {
  for (const Region r : {Region::lv_blood, Region::rv_blood, Region::la_blood, Region::ra_blood, Region::aorta,
                         Region::pulmonary_artery})
    if (label == tag(r)) return true;
  return false;
}

/// Voxels in the band around the ventricles' blood: those that the cut has to decide on, about.
std::int64_t band_voxels(const LabelVolume& chambers, double band_mm) {
  Mask blood(chambers.grid);
  std::transform(chambers.voxels.begin(), chambers.voxels.end(), blood.voxels.begin(),
                 [](std::uint8_t label) { return is_ventricle(label) ? 1 : 0; });
  const auto distance = image::distance_to(blood);
  return std::count_if(distance.voxels.begin(), distance.voxels.end(),
                       [&](float d) { return d > 0 && d <= static_cast<float>(band_mm); });
}

}  // namespace

Table bench_segment(const Settings& settings, const Comm& comm) {
  parallel::set_thread_count(settings.threads);
  CtVolume ct;
  if (comm.is_root()) ct = phantom_of(settings).ct;
  const auto voxels = static_cast<double>(ct.voxels.size());
  Volume<float> image(ct.grid);
  std::copy(ct.voxels.begin(), ct.voxels.end(), image.voxels.begin());
  start_peak();
  const DenoiseSettings denoise;
  const double denoising = seconds([&] { image = pde::perona_malik(image, denoise, comm); });
  Table table{
      {"segment", fmt::format("denoising, {} steps, {}", denoise.iterations, size_of(ct.grid)), denoising, "s", ""}};
  double total = denoising;
  std::vector<SegmentationStep> steps;
  for (const auto& step : default_segmentation()) {  // the tree again and again, one step longer each time
    steps.push_back(step);
    const double until_here = seconds([&] { pde::segment(image, steps, comm); });
    table.push_back({"segment", fmt::format("tree up to the step \"{}\"", step.name), until_here, "s", ""});
    if (steps.size() == default_segmentation().size()) total += until_here;
  }
  table.push_back(
      {"segment", "denoising and the whole tree", total, "s", "goal: 30 s at 512 x 512 x 199 on two cores"});
  table.push_back(memory_row("segment", std::max(voxels, 1.0)));
  return table;
}

Table bench_epicardium(const Settings& settings, const Comm& comm) {
  parallel::set_thread_count(settings.threads);
  CtVolume ct;
  LabelVolume chambers;
  if (comm.is_root()) {
    auto phantom = phantom_of(settings);
    ct = std::move(phantom.ct);
    chambers = std::move(phantom.labels);
    for (auto& label : chambers.voxels) label = is_cavity(label) ? label : std::uint8_t{0};
  }
  const EpicardiumSettings walls;
  start_peak();
  anatomy::WallResult result;
  const double time = seconds([&] { result = anatomy::epicardium(ct, chambers, walls, comm); });
  Table table{{"epicardium", fmt::format("walls of ventricles and atria, {}", size_of(ct.grid)), time, "s",
               "goal: 15 s for the ventricles, 4.4 M voxels"}};
  table.push_back({"epicardium", "duality gap of the ventricles", result.ventricle_duality_gap, "",
                   fmt::format("{} iterations; goal: 1e-3", result.ventricle_iterations)});
  table.push_back({"epicardium", "duality gap of the atria", result.atrium_duality_gap, "",
                   fmt::format("{} iterations", result.atrium_iterations)});
  table.push_back(memory_row("epicardium", std::max(static_cast<double>(ct.voxels.size()), 1.0)));
  if (comm.is_root())
    table.push_back({"epicardium", "voxels in the band of the ventricles",
                     static_cast<double>(band_voxels(chambers, walls.ventricle_band_mm)) / 1e6, "M voxels", ""});
  return table;
}

}  // namespace heartgen::benchmarks
