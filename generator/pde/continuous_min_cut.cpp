// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/continuous_min_cut.hpp"

#include <cmath>
#include <limits>

#include "generator/pde/primal_dual.hpp"
#include "model/crop.hpp"
#include "model/error.hpp"

namespace heartgen::pde {
namespace {

using parallel::Comm;
using parallel::Slab;

void check(const Slab<float>& weight, const Slab<std::uint8_t>& state, const Comm& comm) {
  std::int64_t voxels[3] = {0, 0, 0};
  std::int64_t bad = 0;
  const auto h = weight.owned();
  const auto s = state.owned();
  for (std::size_t i = 0; i < s.size(); ++i) {
    ++voxels[std::min<int>(s[i], cut_inner)];
    bad += s[i] == cut_free && !(h[i] > 0 && h[i] < std::numeric_limits<float>::infinity());
  }
  parallel::sum_int64(comm, voxels);
  const char* remedy = "check the band: its width, and the cavities that it surrounds";
  if (voxels[cut_free] == 0) throw UserError("the band has no free voxel", "minimal_cut", remedy);
  if (voxels[cut_inner] == 0) throw UserError("the band has no inner set", "minimal_cut", remedy);
  if (voxels[cut_outer] == 0) throw UserError("the band has no outer set", "minimal_cut", remedy);
  if (parallel::sum_int64(comm, bad) > 0)
    throw UserError("the edge weight is not positive and finite everywhere", "minimal_cut", "check the image");
}

struct Problem {
  const Slab<float>& h;
  const Slab<std::uint8_t>& state;
  AxisWeights weights;
  RowRuns free;     ///< free voxels
  RowRuns links;    ///< voxels with a link to a free voxel: where the dual field lives
  Slab<float> tau;  ///< step of each free voxel, 0 on the others
};

/// Diagonal preconditioning (Pock and Chambolle 2011): a voxel's step is one over the sum of the weights of its links.
Slab<float> primal_steps(const Slab<float>& h, const Slab<std::uint8_t>& state, const AxisWeights& w) {
  auto tau = parallel::make_slab_like<float>(h, 0);
  const auto nx = h.grid.size[0];
  parallel::for_rows(h, [&](std::int64_t j, std::int64_t k) {
    const float *here = h.row(j, k), *below_k = h.row(j, k - 1), *below_j = j > 0 ? h.row(j - 1, k) : here;
    const std::uint8_t* s = state.row(j, k);
    float* step = tau.row(j, k);
    for (std::int64_t i = 0; i < nx; ++i) {
      if (s[i] != cut_free) continue;
      const float left = i > 0 ? here[i - 1] : here[i];
      step[i] = 1.0f / (w.x * (here[i] + left) + w.y * (here[i] + below_j[i]) + w.z * (here[i] + below_k[i]));
    }
  });
  return tau;
}

Problem make_problem(const Slab<float>& h, const Slab<std::uint8_t>& state) {
  const AxisWeights weights = axis_weights(h.grid);
  const auto free = row_runs(state, [](std::uint8_t s) { return s == cut_free; });
  return {h, state, weights, free, link_runs(free, state), primal_steps(h, state, weights)};
}

/// 1 inside, 0 outside, 1/2 between. Its ghost slice is for the energy.
Slab<float> initial_field(const Slab<std::uint8_t>& state) {
  auto u = parallel::make_slab_like<float>(state, 1);
  const auto from = state.owned();
  const auto to = u.owned();
  for (std::size_t i = 0; i < from.size(); ++i) to[i] = from[i] == cut_outer ? 0.0f : from[i] == cut_free ? 0.5f : 1.0f;
  return u;
}

void sweep(PrimalDualFields& fields, int count, const Problem& p, const Comm& comm) {
  const AxisWeights half{p.weights.x / 2, p.weights.y / 2, p.weights.z / 2};
  const auto dual = [&](std::int64_t j, std::int64_t k) {
    for (const Run& run : p.links.at(j, k)) dual_row_weighted(dual_row_of(fields, j, k, run), half, p.h.row(j, k));
  };
  const auto primal = [&](std::int64_t j, std::int64_t k) {
    for (const Run& run : p.free.at(j, k))
      primal_row_steps(primal_row_of(fields, j, k, run), p.weights, p.tau.row(j, k));
  };
  primal_dual_sweeps(fields, count, comm, dual, primal);
}

struct Energies {
  double primal = 0, dual = 0;
  double gap() const { return primal > 0 ? std::max(primal - dual, 0.0) / primal : 0; }
};

/// Σ h |w ∇u| of the present u.
double primal_energy(PrimalDualFields& fields, const Problem& p, const Comm& comm) {
  parallel::exchange_halo(fields.u, comm);
  return parallel::sum_rows(fields.u, comm, [&](std::int64_t j, std::int64_t k) {
    double sum = 0;
    for (const Run& run : p.links.at(j, k))
      sum += gradient_row_sum(gradient_row_of(fields.u, j, k, run), p.weights, p.h.row(j, k));
    return sum;
  });
}

/// The least <p, ∇u> over all admissible u: a lower bound of the minimum, because |p| <= h.
double dual_energy(PrimalDualFields& fields, const Problem& p, const Comm& comm) {
  const auto nx = p.h.grid.size[0];
  return parallel::sum_rows(fields.u, comm, [&](std::int64_t j, std::int64_t k) {
    thread_local std::vector<float> divergence;
    divergence.resize(static_cast<std::size_t>(nx));
    divergence_row(primal_row_of(fields, j, k, {0, nx}), p.weights, divergence.data());
    const std::uint8_t* s = p.state.row(j, k);
    double sum = 0;
    for (std::int64_t i = 0; i < nx; ++i) {
      const double source = -double{divergence[static_cast<std::size_t>(i)]};
      sum += s[i] == cut_inner ? source : s[i] == cut_free ? std::min(source, 0.0) : 0.0;
    }
    return sum;
  });
}

}  // namespace

MinimalCutResult continuous_min_cut(const Slab<float>& weight, const Slab<std::uint8_t>& state,
                                    const MinimalCutSettings& settings, const Comm& comm) {
  check(weight, state, comm);
  const Problem problem = make_problem(weight, state);
  auto fields = make_primal_dual(initial_field(state), comm);
  Energies energies;
  int iterations = 0;
  do {
    const int sweeps = std::min(settings.check_interval, settings.max_iterations - iterations);
    sweep(fields, sweeps, problem, comm);
    iterations += sweeps;
    energies = {primal_energy(fields, problem, comm), dual_energy(fields, problem, comm)};
  } while (iterations < settings.max_iterations && energies.gap() > settings.duality_gap);
  const double unit = weight.grid.voxel_volume_mm3() / smallest_spacing(weight.grid);
  return {std::move(fields.u), energies.gap(), unit * energies.primal, iterations};
}

MinimalCutVolume continuous_min_cut(const Volume<float>& weight_on_root, const Mask& state_on_root,
                                    const MinimalCutSettings& settings, const Comm& comm) {
  const Box box = parallel::run_on_root(comm, [&] {
    if (weight_on_root.grid.size != state_on_root.grid.size)
      throw UserError("edge weight and band differ in size", "minimal_cut", "both must be on the same grid");
    const Box found = bounding_box(state_on_root, 1, [](std::uint8_t s) { return s == cut_free; });
    if (found.empty()) throw UserError("the band has no free voxel", "minimal_cut", "check the width of the band");
    return found;
  });
  const auto part = [&](const auto& volume) {
    using Whole = std::remove_cvref_t<decltype(volume)>;
    return parallel::scatter(comm.is_root() ? crop(volume, box) : Whole{}, comm);
  };
  const auto weight = part(weight_on_root);
  const auto state = part(state_on_root);
  auto found = continuous_min_cut(weight, state, settings, comm);
  MinimalCutVolume result{{}, found.duality_gap, found.energy, found.iterations};
  const auto u = parallel::gather(found.u, comm);
  if (comm.is_root()) {
    result.u = Volume<float>(state_on_root.grid);
    for (std::size_t i = 0; i < result.u.voxels.size(); ++i)
      result.u.voxels[i] = state_on_root.voxels[i] == cut_inner ? 1.0f : 0.0f;
    paste(u, box, result.u);
  }
  return result;
}

}  // namespace heartgen::pde
