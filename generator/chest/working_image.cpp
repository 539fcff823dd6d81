// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/chest/working_image.hpp"

#include <algorithm>

#include "generator/image/distance.hpp"
#include "generator/image/gaussian.hpp"
#include "generator/parallel/threads.hpp"
#include "model/error.hpp"

namespace heartgen::chest {
namespace {

constexpr float outside_hu = -150;  // no air: lungs that the field of view of a slanted grid cuts do not open into it
constexpr double noise_sigma_mm = 1.0;     // walls of 2 mm between two pools still show
constexpr double smallest_extent_mm = 60;  // less cannot hold a left ventricle and its valves
constexpr double antialias_per_mm = 0.35;  // blur before thinning, per mm of difference between the spacings

/// The box around all voxel centres, along the LPS axes.
Grid working_grid(const Grid& grid, double spacing_mm) {
  Vec3 low{1e30, 1e30, 1e30}, high{-1e30, -1e30, -1e30};
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 index;
    for (int a = 0; a < 3; ++a)
      index[a] = ((corner >> a) & 1) ? static_cast<double>(grid.size[static_cast<std::size_t>(a)] - 1) : 0.0;
    const Vec3 p = lps_from_index(grid, index);
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], p[a]);
      high[a] = std::max(high[a], p[a]);
    }
  }
  Grid result;
  result.spacing_mm = {spacing_mm, spacing_mm, spacing_mm};
  result.origin_mm = low;
  for (int a = 0; a < 3; ++a) {
    if (high[a] - low[a] < smallest_extent_mm)
      throw UserError("the image is too thin to find a heart in", "landmarks",
                      "use a scan that shows the whole heart, or give the seeds by hand");
    result.size[static_cast<std::size_t>(a)] =
        static_cast<std::int64_t>(std::floor((high[a] - low[a]) / spacing_mm)) + 1;
  }
  return result;
}

Volume<float> as_float(const CtVolume& ct) {
  Volume<float> image(ct.grid);
  std::transform(ct.voxels.begin(), ct.voxels.end(), image.voxels.begin(),
                 [](std::int16_t hu) { return static_cast<float>(hu); });
  return image;
}

bool inside(const Grid& grid, const Vec3& index) {
  constexpr double slack = 1e-6;  // the last voxel centre counts, whatever the rounding
  for (int a = 0; a < 3; ++a) {
    const auto last = static_cast<double>(grid.size[static_cast<std::size_t>(a)] - 1);
    if (index[a] < -slack || index[a] > last + slack) return false;
  }
  return true;
}

}  // namespace

WorkingImage make_working_image(const CtVolume& ct, double spacing_mm) {
  const Grid grid = working_grid(ct.grid, spacing_mm);
  Volume<float> source = as_float(ct);
  const double finest = std::min({ct.grid.spacing_mm.x, ct.grid.spacing_mm.y, ct.grid.spacing_mm.z});
  const double sigma = antialias_per_mm * (spacing_mm - finest);
  if (sigma > 0) source = image::gaussian(source, sigma);
  WorkingImage image;
  image.hu = Volume<float>(grid, outside_hu);
  parallel::parallel_for(0, grid.size[2], [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < grid.size[1]; ++j)
        for (std::int64_t i = 0; i < grid.size[0]; ++i) {
          const Vec3 index = index_from_lps(source.grid, position_mm(grid, i, j, k));
          if (inside(source.grid, index)) image.hu(i, j, k) = static_cast<float>(sample_linear(source, index));
        }
  });
  image.smooth = image::gaussian(image.hu, noise_sigma_mm);
  return image;
}

Volume<float> thinned(const Volume<float>& image, std::int64_t step) {
  Grid grid = image.grid;
  for (std::size_t a = 0; a < 3; ++a) grid.size[a] = (grid.size[a] + step - 1) / step;
  grid.spacing_mm = static_cast<double>(step) * grid.spacing_mm;
  Volume<float> result(grid);
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i) result(i, j, k) = image(i * step, j * step, k * step);
  return result;
}

Volume<float> depth_of(const Mask& mask) { return image::distance_to(inverse(mask)); }

}  // namespace heartgen::chest
