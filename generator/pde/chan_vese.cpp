// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/chan_vese.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "generator/pde/coordinate_descent.hpp"
#include "generator/pde/primal_dual.hpp"
#include "generator/pde/safe_screening.hpp"
#include "generator/pde/two_means.hpp"
#include "model/crop.hpp"
#include "model/error.hpp"

namespace heartgen::pde {
namespace {

using parallel::Comm;
using parallel::Slab;

void check(const ChanVeseSettings& settings) {
  if (!(settings.lambda > 0)) throw UserError("lambda must be positive", "chan_vese", "1 is the usual value");
  if (!(settings.mu >= 0)) throw UserError("mu must not be negative", "chan_vese", "0 is plain thresholding");
  if (settings.max_iterations < 0 || settings.check_interval < 1)
    throw UserError("iterations must not be negative", "chan_vese", "check max_iterations");
}

/// Grey values that moved by less than this part of the contrast are kept until the sides stand still.
constexpr double small_move = 2e-3;

/// Passes over the undecided voxels at the end; few change sides, and fewer from pass to pass.
constexpr int descent_passes = 10;

/// The convex problem for fixed grey values, in units of the smallest spacing and of mu.
struct Relaxation {
  AxisWeights dual_step, primal_step;
  LinearForce force;               ///< times the primal step
  RowRuns free;                    ///< what is left to be solved, see safe_screening.hpp
  RowRuns whole_links, cut_links;  ///< its links: those in the domain wholly, and those that its border may cut
};

Relaxation relaxation(const Grid& grid, const TwoClasses& classes, const ChanVeseSettings& settings) {
  const AxisWeights weights = axis_weights(grid);
  const double step = 1 / gradient_bound(weights);  // of both fields: u and p have the same range
  const double strength = step * settings.lambda * smallest_spacing(grid) / settings.mu;
  const double contrast = classes.c_above - classes.c_below;
  Relaxation r{axis_weights(grid, step), axis_weights(grid, step), {}, {}, {}, {}};
  r.force.gain = static_cast<float>(2 * strength / contrast);
  r.force.middle = static_cast<float>((classes.c_below + classes.c_above) / 2);
  r.force.limit = settings.norm == Norm::l1 ? static_cast<float>(strength) : std::numeric_limits<float>::infinity();
  return r;
}

LinearForce scaled(const LinearForce& force, double factor) {
  const auto f = static_cast<float>(factor);
  return {f * force.gain, force.middle, f * force.limit};
}

bool all_inside(const std::uint8_t* mask, std::int64_t begin, std::int64_t end) {
  return std::find(mask + begin, mask + end, std::uint8_t{0}) == mask + end;
}

void divide_links(const RowRuns& links, const Slab<std::uint8_t>& domain, Relaxation& r) {
  r.whole_links = r.cut_links = {links.first_row, links.rows_per_slice, std::vector<Runs>(links.rows.size())};
  if (domain.count == 0) return;
  const auto nx = domain.grid.size[0], ny = domain.grid.size[1];
  parallel::parallel_for((domain.first - 1) * ny, domain.end() * ny, [&](std::int64_t from, std::int64_t to) {
    for (auto row = from; row < to; ++row) {
      const auto k = (row + ny) / ny - 1, j = row - k * ny;  // rounded down, also for the ghost slice -1
      const auto above_j = std::min(j + 1, ny - 1);
      for (const Run& run : links.at(j, k)) {
        const bool whole = all_inside(domain.row(j, k), run.begin, std::min(run.end + 1, nx)) &&
                           all_inside(domain.row(above_j, k), run.begin, run.end) &&
                           all_inside(domain.row(j, k + 1), run.begin, run.end);
        (whole ? r.whole_links : r.cut_links).at(j, k).push_back(run);
      }
    }
  });
}

/// Sets the voxels that are decided to 0 or 1 and leaves the others to the sweeps. @collective
void fix_decided(PrimalDualFields& fields, Relaxation& r, const Slab<float>& image, const Slab<std::uint8_t>& domain,
                 const Comm& comm) {
  const AxisWeights weights = axis_weights(image.grid);
  const auto state = screen(image, domain, scaled(r.force, gradient_bound(weights)), weights, comm);
  const auto nx = image.grid.size[0];
  parallel::for_rows(fields.u, [&](std::int64_t j, std::int64_t k) {
    const std::uint8_t* s = state.row(j, k);
    float *u = fields.u.row(j, k), *bar = fields.bar.row(j, k);
    for (std::int64_t i = 0; i < nx; ++i)
      if (s[i] == decided_below || s[i] == decided_above) u[i] = bar[i] = s[i] == decided_above ? 1.0f : 0.0f;
  });
  parallel::exchange_halo(fields.bar, comm);
  r.free = row_runs(state, [](std::uint8_t s) { return s == undecided; });
  divide_links(link_runs(r.free, state), domain, r);
}

void sweep(PrimalDualFields& fields, int count, const Slab<float>& image, const Slab<std::uint8_t>& domain,
           const Relaxation& r, const Comm& comm) {
  const auto last = image.grid.size[1] - 1;
  const auto dual = [&](std::int64_t j, std::int64_t k) {
    const std::uint8_t* mask = domain.row(j, k);
    for (const Run& run : r.whole_links.at(j, k)) dual_row(dual_row_of(fields, j, k, run), r.dual_step);
    for (const Run& run : r.cut_links.at(j, k))
      dual_row_masked(dual_row_of(fields, j, k, run), r.dual_step, mask, j < last ? domain.row(j + 1, k) : mask,
                      domain.row(j, k + 1));
  };
  const auto primal = [&](std::int64_t j, std::int64_t k) {
    for (const Run& run : r.free.at(j, k))
      primal_row_force(primal_row_of(fields, j, k, run), r.primal_step, image.row(j, k), r.force);
  };
  primal_dual_sweeps(fields, count, comm, dual, primal);
}

Slab<float> initial_field(const Slab<std::uint8_t>& sides) {
  auto u = parallel::make_slab_like<float>(sides, 0);
  const auto from = sides.owned();
  const auto to = u.owned();
  for (std::size_t i = 0; i < from.size(); ++i) to[i] = from[i] == side_above ? 1.0f : 0.0f;
  return u;
}

struct Progress {
  TwoClasses classes;
  int iterations = 0;
  bool converged = false;
  Relaxation last{};  ///< the problem that was solved last
};

bool moved(const TwoClasses& from, const TwoClasses& to, double part) {
  const double most = std::max(std::abs(to.c_below - from.c_below), std::abs(to.c_above - from.c_above));
  return most > part * (from.c_above - from.c_below);
}

/// Alternates between sweeps and new grey values (unless they are fixed) until the sides stand still.
Progress minimise(const Slab<float>& image, const Slab<std::uint8_t>& domain, const ChanVeseSettings& settings,
                  const TwoClasses& start, bool fixed, Slab<std::uint8_t>& sides, const Comm& comm) {
  auto fields = make_primal_dual(initial_field(sides), comm);
  Progress progress{start};
  auto r = relaxation(image.grid, start, settings);
  fix_decided(fields, r, image, domain, comm);
  int quiet_checks = 0;
  while (progress.iterations < settings.max_iterations && quiet_checks < 2) {
    const int sweeps = std::min(settings.check_interval, settings.max_iterations - progress.iterations);
    sweep(fields, sweeps, image, domain, r, comm);
    progress.iterations += sweeps;
    const bool quiet = divide_at_level(fields.u, 0.5f, sides, comm) == 0;
    quiet_checks = quiet ? quiet_checks + 1 : 0;
    if (fixed || progress.iterations == settings.max_iterations) continue;
    const auto next = side_values(image, sides, settings.norm, progress.classes, comm);
    if (!(next.c_below < next.c_above) || !moved(progress.classes, next, quiet ? 0 : small_move)) continue;
    quiet_checks = 0;
    progress.classes = next;
    r = relaxation(image.grid, next, settings);
    fix_decided(fields, r, image, domain, comm);
  }
  progress.converged = quiet_checks >= 2;
  progress.last = std::move(r);
  return progress;
}

/// Area of a row's part of the contour in faces of one voxel, as the sum of |w ∇above| within the domain.
double contour_row_sum(const Slab<std::uint8_t>& domain, const Slab<std::uint8_t>& above, std::int64_t j,
                       std::int64_t k, const AxisWeights& w) {
  const auto& size = domain.grid.size;
  const std::uint8_t *d = domain.row(j, k), *a = above.row(j, k);
  const bool next_j = j + 1 < size[1], next_k = k + 1 < size[2];
  const std::uint8_t *dj = next_j ? domain.row(j + 1, k) : d, *aj = next_j ? above.row(j + 1, k) : a;
  const std::uint8_t *dk = next_k ? domain.row(j, k + 1) : d, *ak = next_k ? above.row(j, k + 1) : a;
  double sum = 0;
  for (std::int64_t i = 0; i < size[0]; ++i) {
    if (!d[i]) continue;
    const double x = i + 1 < size[0] && d[i + 1] && a[i + 1] != a[i] ? w.x : 0;
    const double y = dj[i] && aj[i] != a[i] ? w.y : 0;
    const double z = dk[i] && ak[i] != a[i] ? w.z : 0;
    sum += std::sqrt(x * x + y * y + z * z);
  }
  return sum;
}

double fidelity(double difference, double contrast, Norm norm) {
  const double d = std::abs(difference) / contrast;
  return norm == Norm::l1 ? d : d * d;
}

}  // namespace

double chan_vese_energy(const Slab<float>& image, const Slab<std::uint8_t>& domain, const Slab<std::uint8_t>& above,
                        double c_below, double c_above, const ChanVeseSettings& settings, const Comm& comm) {
  const double contrast = std::abs(c_above - c_below);
  const auto nx = image.grid.size[0];
  const AxisWeights weights = axis_weights(image.grid);
  const double area = parallel::sum_rows(
      image, comm, [&](std::int64_t j, std::int64_t k) { return contour_row_sum(domain, above, j, k, weights); });
  const double distance = parallel::sum_rows(image, comm, [&](std::int64_t j, std::int64_t k) {
    const float* g = image.row(j, k);
    const std::uint8_t *d = domain.row(j, k), *a = above.row(j, k);
    double sum = 0;
    for (std::int64_t i = 0; i < nx; ++i)
      if (d[i] && contrast > 0) sum += fidelity(double{g[i]} - (a[i] ? c_above : c_below), contrast, settings.norm);
    return sum;
  });
  return image.grid.voxel_volume_mm3() *
         (settings.mu / smallest_spacing(image.grid) * area + settings.lambda * distance);
}

namespace {

ChanVeseResult solve(const Slab<float>& image, const Slab<std::uint8_t>& domain, const TwoClasses& start, bool fixed,
                     const ChanVeseSettings& settings, const Comm& comm) {
  auto sides = parallel::make_slab_like<std::uint8_t>(image, 0);
  divide(image, domain, start, sides);
  if (!(settings.mu > 0 && start.c_below < start.c_above)) {
    ChanVeseResult result{above_mask(sides, comm), start.c_below, start.c_above, 0, true, 0};
    result.energy = chan_vese_energy(image, domain, result.above, start.c_below, start.c_above, settings, comm);
    return result;
  }
  const auto progress = minimise(image, domain, settings, start, fixed, sides, comm);
  auto above = above_mask(sides, comm);
  const AxisWeights weights = axis_weights(image.grid);
  descend_coordinates(image, domain, scaled(progress.last.force, gradient_bound(weights)), weights, progress.last.free,
                      descent_passes, above, comm);
  const auto side_of = [](std::uint8_t side, std::uint8_t is_above) -> std::uint8_t {
    if (side == side_none) return side_none;
    return is_above ? side_above : side_below;
  };
  std::ranges::transform(sides.owned(), above.owned(), sides.owned().begin(), side_of);
  const auto c = fixed ? start : side_values(image, sides, settings.norm, progress.classes, comm);
  ChanVeseResult result{std::move(above), c.c_below, c.c_above, progress.iterations, progress.converged, 0};
  result.energy = chan_vese_energy(image, domain, result.above, c.c_below, c.c_above, settings, comm);
  return result;
}

void check_domain(const Slab<std::uint8_t>& domain, const Comm& comm) {
  const std::int64_t voxels = std::ranges::count_if(domain.owned(), [](std::uint8_t d) { return d != 0; });
  if (parallel::sum_int64(comm, voxels) == 0)
    throw UserError("the domain to be segmented is empty", "chan_vese", "check the earlier steps that define it");
}

}  // namespace

ChanVeseResult chan_vese(const Slab<float>& image, const Slab<std::uint8_t>& domain, const ChanVeseSettings& settings,
                         const Comm& comm) {
  check(settings);
  check_domain(domain, comm);
  return solve(image, domain, two_means(image, domain, settings.norm, comm), false, settings, comm);
}

ChanVeseResult chan_vese_at(const Slab<float>& image, const Slab<std::uint8_t>& domain, double c_below, double c_above,
                            const ChanVeseSettings& settings, const Comm& comm) {
  check(settings);
  check_domain(domain, comm);
  if (!(c_below < c_above)) throw UserError("c_below must be less than c_above", "chan_vese", "");
  return solve(image, domain, {c_below, c_above}, true, settings, comm);
}

ChanVeseMasks chan_vese(const Volume<float>& image_on_root, const Mask& domain_on_root,
                        const ChanVeseSettings& settings, const Comm& comm) {
  const Box box = parallel::run_on_root(comm, [&] {
    if (image_on_root.grid.size != domain_on_root.grid.size)
      throw UserError("image and domain differ in size", "chan_vese", "both must be on the same grid");
    const Box found = bounding_box(domain_on_root, 0, [](std::uint8_t d) { return d != 0; });
    if (found.empty())
      throw UserError("the domain to be segmented is empty", "chan_vese", "check the earlier steps that define it");
    return found;
  });
  const auto part = [&](const auto& volume) {
    using Whole = std::remove_cvref_t<decltype(volume)>;
    return parallel::scatter(comm.is_root() ? crop(volume, box) : Whole{}, comm);
  };
  const auto image = part(image_on_root);
  const auto domain = part(domain_on_root);
  const auto found = chan_vese(image, domain, settings, comm);
  ChanVeseMasks result{{}, found.c_below, found.c_above, found.iterations, found.converged, found.energy};
  const auto above = parallel::gather(found.above, comm);
  if (comm.is_root()) {
    result.above = Mask(domain_on_root.grid);
    paste(above, box, result.above);
  }
  return result;
}

}  // namespace heartgen::pde
