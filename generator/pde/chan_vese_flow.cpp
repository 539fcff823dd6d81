// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/chan_vese_flow.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "generator/pde/flow_kernels.hpp"
#include "generator/pde/primal_dual.hpp"
#include "generator/pde/row_loops.hpp"
#include "generator/pde/stencil.hpp"
#include "generator/pde/two_means.hpp"
#include "model/error.hpp"

namespace heartgen::pde {
namespace {

using parallel::Comm;
using parallel::Slab;
using MaskSlab = Slab<std::uint8_t>;

/// Rows of a tile: three slices of it and the kept coefficients fit the second-level cache.
constexpr std::int64_t tile_rows = 64;

void check(const ChanVeseFlowSettings& s) {
  const char* where = "chan_vese_flow";
  if (!(s.lambda > 0)) throw UserError("lambda must be positive", where, "1 is the usual value");
  if (!(s.mu >= 0)) throw UserError("mu must not be negative", where, "0 is plain thresholding");
  if (!(s.time_step > 0 && s.time_step <= 1)) throw UserError("time_step must lie in (0, 1]", where, "try 0.1");
  if (s.max_iterations < 0 || s.check_interval < 1)
    throw UserError("iterations must not be negative", where, "check max_iterations and check_interval");
}

FlowConstants flow_constants(const Grid& grid, const TwoClasses& c, const ChanVeseFlowSettings& s) {
  const AxisWeights w = axis_weights(grid);
  const double contrast = c.c_above - c.c_below;
  FlowConstants constants{
      squared(w, 1), squared(w, 0.25), squared(w, s.mu / smallest_spacing(grid)), static_cast<float>(s.time_step), {}};
  constants.force.gain = static_cast<float>(2 * s.lambda / contrast);
  constants.force.middle = static_cast<float>((c.c_below + c.c_above) / 2);
  constants.force.limit = s.norm == Norm::l1 ? static_cast<float>(s.lambda) : std::numeric_limits<float>::infinity();
  return constants;
}

/// How much of a row and its neighbouring rows lies in the domain.
enum class Cover : std::uint8_t { none, part, all };

struct Sweep {
  const Slab<float>& image;
  const MaskSlab& domain;
  FlowConstants constants;
  std::vector<Cover> covers;  ///< of the rows of the slices first - 1 .. end - 1

  std::int64_t rows() const { return image.grid.size[1]; }
  std::int64_t slices() const { return image.grid.size[2]; }
  Cover cover(std::int64_t j, std::int64_t k) const {
    return covers[static_cast<std::size_t>((k - image.first + 1) * rows() + j)];
  }
};

/// The row (j, k); the slice below the slab has no slice below itself, and needs none for its upper faces.
FlowRow neighbouring_rows(const Sweep& s, const Slab<float>& phi, Slab<float>& next, std::int64_t j, std::int64_t k) {
  const auto lower = std::max(k - 1, s.image.first - 1);
  const auto below = std::max<std::int64_t>(j - 1, 0), above = std::min(j + 1, s.rows() - 1);
  FlowRow row;
  row.u = {phi.row(j, k),     phi.row(below, k), phi.row(above, k),   phi.row(j, lower),
           phi.row(j, k + 1), next.row(j, k),    s.image.grid.size[0]};
  if (s.cover(j, k) == Cover::all) return row;
  row.in = s.domain.row(j, k);
  row.in_below_j = s.domain.row(below, k);
  row.in_above_j = s.domain.row(above, k);
  row.in_below_k = s.domain.row(j, lower);
  row.in_above_k = s.domain.row(j, k + 1);
  return row;
}

/// Rows that lie in the domain wholly, not at all, or in part.
std::vector<Cover> row_covers(const MaskSlab& domain) {
  const auto nx = domain.grid.size[0], ny = domain.grid.size[1];
  std::vector<Cover> own(static_cast<std::size_t>((domain.count + 2) * ny));
  const auto at = [&](std::int64_t j, std::int64_t k) -> Cover& {
    return own[static_cast<std::size_t>((k - domain.first + 1) * ny + j)];
  };
  const auto first = (domain.first - 1) * ny;
  parallel::parallel_for(first, (domain.end() + 1) * ny, [&](std::int64_t begin, std::int64_t end) {
    for (auto r = begin; r < end; ++r) {
      const auto k = (r - first) / ny + domain.first - 1, j = (r - first) % ny;
      const std::uint8_t* row = domain.row(j, k);
      const auto inside = std::count_if(row, row + nx, [](std::uint8_t d) { return d != 0; });
      at(j, k) = inside == 0 ? Cover::none : inside == nx ? Cover::all : Cover::part;
    }
  });
  auto covers = own;
  for (auto k = domain.first - 1; k < domain.end(); ++k)
    for (std::int64_t j = 0; j < ny; ++j) {
      const bool whole = at(j, k) == Cover::all && at(std::max<std::int64_t>(j - 1, 0), k) == Cover::all &&
                         at(std::min(j + 1, ny - 1), k) == Cover::all && at(j, k + 1) == Cover::all &&
                         at(j, std::max(k - 1, domain.first - 1)) == Cover::all;
      if (at(j, k) == Cover::all && !whole)
        covers[static_cast<std::size_t>((k - domain.first + 1) * ny + j)] = Cover::part;
    }
  return covers;
}

Sweep make_sweep(const Slab<float>& image, const MaskSlab& domain) {
  return {image, domain, {}, image.count ? row_covers(domain) : std::vector<Cover>{}};
}

/// What a tile keeps: a row with its ends repeated, and face coefficients; `lower` and `upper` change places from row
/// to row and slice to slice.
struct TileRows {
  std::int64_t nx;
  parallel::Pages<float> line, x, speed, lower_y, upper_y, lower_z, upper_z;
  parallel::Pages<std::uint8_t> mask_line;

  TileRows(std::int64_t row_length, std::int64_t rows)
      : nx(row_length),
        line(length(nx + 2 * block), 0.0f),
        x(line),
        speed(length(nx), 0.0f),
        lower_y(speed),
        upper_y(speed),
        lower_z(length(nx * rows), 0.0f),
        upper_z(lower_z),
        mask_line(line.size(), 0) {}

  static std::size_t length(std::int64_t n) { return static_cast<std::size_t>(n); }

  FaceRow faces(parallel::Pages<float>& z, std::int64_t row) {
    return {x.data() + block, upper_y.data(), z.data() + row * nx, speed.data()};
  }
};

/// Copies a row to where it has a voxel more at both ends.
template <class T>
const T* with_ends(const T* row, parallel::Pages<T>& line, std::int64_t nx) {
  T* to = line.data() + block;
  std::copy_n(row, nx, to);
  to[-1] = row[0];
  to[nx] = row[nx - 1];
  return to;
}

FlowRow flow_row(const Sweep& s, const Slab<float>& phi, Slab<float>& next, TileRows& tile, std::int64_t j,
                 std::int64_t k) {
  FlowRow row = neighbouring_rows(s, phi, next, j, k);
  row.u.u = with_ends(row.u.u, tile.line, tile.nx);
  if (row.in) row.in = with_ends(row.in, tile.mask_line, tile.nx);
  return row;
}

/// Coefficients of the row's upper faces; closed ones where nothing of it is in the domain.
void fill_faces(const Sweep& s, const FlowRow& row, std::int64_t j, std::int64_t k, const FaceRow& faces) {
  if (s.cover(j, k) == Cover::none) {
    std::fill_n(faces.y, row.u.nx, 0.0f);
    std::fill_n(faces.z, row.u.nx, 0.0f);
    return;
  }
  flow_faces(row, s.constants, j + 1 < s.rows() ? 1.0f : 0.0f, k + 1 < s.slices() ? 1.0f : 0.0f, faces);
}

/// Rows [begin, end) of all slices of the slab.
void sweep_tile(const Sweep& s, const Slab<float>& phi, Slab<float>& next, std::int64_t begin, std::int64_t end) {
  const auto nx = s.image.grid.size[0];
  TileRows tile(nx, end - begin);
  if (s.image.first > 0)
    for (auto j = begin; j < end; ++j) {
      const auto k = s.image.first - 1;
      fill_faces(s, flow_row(s, phi, next, tile, j, k), j, k, tile.faces(tile.lower_z, j - begin));
    }
  for (auto k = s.image.first; k < s.image.end(); ++k) {
    std::ranges::fill(tile.lower_y, 0.0f);
    if (begin > 0) {
      fill_faces(s, flow_row(s, phi, next, tile, begin - 1, k), begin - 1, k, tile.faces(tile.upper_z, 0));
      std::swap(tile.lower_y, tile.upper_y);
    }
    for (auto j = begin; j < end; ++j) {
      const FlowRow row = flow_row(s, phi, next, tile, j, k);
      const FaceRow upper = tile.faces(tile.upper_z, j - begin);
      fill_faces(s, row, j, k, upper);
      if (s.cover(j, k) != Cover::none)
        flow_update(row, s.constants, s.image.row(j, k), upper, tile.lower_y.data(),
                    tile.lower_z.data() + (j - begin) * nx);
      std::swap(tile.lower_y, tile.upper_y);
    }
    std::swap(tile.lower_z, tile.upper_z);
  }
}

/// φ and `next` agree outside the domain, where neither is written to. @collective
void sweep(const Sweep& s, Slab<float>& phi, Slab<float>& next, const Comm& comm) {
  const auto height = std::clamp<std::int64_t>(s.rows() / parallel::thread_count(), 1, tile_rows);
  parallel::parallel_for(0, (s.rows() + height - 1) / height, [&](std::int64_t from, std::int64_t to) {
    for (auto tile = from; tile < to; ++tile)
      if (s.image.count) sweep_tile(s, phi, next, tile * height, std::min((tile + 1) * height, s.rows()));
  });
  std::swap(phi.values, next.values);
  parallel::exchange_halo(phi, comm);
}

}  // namespace

void sweep_flow(const Slab<float>& image, const MaskSlab& domain, Slab<float>& phi, double c_below, double c_above,
                const ChanVeseFlowSettings& settings, int sweeps, const Comm& comm) {
  check(settings);
  Sweep s = make_sweep(image, domain);
  s.constants = flow_constants(image.grid, {c_below, c_above}, settings);
  auto next = phi;
  for (int n = 0; n < sweeps; ++n) sweep(s, phi, next, comm);
}

ChanVeseFlowResult chan_vese_flow(const Slab<float>& image, const MaskSlab& domain, Slab<float> phi, double c_below,
                                  double c_above, const ChanVeseFlowSettings& settings, const Comm& comm) {
  check(settings);
  TwoClasses classes{c_below, c_above};
  auto sides = parallel::make_slab_like<std::uint8_t>(image, 0);
  divide(image, domain, classes, sides);  // for its voxels of no side
  divide_at_level(phi, 0, sides, comm);
  ChanVeseFlowResult result;
  if (settings.mu > 0 && c_below < c_above) {
    parallel::exchange_halo(phi, comm);
    Sweep s = make_sweep(image, domain);
    auto next = phi;
    int quiet_checks = 0;
    while (result.iterations < settings.max_iterations && quiet_checks < 2) {
      s.constants = flow_constants(image.grid, classes, settings);
      const int sweeps = std::min(settings.check_interval, settings.max_iterations - result.iterations);
      for (int n = 0; n < sweeps; ++n) sweep(s, phi, next, comm);
      result.iterations += sweeps;
      quiet_checks = divide_at_level(phi, 0, sides, comm) == 0 ? quiet_checks + 1 : 0;
      if (quiet_checks > 0 || settings.fixed_values) continue;
      const auto now = side_values(image, sides, settings.norm, classes, comm);
      if (now.c_below < now.c_above) classes = now;
    }
    result.converged = quiet_checks >= 2;
  } else {
    result.converged = true;
  }
  result.phi = std::move(phi);
  result.above = above_mask(sides, comm);
  result.c_below = classes.c_below;
  result.c_above = classes.c_above;
  const ChanVeseSettings measure{.norm = settings.norm, .lambda = settings.lambda, .mu = settings.mu};
  result.energy = chan_vese_energy(image, domain, result.above, result.c_below, result.c_above, measure, comm);
  return result;
}

ChanVeseFlowResult chan_vese_flow(const Slab<float>& image, const MaskSlab& domain,
                                  const ChanVeseFlowSettings& settings, const Comm& comm) {
  check(settings);
  std::int64_t voxels = std::ranges::count_if(domain.owned(), [](std::uint8_t d) { return d != 0; });
  if (parallel::sum_int64(comm, voxels) == 0)
    throw UserError("the domain to be segmented is empty", "chan_vese_flow", "check the steps that define it");
  const auto classes = two_means(image, domain, settings.norm, comm);
  const auto threshold = static_cast<float>((classes.c_below + classes.c_above) / 2);
  auto phi = parallel::make_slab_like<float>(image, 1);
  std::ranges::transform(image.owned(), phi.owned().begin(), [&](float g) { return g > threshold ? 1.0f : -1.0f; });
  return chan_vese_flow(image, domain, std::move(phi), classes.c_below, classes.c_above, settings, comm);
}

}  // namespace heartgen::pde
