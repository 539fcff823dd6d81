#include "generator/segment/fast_sweeping.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace heart::segment {
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

/// What the sweeps work on: distances, negative inside, and which of them are kept. Second-order differences look two
/// slices ahead.
struct Distances {
  Slab<float> value;
  Slab<std::uint8_t> kept;
};

Distances start(const Slab<float>& level_set) {
  const Field f{level_set, level_set.grid.spacing_mm};
  Distances d{parallel::make_slab_like<float>(level_set, 2), parallel::make_slab_like<std::uint8_t>(level_set, 0)};
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

/// The smallest v with Σ weight (v - value)² = 1 over the terms below v.
double solve(std::array<Term, 3> terms) {
  const auto put_in_order = [&](std::size_t low, std::size_t high) {
    if (terms[high].value < terms[low].value) std::swap(terms[low], terms[high]);
  };
  put_in_order(0, 1);
  put_in_order(1, 2);
  put_in_order(0, 1);
  // All three are computed, and then chosen from: which of them holds is a guess that processors often lose.
  std::array<double, 3> root{};
  double a = 0, b = 0, c = -1;
  for (std::size_t n = 0; n < 3; ++n) {
    const auto [value, weight] = terms[n];
    a += weight;
    b += weight * value;
    c += weight * value * value;
    root[n] = (b + std::sqrt(std::max(b * b - a * c, 0.0))) / a;
  }
  const bool one = terms[0].value < double{unknown}, two = one && terms[1].value < root[0],
             three = two && terms[2].value < root[1];
  double v = one ? root[0] : double{unknown};
  v = two ? root[1] : v;
  return three ? root[2] : v;
}

/// What a sweep needs to know of an axis.
struct Axis {
  std::int64_t step, size;
  double weight;  ///< 1 / h²
};

/// Values along an axis, seen from the side that the voxel is on (`sign`): value_at(steps) is `unknown` outside.
template <class ValueAt>
Term upwind_term(double weight, bool second_order, const ValueAt& value_at) {
  const double lower = value_at(-1), upper = value_at(1);
  const std::int64_t side = lower < upper ? -1 : 1;
  const double near = std::min(lower, upper);
  if (near >= double{unknown}) return {};
  const double far = second_order ? value_at(2 * side) : double{unknown};
  if (!(far <= near)) return {near, weight};
  return {(4 * near - far) / 3, weight * 9 / 4};
}

struct Sweep {
  std::array<Axis, 3> axes;
  std::array<bool, 3> backwards;
  bool second_order;
  double within;  ///< nothing is continued beyond this
};

/// `everywhere`: all places that the row's differences ask for lie in the image, along y and z.
template <bool second_order, bool everywhere>
void sweep_row(Distances& d, const Sweep& s, std::int64_t j, std::int64_t k) {
  const auto nx = s.axes[0].size;
  float* row = d.value.row(j, k);
  const std::uint8_t* kept = d.kept.row(j, k);
  for (std::int64_t n = 0; n < nx; ++n) {
    const auto i = s.backwards[0] ? nx - 1 - n : n;
    if (kept[i]) continue;
    float* here = row + i;
    const double sign = *here < 0 ? -1 : 1, own = sign * *here;
    const auto term = [&](std::size_t a, std::int64_t place) {
      const Axis& axis = s.axes[a];
      return upwind_term(axis.weight, second_order, [&](std::int64_t steps) {
        const bool exists = (everywhere && a != 0) || (place + steps >= 0 && place + steps < axis.size);
        return exists ? sign * here[steps * axis.step] : double{unknown};
      });
    };
    const std::array terms{term(0, i), term(1, j), term(2, k)};
    // No term is above the distance that follows from it.
    const double least = std::min({terms[0].value, terms[1].value, terms[2].value});
    if (least >= s.within || (!second_order && least >= own)) continue;
    const double v = solve(terms);
    if (v < double{unknown} && (second_order || v < own)) *here = static_cast<float>(sign * v);
  }
}

void sweep_row(Distances& d, const Sweep& s, std::int64_t j, std::int64_t k) {
  const auto has_room = [](std::int64_t place, std::int64_t size) { return place >= 2 && place + 2 < size; };
  const bool everywhere = has_room(j, s.axes[1].size) && has_room(k, s.axes[2].size);
  if (s.second_order)
    everywhere ? sweep_row<true, true>(d, s, j, k) : sweep_row<true, false>(d, s, j, k);
  else
    everywhere ? sweep_row<false, true>(d, s, j, k) : sweep_row<false, false>(d, s, j, k);
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
  if (value.count == 0) return;
  const int before = s.backwards[2] ? ranks.above : ranks.below, after = s.backwards[2] ? ranks.below : ranks.above;
  const auto rows = s.axes[1].size, blocks = comm.size > 1 ? std::min(rows, blocks_of_ranks) : 1;
  for (std::int64_t n = 0; n < blocks; ++n) {
    const auto b = s.backwards[1] ? blocks - 1 - n : n;
    const auto rows_of = [&](std::int64_t first_slice, std::int64_t end_slice) {
      return parallel::RowBlock{rows * b / blocks, rows * (b + 1) / blocks, first_slice, end_slice};
    };
    const auto two = [&](std::int64_t first_slice) { return rows_of(first_slice, first_slice + 2); };
    if (before >= 0) parallel::receive_rows(value, before, two(s.backwards[2] ? value.end() : value.first - 2));
    sweep_block(d, s, rows_of(value.first, value.end()));
    if (after >= 0) parallel::send_rows(value, after, two(s.backwards[2] ? value.first : value.end() - 2));
  }
}

/// @collective
void sweep_all_directions(Distances& d, bool second_order, double within, const Comm& comm) {
  const Grid& grid = d.value.grid;
  std::array<Axis, 3> axes{};
  const std::array<std::int64_t, 3> steps{1, grid.size[0], grid.size[0] * grid.size[1]};
  for (std::size_t a = 0; a < 3; ++a) {
    const double h = grid.spacing_mm[static_cast<int>(a)];
    axes[a] = {steps[a], grid.size[a], 1 / (h * h)};
  }
  const auto ranks = neighbours(grid.size[2], comm);
  for (unsigned direction = 0; direction < 8; ++direction) {
    const std::array<bool, 3> backwards{(direction & 1) != 0, (direction & 2) != 0, (direction & 4) != 0};
    if (backwards[2] && grid.size[2] == 1) continue;
    sweep(d, {axes, backwards, second_order, within}, ranks, comm);
  }
}

}  // namespace

void fast_sweeping(Slab<float>& level_set, const Comm& comm, float within_mm) {
  parallel::exchange_halo(level_set, comm);
  auto distances = start(level_set);
  const auto kept = std::ranges::count(distances.kept.owned(), std::uint8_t{1});
  if (parallel::sum_int64(comm, kept) == 0) return;
  for (int round = 0; round < first_order_rounds; ++round) sweep_all_directions(distances, false, within_mm, comm);
  for (int round = 0; round < second_order_rounds; ++round) sweep_all_directions(distances, true, within_mm, comm);
  std::ranges::transform(distances.value.owned(), level_set.owned().begin(),
                         [&](float mm) { return std::clamp(mm, -within_mm, within_mm); });
  parallel::exchange_halo(level_set, comm);
}

Volume<float> fast_sweeping(const Volume<float>& level_set, float within_mm) {
  auto slab = parallel::scatter(level_set, parallel::self());
  fast_sweeping(slab, parallel::self(), within_mm);
  return parallel::gather(slab, parallel::self());
}

}  // namespace heart::segment
