// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/fast_sweeping.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "generator/pde/row_loops.hpp"

namespace heartgen::pde {
namespace {

using parallel::Comm;
using parallel::Slab;

constexpr float unknown = any_distance_mm;

/// Rounds of sweeps in all directions: distances settle in one or two where the closest points are seen straight ahead.
constexpr int first_order_rounds = 2, second_order_rounds = 2;

/// The quadratic model is trusted where the function bends by less than this part of its slope within a voxel.
constexpr double largest_bend = 0.5;

/// A function on a grid, continued linearly beyond the border.
struct Field {
  const Slab<float>& values;
  Vec3 h;

  std::int64_t size(std::size_t axis) const { return values.grid.size[axis]; }
  bool flat(std::size_t axis) const { return size(axis) == 1; }

  double operator()(const Index3& p) const {
    for (std::size_t a = 0; a < 3; ++a) {
      const bool low = p[a] < 0, high = p[a] >= size(a);
      if (!low && !high) continue;
      if (flat(a)) return (*this)(moved(p, a, -p[a]));
      const std::int64_t inwards = low ? 1 : -1;
      return 2 * (*this)(moved(p, a, inwards)) - (*this)(moved(p, a, 2 * inwards));
    }
    return values.row(p[1], p[2])[p[0]];
  }

  static Index3 moved(Index3 p, std::size_t axis, std::int64_t step) {
    p[axis] += step;
    return p;
  }
};

/// The function near a voxel: value + g·y + y·H y / 2, y in mm from the voxel.
struct Quadratic {
  double value = 0;
  std::array<double, 3> g{};
  std::array<std::array<double, 3>, 3> hessian{};

  double at(const std::array<double, 3>& y) const {
    double sum = value;
    for (std::size_t a = 0; a < 3; ++a) {
      sum += g[a] * y[a];
      for (std::size_t b = 0; b < 3; ++b) sum += hessian[a][b] * y[a] * y[b] / 2;
    }
    return sum;
  }
  std::array<double, 3> gradient(const std::array<double, 3>& y) const {
    auto sum = g;
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) sum[a] += hessian[a][b] * y[b];
    return sum;
  }
};

Quadratic quadratic_at(const Field& f, const Index3& p) {
  Quadratic q;
  q.value = f(p);
  const auto spacing = [&](std::size_t a) { return f.h[static_cast<int>(a)]; };
  for (std::size_t a = 0; a < 3; ++a) {
    if (f.flat(a)) continue;
    const double lower = f(Field::moved(p, a, -1)), upper = f(Field::moved(p, a, 1));
    q.g[a] = (upper - lower) / (2 * spacing(a));
    q.hessian[a][a] = (upper - 2 * q.value + lower) / (spacing(a) * spacing(a));
    for (std::size_t b = 0; b < a; ++b) {
      if (f.flat(b)) continue;
      const auto corner = [&](int da, int db) { return f(Field::moved(Field::moved(p, a, da), b, db)); };
      q.hessian[a][b] = q.hessian[b][a] =
          (corner(1, 1) - corner(1, -1) - corner(-1, 1) + corner(-1, -1)) / (4 * spacing(a) * spacing(b));
    }
  }
  return q;
}

double dot(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Distance to the closest zero of the model; nothing where it is no good description of the function.
std::optional<double> model_distance(const Quadratic& q, const Vec3& h) {
  constexpr int steps = 12;
  double bend = 0;
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b)
      bend = std::max(bend, std::abs(q.hessian[a][b]) * h[static_cast<int>(a == b ? a : std::min(a, b))]);
  if (!(bend <= largest_bend * std::sqrt(dot(q.g, q.g)))) return {};
  std::array<double, 3> y{};
  for (int step = 0; step < steps; ++step) {  // the closest zero of the model's tangent at y
    const auto slope = q.gradient(y);
    const double square = dot(slope, slope);
    if (!(square > 0)) return {};
    const double along = (dot(slope, y) - q.at(y)) / square;
    for (std::size_t a = 0; a < 3; ++a) y[a] = along * slope[a];
  }
  for (std::size_t a = 0; a < 3; ++a)
    if (!(std::abs(y[a]) <= h[static_cast<int>(a)])) return {};
  return std::sqrt(dot(y, y));
}

/// From the steepest slope around the voxel.
double first_order_distance(const Field& f, const Index3& p, const Quadratic& q) {
  double slope = std::sqrt(dot(q.g, q.g));
  for (std::size_t a = 0; a < 3; ++a)
    for (const int side : {-1, 1})
      if (!f.flat(a))
        slope = std::max(slope, std::abs(f(Field::moved(p, a, side)) - q.value) / f.h[static_cast<int>(a)]);
  return std::abs(q.value) / slope;
}

bool inside(double value) { return value < 0; }

bool beside_zero(const Field& f, const Index3& p) {
  for (std::size_t a = 0; a < 3; ++a)
    for (const int side : {-1, 1}) {
      const auto n = Field::moved(p, a, side);
      if (n[a] >= 0 && n[a] < f.size(a) && inside(f(n)) != inside(f(p))) return true;
    }
  return false;
}

/// What the sweeps work on: distances, negative inside, which of them are kept, and the number of the sweep that
/// changed each last. Second-order differences look two slices ahead.
struct Distances {
  Slab<float> value;
  Slab<std::uint8_t> kept, changed;
};

Distances start(const Slab<float>& level_set) {
  const Field f{level_set, level_set.grid.spacing_mm};
  Distances d{parallel::make_slab_like<float>(level_set, 2), parallel::make_slab_like<std::uint8_t>(level_set, 0),
              parallel::make_slab_like<std::uint8_t>(level_set, 2)};
  parallel::for_rows(level_set, [&](std::int64_t j, std::int64_t k) {
    for (std::int64_t i = 0; i < level_set.grid.size[0]; ++i) {
      const Index3 p{i, j, k};
      double distance = unknown;
      if (beside_zero(f, p)) {
        const auto q = quadratic_at(f, p);
        distance = model_distance(q, f.h).value_or(first_order_distance(f, p, q));
        d.kept.row(j, k)[i] = 1;
      }
      d.value.row(j, k)[i] = static_cast<float>(inside(f(p)) ? -distance : distance);
    }
  });
  return d;
}

/// One axis of the upwind equation: weight (v - value)².
struct Term {
  double value = unknown, weight = 0;
};

/// The smallest v with Σ weight (v - value)² = 1 over the terms below v; terms in ascending order.
HEARTGEN_INLINE double solve(const Term& first, const Term& second, const Term& third) {
  // All three are computed, and then chosen from: which of them holds is a guess that processors often lose.
  const auto root = [](double a, double b, double c) { return (b + std::sqrt(std::max(b * b - a * c, 0.0))) / a; };
  double a = first.weight, b = first.weight * first.value, c = first.weight * first.value * first.value - 1;
  const double of_one = root(a, b, c);
  a += second.weight, b += second.weight * second.value, c += second.weight * second.value * second.value;
  const double of_two = root(a, b, c);
  a += third.weight, b += third.weight * third.value, c += third.weight * third.value * third.value;
  const double of_three = root(a, b, c);
  const bool one = first.value < double{unknown}, two = one && second.value < of_one,
             three = two && third.value < of_two;
  double v = one ? of_one : double{unknown};
  v = two ? of_two : v;
  return three ? of_three : v;
}

/// Terms of y and z for the voxels of a row, of each voxel the lower one first: no sweep along the row changes them.
struct CrossTerms {
  double *low, *low_weight, *high, *high_weight;
};

/// What a sweep needs to know of an axis.
struct Axis {
  std::int64_t step, size;
  double weight;  ///< 1 / h²
};

/// Of the values at -1, 1, -2 and 2 steps along an axis, seen from the side that the voxel is on: `unknown` outside.
HEARTGEN_INLINE Term upwind_term(double weight, double lower, double upper, double far_lower, double far_upper) {
  const double near = std::min(lower, upper), far = lower < upper ? far_lower : far_upper;
  const bool known = near < double{unknown}, curved = known && far <= near;
  const double value = curved ? (4 * near - far) / 3 : near;
  return {known ? value : double{unknown}, known ? (curved ? weight * 9 / 4 : weight) : 0};
}

struct Sweep {
  std::array<Axis, 3> axes;
  std::array<bool, 3> backwards;
  bool second_order;
  double within;         ///< nothing is continued beyond this
  std::uint8_t number;   ///< of this sweep, from 1
  std::uint8_t settled;  ///< distances that follow only from such as changed in this sweep or before have been found
};

/// The last sweep that changed one of the distances that each distance of a row follows from, as far as it is known
/// before the row is done; false where all of them are settled. Exact: what follows from the same distances is the
/// same.
bool last_changes(const Distances& d, const Sweep& s, std::int64_t j, std::int64_t k,
                  std::vector<std::uint8_t>& latest) {
  const auto nx = s.axes[0].size;
  const std::int64_t reach = s.second_order ? 2 : 1;
  latest.assign(static_cast<std::size_t>(nx), 0);
  std::uint8_t* to = latest.data();
  const auto take = [&](const std::uint8_t* from, std::int64_t begin, std::int64_t end, std::int64_t shift) {
    for (auto i = begin; i < end; ++i) to[i] = std::max(to[i], from[i + shift]);
  };
  for (std::int64_t steps = 1; steps <= reach; ++steps) {
    const auto within = std::min(steps, nx);
    take(d.changed.row(j, k), within, nx, -steps);
    take(d.changed.row(j, k), 0, nx - within, steps);
    if (j >= steps) take(d.changed.row(j - steps, k), 0, nx, 0);
    if (j + steps < s.axes[1].size) take(d.changed.row(j + steps, k), 0, nx, 0);
    if (k >= steps) take(d.changed.row(j, k - steps), 0, nx, 0);
    if (k + steps < s.axes[2].size) take(d.changed.row(j, k + steps), 0, nx, 0);
  }
  std::uint8_t most = 0;
  for (std::int64_t i = 0; i < nx; ++i) most = std::max(most, to[i]);
  return most >= s.settled;
}

/// Where a row's differences along y or z ask: at -1, 1, -2 and 2 steps, null where the image ends or nobody asks.
struct AcrossRows {
  std::array<const float*, 4> at{};
  double weight = 0;
};

AcrossRows across_rows(const Distances& d, const Sweep& s, std::size_t axis, std::int64_t j, std::int64_t k) {
  constexpr std::array<std::int64_t, 4> steps{-1, 1, -2, 2};
  AcrossRows rows{{}, s.axes[axis].weight};
  for (std::size_t n = 0; n < (s.second_order ? 4 : 2); ++n) {
    const auto place = (axis == 1 ? j : k) + steps[n];
    if (place >= 0 && place < s.axes[axis].size) rows.at[n] = axis == 1 ? d.value.row(place, k) : d.value.row(j, place);
  }
  return rows;
}

template <bool second_order, bool everywhere>
HEARTGEN_INLINE Term term_across(const AcrossRows& rows, std::int64_t i, double sign) {
  const auto value = [&](std::size_t n) { return everywhere || rows.at[n] ? sign * rows.at[n][i] : double{unknown}; };
  const double far_lower = second_order ? value(2) : double{unknown};
  const double far_upper = second_order ? value(3) : double{unknown};
  return upwind_term(rows.weight, value(0), value(1), far_lower, far_upper);
}

template <bool second_order, bool everywhere>
HEARTGEN_INLINE void cross_terms_body(const float* const& row, std::int64_t nx, const AcrossRows& y,
                                      const AcrossRows& z, const CrossTerms& found) {
  const CrossTerms terms = found;
  const AcrossRows in_y = y, in_z = z;
  HEARTGEN_INDEPENDENT
  for (std::int64_t i = 0; i < nx; ++i) {
    const double sign = row[i] < 0 ? -1 : 1;
    const Term a = term_across<second_order, everywhere>(in_y, i, sign);
    const Term b = term_across<second_order, everywhere>(in_z, i, sign);
    const bool turned = b.value < a.value;
    terms.low[i] = turned ? b.value : a.value;
    terms.low_weight[i] = turned ? b.weight : a.weight;
    terms.high[i] = turned ? a.value : b.value;
    terms.high_weight[i] = turned ? a.weight : b.weight;
  }
}

/// `everywhere`: all places that the row's differences ask for lie in the image, along y and z.
template <bool second_order>
CrossTerms cross_terms(const Distances& d, const Sweep& s, std::int64_t j, std::int64_t k, bool everywhere) {
  thread_local std::vector<double> room;
  const auto nx = s.axes[0].size;
  room.resize(static_cast<std::size_t>(4 * nx));
  const CrossTerms terms{room.data(), room.data() + nx, room.data() + 2 * nx, room.data() + 3 * nx};
  const AcrossRows y = across_rows(d, s, 1, j, k), z = across_rows(d, s, 2, j, k);
  if (everywhere)
    vectorised<cross_terms_body<second_order, true>>(d.value.row(j, k), nx, y, z, terms);
  else
    cross_terms_body<second_order, false>(d.value.row(j, k), nx, y, z, terms);
  return terms;
}

template <bool second_order>
void sweep_row(Distances& d, const Sweep& s, std::int64_t j, std::int64_t k, bool everywhere) {
  thread_local std::vector<std::uint8_t> latest;
  if (!last_changes(d, s, j, k, latest)) return;
  const CrossTerms cross = cross_terms<second_order>(d, s, j, k, everywhere);
  const auto nx = s.axes[0].size;
  float* row = d.value.row(j, k);
  const std::uint8_t *kept = d.kept.row(j, k), *before = latest.data();
  std::uint8_t* changed = d.changed.row(j, k);
  std::int64_t depends = -1;  // on a change in this row: all up to here
  for (std::int64_t n = 0; n < nx; ++n) {
    const auto i = s.backwards[0] ? nx - 1 - n : n;
    if (kept[i] || (before[i] < s.settled && n > depends)) continue;
    const double sign = row[i] < 0 ? -1 : 1, own = sign * row[i];
    const auto value = [&](std::int64_t at) { return at >= 0 && at < nx ? sign * row[at] : double{unknown}; };
    const double far_lower = second_order ? value(i - 2) : double{unknown};
    const double far_upper = second_order ? value(i + 2) : double{unknown};
    const Term along = upwind_term(s.axes[0].weight, value(i - 1), value(i + 1), far_lower, far_upper);
    const Term low{cross.low[i], cross.low_weight[i]}, high{cross.high[i], cross.high_weight[i]};
    // No term is above the distance that follows from it.
    const double least = std::min(along.value, low.value);
    if (least >= s.within || (!second_order && least >= own)) continue;
    const bool first = along.value <= low.value, last = high.value < along.value;
    const double v = solve(first ? along : low, first ? low : (last ? high : along), last ? along : high);
    if (!(v < double{unknown} && (second_order || v < own))) continue;
    const auto found = static_cast<float>(sign * v);
    if (found == row[i]) continue;
    row[i] = found;
    changed[i] = s.number;
    depends = n + (second_order ? 2 : 1);
  }
}

void sweep_row(Distances& d, const Sweep& s, std::int64_t j, std::int64_t k) {
  const auto has_room = [](std::int64_t place, std::int64_t size) { return place >= 2 && place + 2 < size; };
  const bool everywhere = has_room(j, s.axes[1].size) && has_room(k, s.axes[2].size);
  s.second_order ? sweep_row<true>(d, s, j, k, everywhere) : sweep_row<false>(d, s, j, k, everywhere);
}

/// A row needs the rows before it along y and z: rows of one diagonal of the (y, z) plane go together. `block`: the
/// rows and slices to do.
void sweep_block(Distances& d, const Sweep& s, const parallel::RowBlock& block) {
  const auto rows = block.end_row - block.first_row, slices = block.end_slice - block.first_slice;
  for (std::int64_t diagonal = 0; diagonal < rows + slices - 1; ++diagonal)
    parallel::parallel_for(
        std::max<std::int64_t>(0, diagonal - rows + 1), std::min(diagonal + 1, slices),
        [&](std::int64_t from, std::int64_t to) {
          for (auto n = from; n < to; ++n)
            sweep_row(d, s, s.backwards[1] ? block.end_row - 1 - (diagonal - n) : block.first_row + (diagonal - n),
                      s.backwards[2] ? block.end_slice - 1 - n : block.first_slice + n);
        });
}

/// The ranks below and above that own slices; -1 where there is none.
struct Neighbours {
  int below = -1, above = -1;
};

Neighbours neighbours(std::int64_t slices, const Comm& comm) {
  const auto owns = [&](int rank) {
    const auto range = parallel::owned_slices(slices, comm, rank);
    return range.begin < range.end;
  };
  Neighbours n;
  for (int rank = 0; rank < comm.size; ++rank) {
    if (!owns(rank)) continue;
    if (rank < comm.rank) n.below = rank;
    if (rank > comm.rank && n.above < 0) n.above = rank;
  }
  return n;
}

/// Blocks of rows that the ranks do one after the other: a rank begins a block when the rank before it along z has done
/// it and sent its last two slices. The order of the rows that depend on each other is that of one rank.
constexpr std::int64_t blocks_of_ranks = 16;

/// @collective
void sweep(Distances& d, const Sweep& s, const Neighbours& ranks, const Comm& comm) {
  auto& value = d.value;
  parallel::exchange_halo(value, comm);
  parallel::exchange_halo(d.changed, comm);
  if (value.count == 0) return;
  const int before = s.backwards[2] ? ranks.above : ranks.below, after = s.backwards[2] ? ranks.below : ranks.above;
  const auto rows = s.axes[1].size, blocks = comm.size > 1 ? std::min(rows, blocks_of_ranks) : 1;
  for (std::int64_t n = 0; n < blocks; ++n) {
    const auto b = s.backwards[1] ? blocks - 1 - n : n;
    const auto rows_of = [&](std::int64_t first_slice, std::int64_t end_slice) {
      return parallel::RowBlock{rows * b / blocks, rows * (b + 1) / blocks, first_slice, end_slice};
    };
    const auto two = [&](std::int64_t first_slice) { return rows_of(first_slice, first_slice + 2); };
    const auto received = two(s.backwards[2] ? value.end() : value.first - 2);
    const auto sent = two(s.backwards[2] ? value.first : value.end() - 2);
    if (before >= 0) parallel::receive_rows(value, before, received);
    if (before >= 0) parallel::receive_rows(d.changed, before, received);
    sweep_block(d, s, rows_of(value.first, value.end()));
    if (after >= 0) parallel::send_rows(value, after, sent);
    if (after >= 0) parallel::send_rows(d.changed, after, sent);
  }
}

/// `rounds` times in all directions; `number`: of the last sweep. @collective
void sweep_rounds(Distances& d, int rounds, bool second_order, double within, std::uint8_t& number, const Comm& comm) {
  const Grid& grid = d.value.grid;
  std::array<Axis, 3> axes{};
  const std::array<std::int64_t, 3> steps{1, grid.size[0], grid.size[0] * grid.size[1]};
  for (std::size_t a = 0; a < 3; ++a) {
    const double h = grid.spacing_mm[static_cast<int>(a)];
    axes[a] = {steps[a], grid.size[a], 1 / (h * h)};
  }
  const auto ranks = neighbours(grid.size[2], comm);
  std::uint8_t settled = 0;  // the first sweep asks for all
  for (unsigned n = 0; n < 8 * static_cast<unsigned>(rounds); ++n) {
    const std::array<bool, 3> backwards{(n & 1) != 0, (n & 2) != 0, (n & 4) != 0};
    if (backwards[2] && grid.size[2] == 1) continue;
    ++number;
    sweep(d, {axes, backwards, second_order, within, number, settled}, ranks, comm);
    settled = number;
  }
}

}  // namespace

void fast_sweeping(Slab<float>& level_set, const Comm& comm, float within_mm) {
  parallel::exchange_halo(level_set, comm);
  auto distances = start(level_set);
  const auto kept = std::ranges::count(distances.kept.owned(), std::uint8_t{1});
  if (parallel::sum_int64(comm, kept) == 0) return;
  std::uint8_t number = 0;
  sweep_rounds(distances, first_order_rounds, false, within_mm, number, comm);
  sweep_rounds(distances, second_order_rounds, true, within_mm, number, comm);
  std::ranges::transform(distances.value.owned(), level_set.owned().begin(),
                         [&](float mm) { return std::clamp(mm, -within_mm, within_mm); });
  parallel::exchange_halo(level_set, comm);
}

Volume<float> fast_sweeping(const Volume<float>& level_set, float within_mm) {
  auto slab = parallel::scatter(level_set, parallel::self());
  fast_sweeping(slab, parallel::self(), within_mm);
  return parallel::gather(slab, parallel::self());
}

}  // namespace heartgen::pde
