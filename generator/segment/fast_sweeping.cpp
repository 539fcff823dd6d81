#include "generator/segment/fast_sweeping.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "generator/parallel/threads.hpp"

namespace heart::segment {
namespace {

constexpr float unknown = std::numeric_limits<float>::max();

/// Rounds of sweeps in all directions: distances settle in one or two where the closest points are seen straight ahead.
constexpr int first_order_rounds = 2, second_order_rounds = 2;

/// The quadratic model is trusted where the function bends by less than this part of its slope within a voxel.
constexpr double largest_bend = 0.5;

/// A function on a grid, continued linearly beyond the border.
struct Field {
  const Volume<float>& values;
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
    return values(p[0], p[1], p[2]);
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

/// What the sweeps work on: distances, negative inside, and which of them are kept.
struct Distances {
  Volume<float> value;
  Mask kept;
};

Distances start(const Volume<float>& level_set) {
  const Field f{level_set, level_set.grid.spacing_mm};
  Distances d{Volume<float>(level_set.grid), Mask(level_set.grid)};
  const auto& size = level_set.grid.size;
  parallel::parallel_for(0, size[1] * size[2], [&](std::int64_t from, std::int64_t to) {
    for (auto row = from; row < to; ++row)
      for (std::int64_t i = 0; i < size[0]; ++i) {
        const Index3 p{i, row % size[1], row / size[1]};
        double distance = unknown;
        if (beside_zero(f, p)) {
          const auto q = quadratic_at(f, p);
          distance = model_distance(q, f.h).value_or(first_order_distance(f, p, q));
          d.kept(p[0], p[1], p[2]) = 1;
        }
        d.value(p[0], p[1], p[2]) = static_cast<float>(inside(f(p)) ? -distance : distance);
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
  std::sort(terms.begin(), terms.end(), [](const Term& a, const Term& b) { return a.value < b.value; });
  double v = unknown, a = 0, b = 0, c = -1;
  for (const Term& t : terms) {
    if (!(t.value < v) || t.value >= double{unknown}) break;
    a += t.weight;
    b += t.weight * t.value;
    c += t.weight * t.value * t.value;
    v = (b + std::sqrt(std::max(b * b - a * c, 0.0))) / a;
  }
  return v;
}

/// What a sweep needs to know of an axis.
struct Axis {
  std::int64_t step, size;
  double weight;  ///< 1 / h²
};

/// Values along an axis, seen from the side that the voxel is on (`sign`).
Term upwind_term(const float* here, double sign, const Axis& axis, std::int64_t place, bool second_order) {
  const auto at = [&](std::int64_t steps) {
    const auto n = place + steps;
    return n < 0 || n >= axis.size ? double{unknown} : sign * here[steps * axis.step];
  };
  const double lower = at(-1), upper = at(1);
  const std::int64_t side = lower < upper ? -1 : 1;
  const double near = std::min(lower, upper);
  if (near >= double{unknown}) return {};
  const double far = second_order ? at(2 * side) : double{unknown};
  if (!(far <= near)) return {near, axis.weight};
  return {(4 * near - far) / 3, axis.weight * 9 / 4};
}

struct Sweep {
  std::array<Axis, 3> axes;
  std::array<bool, 3> backwards;
  bool second_order;
};

void sweep_row(Distances& d, const Sweep& s, std::int64_t j, std::int64_t k) {
  const auto nx = s.axes[0].size;
  float* row = &d.value(0, j, k);
  const std::uint8_t* kept = &d.kept(0, j, k);
  for (std::int64_t n = 0; n < nx; ++n) {
    const auto i = s.backwards[0] ? nx - 1 - n : n;
    if (kept[i]) continue;
    float* here = row + i;
    const double sign = *here < 0 ? -1 : 1;
    const double v = solve({upwind_term(here, sign, s.axes[0], i, s.second_order),
                            upwind_term(here, sign, s.axes[1], j, s.second_order),
                            upwind_term(here, sign, s.axes[2], k, s.second_order)});
    if (v < double{unknown} && (s.second_order || v < sign * *here)) *here = static_cast<float>(sign * v);
  }
}

/// A row needs the rows before it along y and z: rows of one diagonal of the (y, z) plane go together.
void sweep(Distances& d, const Sweep& s) {
  const auto ny = s.axes[1].size, nz = s.axes[2].size;
  for (std::int64_t diagonal = 0; diagonal < ny + nz - 1; ++diagonal)
    parallel::parallel_for(std::max<std::int64_t>(0, diagonal - ny + 1), std::min(diagonal + 1, nz),
                           [&](std::int64_t from, std::int64_t to) {
                             for (auto n = from; n < to; ++n)
                               sweep_row(d, s, s.backwards[1] ? ny - 1 - (diagonal - n) : diagonal - n,
                                         s.backwards[2] ? nz - 1 - n : n);
                           });
}

void sweep_all_directions(Distances& d, bool second_order) {
  const Grid& grid = d.value.grid;
  std::array<Axis, 3> axes{};
  const std::array<std::int64_t, 3> steps{1, grid.size[0], grid.size[0] * grid.size[1]};
  for (std::size_t a = 0; a < 3; ++a) {
    const double h = grid.spacing_mm[static_cast<int>(a)];
    axes[a] = {steps[a], grid.size[a], 1 / (h * h)};
  }
  for (unsigned direction = 0; direction < 8; ++direction) {
    const std::array<bool, 3> backwards{(direction & 1) != 0, (direction & 2) != 0, (direction & 4) != 0};
    if (backwards[2] && grid.size[2] == 1) continue;
    sweep(d, {axes, backwards, second_order});
  }
}

}  // namespace

Volume<float> fast_sweeping(const Volume<float>& level_set) {
  auto distances = start(level_set);
  const auto& kept = distances.kept.voxels;
  if (std::find(kept.begin(), kept.end(), std::uint8_t{1}) == kept.end()) return level_set;
  for (int round = 0; round < first_order_rounds; ++round) sweep_all_directions(distances, false);
  for (int round = 0; round < second_order_rounds; ++round) sweep_all_directions(distances, true);
  return std::move(distances.value);
}

void fast_sweeping(parallel::Slab<float>& level_set, const parallel::Comm& comm) {
  const auto whole = parallel::gather(level_set, comm);
  const auto result = parallel::run_on_root(comm, [&] { return fast_sweeping(whole); });
  level_set = parallel::scatter(result, comm, level_set.ghosts);
}

}  // namespace heart::segment
