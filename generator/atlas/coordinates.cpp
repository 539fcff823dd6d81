#include "generator/atlas/coordinates.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "generator/atlas/distance_map.hpp"
#include "generator/parallel/threads.hpp"

namespace heart::atlas {
namespace {

constexpr std::array<std::array<int, 3>, 6> steps{
    {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};
constexpr double least_fraction = 0.1;  // a surface nearer to a voxel centre than this share of the spacing counts so
constexpr int continued_layers = 5;
constexpr double surface_smoothing_voxels = 1.5;
constexpr double normal_smoothing_mm = 2;
constexpr double basal_thicknesses = 0.7, basal_mm = 2;  // so near to its end a wall is continued from below

enum class Beyond : std::uint8_t { wall, endocardium, epicardium, closed };

/// The wall's voxels as a list, with what lies beyond each of their six faces.
struct WallVoxels {
  std::vector<std::array<std::int64_t, 3>> at;
  std::vector<std::array<std::int32_t, 6>> neighbor;  ///< number of the wall voxel there, or -1
  std::vector<std::array<Beyond, 6>> beyond;
};

struct Surfaces {
  LevelSet endocardium;  ///< distance to the cavity, positive in the wall
  LevelSet epicardium;   ///< distance to the hull, negative in the wall
};

Part cavity_of(Part wall) { return wall == Part::lv_wall ? Part::lv_cavity : Part::rv_cavity; }

Surfaces surfaces_of(const Volume<std::uint8_t>& parts, Part wall) {
  const auto in_cavity = [&](std::uint8_t v) { return is(v, cavity_of(wall)); };
  const auto in_left_hull = [](std::uint8_t v) {
    return is(v, Part::lv_wall) || is(v, Part::lv_cavity) || is(v, Part::other);
  };
  const auto in_heart = [](std::uint8_t v) { return !is(v, Part::outside); };
  const Mask hull = wall == Part::lv_wall ? mask_where(parts, in_left_hull) : mask_where(parts, in_heart);
  return {signed_distance(mask_where(parts, in_cavity), surface_smoothing_voxels),
          signed_distance(hull, surface_smoothing_voxels)};
}

Beyond what_is(std::uint8_t part, Part wall) {
  if (is(part, wall)) return Beyond::wall;
  if (is(part, cavity_of(wall))) return Beyond::endocardium;
  if (is(part, Part::other)) return Beyond::closed;
  if (wall == Part::lv_wall || is(part, Part::outside)) return Beyond::epicardium;
  return Beyond::closed;
}

WallVoxels wall_voxels(const Volume<std::uint8_t>& parts, Part wall) {
  const Grid& g = parts.grid;
  WallVoxels voxels;
  Volume<std::int32_t> number(g, -1);
  for (std::int64_t k = 0; k < g.size[2]; ++k)
    for (std::int64_t j = 0; j < g.size[1]; ++j)
      for (std::int64_t i = 0; i < g.size[0]; ++i)
        if (is(parts(i, j, k), wall)) {
          number(i, j, k) = static_cast<std::int32_t>(voxels.at.size());
          voxels.at.push_back({i, j, k});
        }
  voxels.neighbor.resize(voxels.at.size());
  voxels.beyond.resize(voxels.at.size());
  for (std::size_t v = 0; v < voxels.at.size(); ++v)
    for (std::size_t s = 0; s < 6; ++s) {
      const auto i = voxels.at[v][0] + steps[s][0], j = voxels.at[v][1] + steps[s][1],
                 k = voxels.at[v][2] + steps[s][2];
      const bool inside = g.contains(i, j, k);
      voxels.neighbor[v][s] = inside ? number(i, j, k) : -1;
      voxels.beyond[v][s] = inside ? what_is(parts(i, j, k), wall) : Beyond::closed;
    }
  return voxels;
}

/// Share of the way to the neighbour at which the surface (zero of `level`) is crossed.
double crossing(const LevelSet& level, const std::array<std::int64_t, 3>& at, std::size_t step) {
  const double here = level(at[0], at[1], at[2]);
  const double there = level(at[0] + steps[step][0], at[1] + steps[step][1], at[2] + steps[step][2]);
  const double difference = here - there;
  if (std::abs(difference) < 1e-9) return 0.5;
  return std::clamp(here / difference, least_fraction, 1.0);
}

/// Laplace's equation on the wall: symmetric matrix with `diagonal`, -1 per inner face, and a right-hand side.
struct LaplaceSystem {
  std::vector<double> diagonal, right;
};

LaplaceSystem laplace_system(const WallVoxels& voxels, const Surfaces& surfaces) {
  LaplaceSystem system;
  system.diagonal.assign(voxels.at.size(), 1e-9);
  system.right.assign(voxels.at.size(), 0);
  for (std::size_t v = 0; v < voxels.at.size(); ++v)
    for (std::size_t s = 0; s < 6; ++s) {
      if (voxels.beyond[v][s] == Beyond::closed) continue;
      double weight = 1;
      if (voxels.beyond[v][s] == Beyond::endocardium) weight = 1 / crossing(surfaces.endocardium, voxels.at[v], s);
      if (voxels.beyond[v][s] == Beyond::epicardium) weight = 1 / crossing(surfaces.epicardium, voxels.at[v], s);
      system.diagonal[v] += weight;
      if (voxels.beyond[v][s] == Beyond::epicardium) system.right[v] += weight;
    }
  return system;
}

double product(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t v = 0; v < a.size(); ++v) sum += a[v] * b[v];
  return sum;
}

void apply(const WallVoxels& voxels, const LaplaceSystem& system, const std::vector<double>& x,
           std::vector<double>& result) {
  parallel::parallel_for(0, static_cast<std::int64_t>(x.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto v = static_cast<std::size_t>(begin); v < static_cast<std::size_t>(end); ++v) {
      double sum = system.diagonal[v] * x[v];
      for (const auto n : voxels.neighbor[v])
        if (n >= 0) sum -= x[static_cast<std::size_t>(n)];
      result[v] = sum;
    }
  });
}

/// Conjugate gradients, preconditioned by the diagonal, from the start value x.
void solve(const WallVoxels& voxels, const LaplaceSystem& system, std::vector<double>& x) {
  constexpr int most_iterations = 500;
  constexpr double tolerance = 1e-5;
  std::vector<double> residual(x.size()), direction, image(x.size()), scaled(x.size());
  apply(voxels, system, x, image);
  for (std::size_t v = 0; v < x.size(); ++v) residual[v] = system.right[v] - image[v];
  const double goal = tolerance * tolerance * std::max(product(system.right, system.right), 1e-30);
  double rho = 0;
  for (int iteration = 0; iteration < most_iterations && product(residual, residual) > goal; ++iteration) {
    for (std::size_t v = 0; v < x.size(); ++v) scaled[v] = residual[v] / system.diagonal[v];
    const double rho_new = product(residual, scaled);
    if (iteration == 0)
      direction = scaled;
    else
      for (std::size_t v = 0; v < x.size(); ++v) direction[v] = scaled[v] + rho_new / rho * direction[v];
    rho = rho_new;
    apply(voxels, system, direction, image);
    const double step = rho / product(direction, image);
    for (std::size_t v = 0; v < x.size(); ++v) {
      x[v] += step * direction[v];
      residual[v] -= step * image[v];
    }
  }
}

std::vector<double> laplace_depth(const WallVoxels& voxels, const Surfaces& surfaces) {
  std::vector<double> x(voxels.at.size());
  for (std::size_t v = 0; v < x.size(); ++v) {
    const auto& p = voxels.at[v];
    const double inner = std::max(0.02F, surfaces.endocardium(p[0], p[1], p[2]));
    const double outer = std::max(0.02F, -surfaces.epicardium(p[0], p[1], p[2]));
    x[v] = inner / (inner + outer);
  }
  solve(voxels, laplace_system(voxels, surfaces), x);
  return x;
}

/// Unit gradient of Laplace's solution at the wall's voxels. The solution is continued by distance / 8 mm outside the
/// wall and smoothed a little, so that gradients exist at the faces.
std::vector<Vec3> laplace_normals(const WallVoxels& voxels, const Surfaces& surfaces,
                                  const std::vector<double>& solution, const Volume<std::uint8_t>& parts) {
  constexpr float usual_wall_mm = 8;
  constexpr double sigma_voxels = 0.8;
  Volume<float> continued(parts.grid);
  for (std::size_t v = 0; v < continued.voxels.size(); ++v) {
    const float in = surfaces.endocardium.voxels[v], out = surfaces.epicardium.voxels[v];
    continued.voxels[v] = in < 0 ? in / usual_wall_mm : out > 0 ? 1 + out / usual_wall_mm : 0;
  }
  for (std::size_t v = 0; v < voxels.at.size(); ++v)
    continued(voxels.at[v][0], voxels.at[v][1], voxels.at[v][2]) = static_cast<float>(solution[v]);
  continued = smoothed(continued, sigma_voxels);
  std::vector<Vec3> normals(voxels.at.size());
  for (std::size_t v = 0; v < normals.size(); ++v)
    normals[v] = normalized(gradient_at(continued, voxels.at[v][0], voxels.at[v][1], voxels.at[v][2]));
  return normals;
}

/// Upwind weights of one arc length equation: n . grad L = 1 towards `target`.
struct Upwind {
  std::vector<std::array<double, 3>> weight;
  std::vector<std::array<std::int32_t, 3>> from;  ///< wall voxel, or -1 where the surface itself (length 0)
};

Upwind upwind_of(const WallVoxels& voxels, const std::vector<Vec3>& normal, const LevelSet& surface, Beyond target,
                 double spacing_mm) {
  const int sign = target == Beyond::endocardium ? -1 : 1;
  Upwind upwind;
  upwind.weight.assign(voxels.at.size(), {0, 0, 0});
  upwind.from.assign(voxels.at.size(), {-1, -1, -1});
  for (std::size_t v = 0; v < voxels.at.size(); ++v)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double along = normal[v][static_cast<int>(axis)] * sign;
      if (along == 0) continue;
      const std::size_t step = 2 * axis + (along > 0 ? 1 : 0);
      if (voxels.neighbor[v][step] >= 0) {
        upwind.from[v][axis] = voxels.neighbor[v][step];
        upwind.weight[v][axis] = std::abs(along) / spacing_mm;
      } else if (voxels.beyond[v][step] == target) {
        upwind.weight[v][axis] = std::abs(along) / (spacing_mm * crossing(surface, voxels.at[v], step));
      }
    }
  return upwind;
}

/// Arc length from each voxel to the surface, by Jacobi sweeps of the upwind equation.
std::vector<double> arc_length(const WallVoxels& voxels, const std::vector<Vec3>& normal, const LevelSet& surface,
                               Beyond target, double spacing_mm) {
  constexpr int most_sweeps = 80;
  const Upwind upwind = upwind_of(voxels, normal, surface, target, spacing_mm);
  std::vector<double> length(voxels.at.size()), next(voxels.at.size());
  for (std::size_t v = 0; v < length.size(); ++v) {
    const auto& p = voxels.at[v];
    length[v] = std::max(0.1 * spacing_mm, std::abs(static_cast<double>(surface(p[0], p[1], p[2]))));
  }
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    parallel::parallel_for(0, static_cast<std::int64_t>(length.size()), [&](std::int64_t begin, std::int64_t end) {
      for (auto v = static_cast<std::size_t>(begin); v < static_cast<std::size_t>(end); ++v) {
        double numerator = 1, denominator = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const auto from = upwind.from[v][axis];
          denominator += upwind.weight[v][axis];
          if (from >= 0) numerator += upwind.weight[v][axis] * length[static_cast<std::size_t>(from)];
        }
        next[v] = denominator > 1e-6 ? numerator / denominator : length[v];
      }
    });
    double change = 0;
    for (std::size_t v = 0; v < length.size(); ++v) change = std::max(change, std::abs(next[v] - length[v]));
    length.swap(next);
    if (change < 1e-3) break;
  }
  return length;
}

/// Offsets of the 26 neighbours.
constexpr std::array<std::array<int, 3>, 26> neighbors26 = [] {
  std::array<std::array<int, 3>, 26> result{};
  std::size_t n = 0;
  for (int c = -1; c <= 1; ++c)
    for (int b = -1; b <= 1; ++b)
      for (int a = -1; a <= 1; ++a)
        if (a != 0 || b != 0 || c != 0) result[n++] = {a, b, c};
  return result;
}();

/// Unknown voxels that touch one of `around`, ascending, each once.
std::vector<std::int64_t> unknown_around(const Mask& known, const std::vector<std::int64_t>& around) {
  const Grid& g = known.grid;
  std::vector<std::int64_t> result;
  for (const auto v : around) {
    const std::int64_t i = v % g.size[0], j = v / g.size[0] % g.size[1], k = v / (g.size[0] * g.size[1]);
    for (const auto& s : neighbors26)
      if (g.contains(i + s[0], j + s[1], k + s[2]) && !known(i + s[0], j + s[1], k + s[2]))
        result.push_back(g.offset(i + s[0], j + s[1], k + s[2]));
  }
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

/// Mean of the known neighbours' linear continuations.
struct Continued {
  double depth = 0, thickness_mm = 0;
  Vec3 normal;
};

Continued continued_at(const WallCoordinates& c, std::int64_t v) {
  const Grid& g = c.known.grid;
  const std::int64_t i = v % g.size[0], j = v / g.size[0] % g.size[1], k = v / (g.size[0] * g.size[1]);
  Continued result;
  double count = 0;
  for (const auto& s : neighbors26) {
    if (!g.contains(i + s[0], j + s[1], k + s[2])) continue;
    const auto from = static_cast<std::size_t>(g.offset(i + s[0], j + s[1], k + s[2]));
    if (!c.known.voxels[from]) continue;
    const Vec3 offset_mm =
        -g.spacing_mm.x * Vec3{static_cast<double>(s[0]), static_cast<double>(s[1]), static_cast<double>(s[2])};
    result.depth += c.depth.voxels[from] + dot(c.normal.voxels[from], offset_mm) / c.thickness_mm.voxels[from];
    result.thickness_mm += c.thickness_mm.voxels[from];
    result.normal += c.normal.voxels[from];
    ++count;
  }
  result.depth /= count;
  result.thickness_mm /= count;
  return result;
}

/// Continues the coordinates around the known voxels, layer by layer.
void continue_layers(WallCoordinates& c, int layers) {
  std::vector<std::int64_t> front;
  for (std::size_t v = 0; v < c.known.voxels.size(); ++v)
    if (c.known.voxels[v]) front.push_back(static_cast<std::int64_t>(v));
  for (int layer = 0; layer < layers; ++layer) {
    front = unknown_around(c.known, front);
    std::vector<Continued> values(front.size());
    parallel::parallel_for(0, static_cast<std::int64_t>(front.size()), [&](std::int64_t begin, std::int64_t end) {
      for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n)
        values[n] = continued_at(c, front[n]);
    });
    for (std::size_t n = 0; n < front.size(); ++n) {
      if (norm(values[n].normal) < 1e-6) continue;
      const auto v = static_cast<std::size_t>(front[n]);
      c.known.voxels[v] = 2;
      c.depth.voxels[v] = static_cast<float>(values[n].depth);
      c.thickness_mm.voxels[v] = static_cast<float>(values[n].thickness_mm);
      c.normal.voxels[v] = normalized(values[n].normal);
    }
  }
}

/// Mean normals of the wall around each of its voxels: label maps have steps, walls have not.
void smooth_normals(WallCoordinates& c) {
  const double sigma_voxels = normal_smoothing_mm / c.known.grid.spacing_mm.x;
  for (int axis = 0; axis < 3; ++axis) {
    Volume<float> component(c.known.grid);
    for (std::size_t v = 0; v < component.voxels.size(); ++v)
      component.voxels[v] = static_cast<float>(c.normal.voxels[v][axis]);
    component = smoothed(component, sigma_voxels);
    for (std::size_t v = 0; v < component.voxels.size(); ++v)
      if (c.known.voxels[v]) c.normal.voxels[v][axis] = component.voxels[v];
  }
  for (Vec3& n : c.normal.voxels) n = normalized(n);
}

double median_of(const std::vector<double>& inner, const std::vector<double>& outer) {
  std::vector<double> sums(inner.size());
  for (std::size_t v = 0; v < sums.size(); ++v) sums[v] = inner[v] + outer[v];
  if (sums.empty()) return 0;
  const auto half = sums.begin() + static_cast<std::ptrdiff_t>(sums.size() / 2);
  std::nth_element(sums.begin(), half, sums.end());
  return *half;
}

/// Forgets the wall nearer to its basal end than `reach_mm`: valves and roots bend its surfaces there. Returns the
/// number of layers in which it is to be continued from below.
int forget_basal_end(const Volume<std::uint8_t>& parts, double reach_mm, Mask& known) {
  const auto to_other = distance_to(mask_where(parts, [](auto v) { return is(v, Part::other); }));
  bool any = false;
  for (std::size_t v = 0; v < known.voxels.size(); ++v) {
    if (!known.voxels[v] || to_other.voxels[v] >= reach_mm) continue;
    known.voxels[v] = 0;
    any = true;
  }
  return any ? static_cast<int>(reach_mm / parts.grid.spacing_mm.x) : 0;
}

}  // namespace

WallCoordinates wall_coordinates(const Ventricles& ventricles, Part wall) {
  const auto& parts = ventricles.parts;
  const double spacing_mm = parts.grid.spacing_mm.x;
  const Surfaces surfaces = surfaces_of(parts, wall);
  const WallVoxels voxels = wall_voxels(parts, wall);
  const auto solution = laplace_depth(voxels, surfaces);
  const auto path = laplace_normals(voxels, surfaces, solution, parts);
  const auto inner = arc_length(voxels, path, surfaces.endocardium, Beyond::endocardium, spacing_mm);
  const auto outer = arc_length(voxels, path, surfaces.epicardium, Beyond::epicardium, spacing_mm);
  WallCoordinates result{Mask(parts.grid), Volume<float>(parts.grid), Volume<float>(parts.grid),
                         Volume<Vec3>(parts.grid)};
  for (std::size_t v = 0; v < voxels.at.size(); ++v) {
    const auto [i, j, k] = voxels.at[v];
    const double depth = inner[v] / (inner[v] + outer[v]);
    const Vec3 from_inside = normalized(gradient_at(surfaces.endocardium, i, j, k));
    const Vec3 to_outside = normalized(gradient_at(surfaces.epicardium, i, j, k));
    const Vec3 blended = (1 - depth) * from_inside + depth * to_outside;
    result.known(i, j, k) = 1;
    result.depth(i, j, k) = static_cast<float>(depth);
    result.thickness_mm(i, j, k) = static_cast<float>(inner[v] + outer[v]);
    result.normal(i, j, k) = norm(blended) > 0.1 ? normalized(blended) : path[v];
  }
  smooth_normals(result);
  const double basal_end_mm = basal_thicknesses * median_of(inner, outer) + basal_mm;
  const int layers = continued_layers + forget_basal_end(parts, basal_end_mm, result.known);
  continue_layers(result, layers);
  return result;
}

std::optional<WallPoint> wall_point(const WallCoordinates& c, const HeartFrame& frame, const Vec3& point_mm) {
  const Grid& g = c.known.grid;
  const Vec3 index = index_from_lps(g, point_mm);
  const Vec3 low{std::floor(index.x), std::floor(index.y), std::floor(index.z)};
  double total = 0, depth = 0, thickness = 0;
  Vec3 normal;
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1;
    std::int64_t at[3];
    for (int axis = 0; axis < 3; ++axis) {
      const bool upper = (corner >> axis) & 1;
      const double fraction = index[axis] - low[axis];
      weight *= upper ? fraction : 1 - fraction;
      at[axis] = static_cast<std::int64_t>(low[axis]) + upper;
    }
    if (weight == 0 || !g.contains(at[0], at[1], at[2]) || !c.known(at[0], at[1], at[2])) continue;
    total += weight;
    depth += weight * c.depth(at[0], at[1], at[2]);
    thickness += weight * c.thickness_mm(at[0], at[1], at[2]);
    normal += weight * c.normal(at[0], at[1], at[2]);
  }
  if (total < 1e-3 || norm(normal) < 1e-6) return std::nullopt;
  WallPoint at;
  at.depth = std::clamp(depth / total, 0.0, 1.0);
  at.thickness_mm = thickness / total;
  at.normal = normalized(normal);
  Vec3 down = frame.long_axis - dot(frame.long_axis, at.normal) * at.normal;
  if (norm(down) < 1e-6) down = frame.rv_side - dot(frame.rv_side, at.normal) * at.normal;
  at.longitudinal = normalized(down);
  at.circumferential = cross(at.longitudinal, at.normal);
  return at;
}

double helix_angle_deg(const WallPoint& at, const Vec3& axis) {
  // Up the wall is -longitudinal, counter-clockwise seen from the base is -circumferential.
  const double up = dot(axis, at.longitudinal), around = dot(axis, at.circumferential);
  const double angle = std::atan2(up, around) * 180 / std::acos(-1.0);
  return angle > 90 ? angle - 180 : angle <= -90 ? angle + 180 : angle;
}

}  // namespace heart::atlas
