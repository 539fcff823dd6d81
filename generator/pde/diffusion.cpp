// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/diffusion.hpp"

#include <algorithm>
#include <utility>

#include "generator/pde/primal_dual.hpp"
#include "generator/pde/stencil.hpp"
#include "generator/pde/wavefront.hpp"
#include "model/error.hpp"

namespace heartgen::pde {
namespace {

using parallel::Comm;
using parallel::Slab;

/// Explicit steps are monotonous, so stable, up to this step in 3D (units of the smallest squared spacing).
constexpr double largest_step = 1.0 / 6;

void check(int iterations, double time_step, const char* where) {
  if (iterations < 0) throw UserError("iterations must not be negative", where, "0 leaves the image as it is");
  if (!(time_step > 0) || time_step > largest_step * (1 + 1e-9))
    throw UserError("time_step must lie in (0, 1/6]", where, "larger explicit steps are unstable; use more iterations");
}

/// One step from `image` to `next`. The ghost slices travel while the slices that do not need them are done.
/// @collective
template <class Row>
void step(Slab<float>& image, Slab<float>& next, const Comm& comm, Row&& row) {
  const auto slices = [&](std::int64_t begin, std::int64_t end) {
    parallel::for_rows(image, parallel::SliceRange{begin, end},
                       [&](std::int64_t j, std::int64_t k) { row(stencil_row(image, next, j, k)); });
  };
  const auto second = image.first + std::min<std::int64_t>(image.count, 1), last = std::max(second, image.end() - 1);
  parallel::exchange_halo(image, comm, [&] { slices(second, last); });
  slices(image.first, second);
  slices(last, image.end());
  std::swap(image.values, next.values);
}

/// A pass of `depth` steps, with the bits of as many single ones. Pieces have 2 depth slices or more. @collective
template <class Row>
void pass(Slab<float>& image, Slab<float>& next, int depth, const Comm& comm, Row&& row) {
  constexpr std::int64_t bytes_per_voxel = 8;
  const auto ny = image.grid.size[1], block = rows_of_block(image.grid.size[0], depth, bytes_per_voxel);
  const auto pieces = pieces_of(image);
  const auto rows = [&](std::int64_t n, std::int64_t from, std::int64_t to, std::int64_t k) {
    auto &old = n % 2 ? next : image, &now = n % 2 ? image : next;
    for (auto j = from; j < to; ++j) row(stencil_row(old, now, j, k));
  };
  parallel::exchange_halo(image, comm);
  for_pieces(pieces, [&](const Piece& piece) {
    for_wavefront(piece, ny, block, depth, [&](std::int64_t n, std::int64_t from, std::int64_t to, std::int64_t k) {
      if (k >= piece.lower(n) && k < piece.upper(n)) rows(n, from, to, k);
    });
  });
  for (int n = 1; n < depth; ++n) {
    parallel::exchange_halo(n % 2 ? next : image, comm);
    for_pieces(pieces, [&](const Piece& piece) {
      for (auto k = piece.first; k < piece.lower(n); ++k) rows(n, 0, ny, k);
      for (auto k = piece.upper(n); k < piece.end; ++k) rows(n, 0, ny, k);
    });
  }
  if (depth % 2) std::swap(image.values, next.values);
}

template <class Row>
void iterate(Slab<float>& image, int iterations, const Comm& comm, Row&& row) {
  auto next = parallel::make_slab_like<float>(image, image.ghosts);
  while (iterations > 0) {
    const int depth = pass_depth(image, iterations);
    if (depth > 1)
      pass(image, next, depth, comm, row);
    else
      step(image, next, comm, row);
    iterations -= depth;
  }
  parallel::exchange_halo(image, comm);
}

}  // namespace

void heat(Slab<float>& image, const HeatSettings& settings, const Comm& comm) {
  check(settings.iterations, settings.time_step, "heat");
  const AxisWeights steps = squared(axis_weights(image.grid), settings.time_step);
  iterate(image, settings.iterations, comm, [&](const StencilRow& row) { heat_row(row, steps); });
}

void check_settings(const DenoiseSettings& settings) {
  check(settings.iterations, settings.time_step, "denoise");
  if (!(settings.edge_hu > 0)) throw UserError("edge_hu must be positive", "denoise", "60 suits CT");
}

void perona_malik(Slab<float>& image, const DenoiseSettings& settings, const Comm& comm) {
  check_settings(settings);
  const AxisWeights steps = squared(axis_weights(image.grid), settings.time_step);
  const auto inverse_edge2 = static_cast<float>(1 / (settings.edge_hu * settings.edge_hu));
  iterate(image, settings.iterations, comm,
          [&](const StencilRow& row) { perona_malik_row(row, steps, inverse_edge2); });
}

Volume<float> heat(const Volume<float>& image_on_root, const HeatSettings& settings, const Comm& comm) {
  auto slab = parallel::scatter(image_on_root, comm);
  heat(slab, settings, comm);
  return parallel::gather(slab, comm);
}

Volume<float> perona_malik(const Volume<float>& image_on_root, const DenoiseSettings& settings, const Comm& comm) {
  auto slab = parallel::scatter(image_on_root, comm);
  perona_malik(slab, settings, comm);
  return parallel::gather(slab, comm);
}

}  // namespace heartgen::pde
