// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/vessel_snakes.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "generator/anatomy/vessel.hpp"
#include "generator/image/components.hpp"
#include "generator/pde/edge_function.hpp"
#include "generator/pde/snake.hpp"
#include "model/priors.hpp"

namespace heartgen::anatomy {
namespace {

constexpr double max_change = 0.6;  // of a piece's area: a snake that moves more has left its vessel
constexpr pde::SnakeSettings calm{.tension_mm = 0.03, .rigidity_mm3 = 0.02, .attraction_mm = 2, .max_iterations = 3000};

template <class T>
Volume<T> slice_of(const Volume<T>& volume, std::int64_t k) {
  Grid plane = volume.grid;
  plane.size[2] = 1;
  Volume<T> slice(plane);
  const auto n = plane.size[0] * plane.size[1];
  std::copy_n(volume.voxels.begin() + k * n, n, slice.voxels.begin());
  return slice;
}

/// The outline of the only piece of a slice along its pixels' sides, counter-clockwise, in mm.
pde::Curve outline(const Mask& piece) {
  const auto [nx, ny, nz] = piece.grid.size;
  const auto set = [&](std::int64_t i, std::int64_t j) { return piece.grid.contains(i, j, 0) && piece(i, j, 0) != 0; };
  const auto first = std::find_if(piece.voxels.begin(), piece.voxels.end(), [](auto v) { return v != 0; });
  const auto at = first - piece.voxels.begin();
  // Corner (i, j) is the lower left one of pixel (i, j). The piece lies on the left of the way.
  constexpr std::array<std::array<std::int64_t, 2>, 4> ways = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
  constexpr std::array<std::array<std::int64_t, 2>, 4> left = {{{0, 0}, {-1, 0}, {-1, -1}, {0, -1}}};
  const std::array<std::int64_t, 2> start = {at % nx, at / nx};
  auto corner = start;
  std::size_t way = 0;
  pde::Curve curve;
  do {
    curve.push_back({(static_cast<double>(corner[0]) - 0.5) * piece.grid.spacing_mm.x,
                     (static_cast<double>(corner[1]) - 0.5) * piece.grid.spacing_mm.y});
    corner = {corner[0] + ways[way][0], corner[1] + ways[way][1]};
    for (const std::size_t turn : {1U, 0U, 3U, 2U}) {  // left, straight on, right, back
      const std::size_t next = (way + turn) % 4, other = (next + 3) % 4;
      const bool on_left = set(corner[0] + left[next][0], corner[1] + left[next][1]);
      const bool on_right = set(corner[0] + left[other][0], corner[1] + left[other][1]);
      if (!on_left || on_right) continue;
      way = next;
      break;
    }
  } while (corner != start);
  return curve;
}

/// What the snake from a piece's outline encloses; the piece itself where the snake does not settle near it.
Mask settled(const Mask& piece, const Volume<float>& h) {
  const Grid& grid = piece.grid;
  const auto pixels = std::count(piece.voxels.begin(), piece.voxels.end(), 1);
  const double area = static_cast<double>(pixels) * grid.spacing_mm.x * grid.spacing_mm.y;
  if (area < priors::carotid_section_min_mm2) return piece;
  const pde::Curve rough = outline(piece);
  const auto points = std::max(16, static_cast<int>(2 * pde::length_mm(rough) / grid.spacing_mm.x));
  const auto found = pde::evolve_snake(pde::resampled(rough, points), h, calm);
  const bool good = found.end == pde::SnakeEnd::settled || found.end == pde::SnakeEnd::out_of_iterations;
  if (!good || std::abs(pde::area_mm2(found.curve) - area) > max_change * area) return piece;
  return pde::inside_of(found.curve, grid);
}

}  // namespace

Mask segment_vessel_by_snakes(const CtVolume& angiogram, const Vec3& seed_mm, const VesselSnakeSettings& settings) {
  const Mask start = threshold_vessel(angiogram, seed_mm, settings.smoothing_hu, settings.maximum_volume_ml).lumen;
  const auto self = parallel::self();
  Volume<float> image(angiogram.grid);
  std::copy(angiogram.voxels.begin(), angiogram.voxels.end(), image.voxels.begin());
  Mask lumen(start.grid);
  const auto area = start.grid.size[0] * start.grid.size[1];
  for (std::int64_t k = 0; k < start.grid.size[2]; ++k) {
    const auto pieces = image::connected_components(image::fill_holes_in_slices(slice_of(start, k)));
    if (pieces.voxel_count.size() < 2) continue;
    const auto h = parallel::gather(
        pde::edge_function(parallel::scatter(slice_of(image, k), self),
                           {.smoothing_mm = settings.edge_smoothing_mm, .edge_per_mm = settings.edge_hu_per_mm}, self),
        self);
    for (std::size_t label = 1; label < pieces.voxel_count.size(); ++label) {
      Mask piece(h.grid);
      for (std::size_t v = 0; v < piece.voxels.size(); ++v)
        piece.voxels[v] = pieces.label.voxels[v] == static_cast<std::int32_t>(label);
      const Mask inside = settled(piece, h);
      for (std::size_t v = 0; v < inside.voxels.size(); ++v)
        lumen.voxels[static_cast<std::size_t>(k * area) + v] |= inside.voxels[v];
    }
  }
  return smoothed_lumen(lumen, seed_mm, settings.final_smoothing_mm);
}

}  // namespace heartgen::anatomy
