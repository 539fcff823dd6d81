#include "generator/segment/chan_vese.hpp"

#include <cmath>
#include <limits>

#include "generator/segment/crop.hpp"
#include "generator/segment/primal_dual.hpp"
#include "generator/segment/two_classes.hpp"
#include "model/error.hpp"

namespace heart::segment {
namespace {

using parallel::Comm;
using parallel::Slab;

void check(const ChanVeseSettings& settings) {
  if (!(settings.lambda > 0)) throw UserError("lambda must be positive", "chan_vese", "1 is the usual value");
  if (!(settings.mu >= 0)) throw UserError("mu must not be negative", "chan_vese", "0 is plain thresholding");
  if (settings.max_iterations < 0 || settings.check_interval < 1)
    throw UserError("iterations must not be negative", "chan_vese", "check max_iterations");
}

std::int64_t count_voxels(const Slab<std::uint8_t>& mask, const Comm& comm) {
  std::int64_t count = 0;
  for (const auto value : mask.owned()) count += value != 0;
  return parallel::sum_int64(comm, count);
}

/// The convex problem for fixed grey values, in units of the smallest spacing and of mu.
struct Relaxation {
  AxisWeights dual_step, primal_step;
  LinearForce force;
};

Relaxation relaxation(const Grid& grid, const TwoClasses& classes, const ChanVeseSettings& settings) {
  const AxisWeights weights = axis_weights(grid);
  const double step = 1 / gradient_bound(weights);  // of both fields: u and p have the same range
  const double strength = step * settings.lambda * smallest_spacing(grid) / settings.mu;
  const double contrast = classes.c_above - classes.c_below;
  Relaxation r{axis_weights(grid, step), axis_weights(grid, step), {}};
  r.force.gain = static_cast<float>(2 * strength / contrast);
  r.force.middle = static_cast<float>((classes.c_below + classes.c_above) / 2);
  r.force.limit = settings.norm == Norm::l1 ? static_cast<float>(strength) : std::numeric_limits<float>::infinity();
  return r;
}

void sweep(PrimalDualFields& fields, const Slab<float>& image, const Slab<std::uint8_t>& domain, const RowRuns& active,
           const Relaxation& r, const Comm& comm) {
  const auto last = image.grid.size[1] - 1;
  const auto dual = [&](std::int64_t j, std::int64_t k) {
    const std::uint8_t* mask = domain.row(j, k);
    for (const Run& run : active.at(j, k))
      dual_row_masked(dual_row_of(fields, j, k, run), r.dual_step, mask, j < last ? domain.row(j + 1, k) : mask,
                      domain.row(j, k + 1));
  };
  const auto primal = [&](std::int64_t j, std::int64_t k) {
    for (const Run& run : active.at(j, k))
      primal_row_force(primal_row_of(fields, j, k, run), r.primal_step, image.row(j, k), r.force);
  };
  primal_dual_sweep(fields, comm, dual, primal);
}

/// Sides at the 1/2 level of u; returns how many voxels have changed sides.
std::int64_t update_sides(const Slab<float>& u, Slab<std::uint8_t>& sides, const Comm& comm) {
  const auto nx = u.grid.size[0];
  std::vector<std::int64_t> changed(static_cast<std::size_t>(parallel::thread_count()), 0);
  const auto rows = u.grid.size[1];
  parallel::parallel_for(u.first * rows, u.end() * rows, [&](std::int64_t begin, std::int64_t end, int piece) {
    std::int64_t count = 0;
    for (auto row = begin; row < end; ++row) {
      const float* value = u.row(row % rows, row / rows);
      std::uint8_t* side = sides.row(row % rows, row / rows);
      for (std::int64_t i = 0; i < nx; ++i) {
        const std::uint8_t now = side[i] == side_none ? side_none : value[i] > 0.5f ? side_above : side_below;
        count += now != side[i];
        side[i] = now;
      }
    }
    changed[static_cast<std::size_t>(piece)] = count;
  });
  std::int64_t sum = 0;
  for (const auto count : changed) sum += count;
  return parallel::sum_int64(comm, sum);
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
};

/// Alternates between sweeps and new grey values until the sides stand still.
Progress minimise(const Slab<float>& image, const Slab<std::uint8_t>& domain, const ChanVeseSettings& settings,
                  TwoClasses classes, Slab<std::uint8_t>& sides, const Comm& comm) {
  auto fields = make_primal_dual(initial_field(sides), comm);
  const auto active = row_runs(domain, [](std::uint8_t d) { return d != 0; });
  Progress progress{classes, 0, false};
  int quiet_checks = 0;
  while (progress.iterations < settings.max_iterations && quiet_checks < 2) {
    const auto r = relaxation(image.grid, progress.classes, settings);
    const int sweeps = std::min(settings.check_interval, settings.max_iterations - progress.iterations);
    for (int s = 0; s < sweeps; ++s) sweep(fields, image, domain, active, r, comm);
    progress.iterations += sweeps;
    quiet_checks = update_sides(fields.u, sides, comm) == 0 ? quiet_checks + 1 : 0;
    if (quiet_checks > 0) continue;  // same sides, same grey values
    auto& c = progress.classes;
    const auto next = side_values(image, sides, settings.norm, c, comm);
    if (next.c_below < next.c_above) c = next;
  }
  progress.converged = quiet_checks >= 2;
  return progress;
}

Slab<std::uint8_t> above_mask(const Slab<std::uint8_t>& sides, const Comm& comm) {
  auto above = parallel::make_slab_like<std::uint8_t>(sides, 1);
  const auto from = sides.owned();
  const auto to = above.owned();
  for (std::size_t i = 0; i < from.size(); ++i) to[i] = from[i] == side_above;
  parallel::exchange_halo(above, comm);
  return above;
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

ChanVeseResult chan_vese(const Slab<float>& image, const Slab<std::uint8_t>& domain, const ChanVeseSettings& settings,
                         const Comm& comm) {
  check(settings);
  if (count_voxels(domain, comm) == 0)
    throw UserError("the domain to be segmented is empty", "chan_vese", "check the earlier steps that define it");
  auto sides = parallel::make_slab_like<std::uint8_t>(image, 0);
  Progress progress{two_classes(image, domain, settings.norm, comm), 0, true};
  divide(image, domain, progress.classes, sides);
  if (settings.mu > 0 && progress.classes.c_below < progress.classes.c_above)
    progress = minimise(image, domain, settings, progress.classes, sides, comm);
  ChanVeseResult result{above_mask(sides, comm), progress.classes.c_below, progress.classes.c_above,
                        progress.iterations,     progress.converged,       0};
  result.energy = chan_vese_energy(image, domain, result.above, result.c_below, result.c_above, settings, comm);
  return result;
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

}  // namespace heart::segment
