// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/ventricles/coordinates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "generator/image/isotropic_distance.hpp"
#include "generator/image/masks.hpp"
#include "generator/image/resample.hpp"
#include "generator/image/subvoxel_distance.hpp"
#include "generator/image/voxel_layers.hpp"
#include "generator/parallel/threads.hpp"
#include "generator/ventricles/compact_wall.hpp"
#include "generator/ventricles/quadratic_continuation.hpp"
#include "generator/ventricles/regularized_surface.hpp"
#include "model/crop.hpp"
#include "model/mathematics.hpp"
#include "model/mesh_queries/corners.hpp"
#include "model/priors.hpp"
#include "model/quantile.hpp"

namespace heartgen::ventricles {
namespace {

constexpr int continued_layers = 5;
constexpr double ridge_voxels = 0.085;  // of the labels: a first guess of how far above its floor a wall has ridges
constexpr double no_ridge_mm = std::numeric_limits<double>::infinity();      // where labels show none
constexpr double min_normal_smoothing_mm = 2, normal_smoothing_share = 0.4;  // of the wall's thickness
constexpr double rounding_mm = 0.02;

struct Surfaces {
  LevelSet endocardium;  ///< distance to the cavity, positive in the wall
  LevelSet epicardium;   ///< distance to the hull, negative in the wall
};

/// What both surfaces say of one voxel.
struct Between {
  double inner_mm = 0, outer_mm = 0;  ///< distances to endocardium and epicardium, positive in the wall
  Vec3 from_inside, to_outside;       ///< unit
};

Part cavity_of(Part wall) { return wall == Part::lv_wall ? Part::lv_cavity : Part::rv_cavity; }

/// How far a wall is from where it ends, mm: from what lies beyond a valve, and for the right one from the left.
struct WallEnds {
  Volume<float> to_other;
  Volume<float> to_left;     ///< empty for the left ventricle
  Volume<float> to_outflow;  ///< from the blood that its outflow tract goes on to; empty where that is not known
};

WallEnds wall_ends(const Ventricles& ventricles, Part wall) {
  const auto& parts = ventricles.parts;
  WallEnds ends{image::distance_to(image::mask_where(parts, [](auto v) { return is(v, Part::other); })), {}, {}};
  if (!ventricles.beyond.voxels.empty())
    ends.to_outflow =
        image::distance_to(image::mask_where(ventricles.beyond, [&](auto v) { return is(v, cavity_of(wall)); }));
  if (wall == Part::rv_wall)
    ends.to_left = image::distance_to(
        image::mask_where(parts, [](auto v) { return is(v, Part::lv_wall) || is(v, Part::lv_cavity); }));
  return ends;
}

/// The wall with its ridges, as it is labelled.
Mask labelled_wall(const Ventricles& ventricles, Part wall) {
  Mask mask = image::mask_where(ventricles.parts, [&](auto v) { return is(v, wall); });
  for (std::size_t v = 0; v < ventricles.trabeculae.voxels.size(); ++v)
    if (ventricles.trabeculae.voxels[v] && is(ventricles.parts.voxels[v], cavity_of(wall))) mask.voxels[v] = 1;
  return mask;
}

/// A wall's voxels clear of its ends, where its surfaces are its own.
Mask clear_of_ends(Mask wall, const WallEnds& ends) {
  for (std::size_t v = 0; v < wall.voxels.size(); ++v) {
    if (ends.to_other.voxels[v] <= priors::clear_of_valves_mm) wall.voxels[v] = 0;
    if (!ends.to_left.voxels.empty() && ends.to_left.voxels[v] <= priors::clear_of_left_mm) wall.voxels[v] = 0;
  }
  return wall;
}

/// How coarse the labels are, in voxels of the parts.
double step_voxels(const Ventricles& ventricles) {
  return std::max(ventricles.label_spacing_mm / ventricles.parts.grid.spacing_mm.x, 1.0);
}

Surfaces surfaces_of(const Ventricles& ventricles, Part wall, const WallEnds& ends) {
  const auto& parts = ventricles.parts;
  const Mask clear = clear_of_ends(image::mask_where(parts, [&](auto v) { return is(v, wall); }), ends);
  Mask cavity = image::mask_where(parts, [&](auto v) { return is(v, cavity_of(wall)); });
  for (std::size_t v = 0; v < ventricles.beyond.voxels.size(); ++v)
    if (is(ventricles.beyond.voxels[v], cavity_of(wall))) cavity.voxels[v] = 1;
  const auto in_left_hull = [](std::uint8_t v) {
    return is(v, Part::lv_wall) || is(v, Part::lv_cavity) || is(v, Part::other);
  };
  const auto in_heart = [](std::uint8_t v) { return !is(v, Part::outside); };
  const Mask hull = wall == Part::lv_wall ? image::mask_where(parts, in_left_hull) : image::mask_where(parts, in_heart);
  const PartShares& shares = ventricles.shares;
  const bool left = wall == Part::lv_wall;
  const double step = step_voxels(ventricles);
  return {regularized_surface(image::signed_distance(cavity, left ? shares.lv_cavity : shares.rv_cavity), clear, step,
                              ventricles.label_steps_mm),
          regularized_surface(image::signed_distance(hull, left ? shares.left : shares.both), clear, step,
                              ventricles.label_steps_mm)};
}

CompactWall compact_wall(const Ventricles& ventricles, Part wall, const Surfaces& surfaces, const WallEnds& ends) {
  // As coarse as the labels are, but no wider than the floors between ridges are: more would fill them.
  constexpr double max_smoothing_mm = 1.1;
  const auto& parts = ventricles.parts;
  const Mask muscle = labelled_wall(ventricles, wall);
  Mask cavity = image::mask_where(parts, [&](auto v) { return is(v, cavity_of(wall)); });
  for (std::size_t v = 0; v < cavity.voxels.size(); ++v)
    if (muscle.voxels[v]) cavity.voxels[v] = 0;
  const auto& share = wall == Part::lv_wall ? ventricles.shares.lv_cavity : ventricles.shares.rv_cavity;
  const double label_mm = step_voxels(ventricles) * parts.grid.spacing_mm.x;
  const double smoothing_voxels = std::min(label_mm, max_smoothing_mm) / parts.grid.spacing_mm.x;
  const auto fine = image::smoothed_level_set(image::signed_distance(cavity, share), smoothing_voxels);
  const double ridge_mm = ventricles.trabeculae.voxels.empty() ? no_ridge_mm : ridge_voxels * label_mm;
  return CompactWall(endocardial_thickness(fine, surfaces.epicardium, clear_of_ends(muscle, ends)), ridge_mm);
}

double ramp(double x, double from, double to) { return std::clamp((x - from) / (to - from), 0.0, 1.0); }

/// How much the compact wall counts at a place, each 0 to 1.
struct CompactShare {
  double all = 0;      ///< of the compact wall in the distances; the rest is what both surfaces say
  double normals = 0;  ///< of the same in the directions
  double outside = 1;  ///< laid from the epicardium; the rest from the endocardium
};

/// A wall's own surfaces end where it ends. The right wall goes on to the left one, but for a normal the rounded corner
/// of its cavity is the better witness there; at the outflow valve its cavity goes on, and its epicardium does not.
CompactShare compact_share(const WallEnds& ends, const Index3& at, double thickness_mm, double measured_mm) {
  constexpr double other_blend_mm = 4, left_blend_mm = 4, left_normals_blend_mm = 4;
  const auto [i, j, k] = at;
  const bool right = !ends.to_left.voxels.empty();
  const double other_mm = right ? priors::right_wall_to_valve_mm : priors::left_wall_to_valve_mm;
  CompactShare share;
  share.all = ramp(ends.to_other(i, j, k), other_mm, other_mm + other_blend_mm);
  if (!right)
    share.all *= 1 - ramp(std::abs(thickness_mm - measured_mm), priors::uneven_wall_from_mm, priors::uneven_wall_to_mm);
  share.normals = share.all;
  if (!right) return share;
  if (!ends.to_outflow.voxels.empty())
    share.outside = ramp(ends.to_outflow(i, j, k) - thickness_mm, 0, priors::outflow_tract_mm);
  share.all = share.normals = std::max(share.all, 1 - share.outside);
  const double left_mm = ends.to_left(i, j, k);
  share.all *= ramp(left_mm, 0, left_blend_mm);
  share.normals *= ramp(left_mm, left_normals_blend_mm, left_normals_blend_mm + left_blend_mm);
  return share;
}

/// Lays one surface a thickness of the compact wall off the other.
void use_compact_wall(const CompactWall& compact, const WallEnds& ends, const Surfaces& surfaces, const Index3& at,
                      Between& b) {
  const Grid& g = surfaces.epicardium.grid;
  const Vec3 point_mm = image::voxel_center(g, g.offset(at[0], at[1], at[2]));
  const auto thickness = compact.at(point_mm);
  if (!thickness) return;
  const CompactShare share = compact_share(ends, at, thickness->mm, b.inner_mm + b.outer_mm);
  if (share.all <= 0) return;
  const double outside = share.outside, inside = 1 - share.outside;
  const double outer_mm = outside > 0 ? -distance_along_gradient(surfaces.epicardium, point_mm) : 0;
  const double inner_mm = inside > 0 ? distance_along_gradient(surfaces.endocardium, point_mm) : 0;
  const double depth_mm = outside * (thickness->mm - outer_mm) + inside * inner_mm;
  b.inner_mm += share.all * (depth_mm - b.inner_mm);
  b.outer_mm += share.all * (thickness->mm - depth_mm - b.outer_mm);
  const Vec3 in = b.from_inside, out = b.to_outside;
  const double laid_in = share.normals * outside, laid_out = share.normals * inside;
  b.from_inside = normalized(laid_in * normalized(out + thickness->gradient) + (1 - laid_in) * in);
  b.to_outside = normalized(laid_out * normalized(in - thickness->gradient) + (1 - laid_out) * out);
}

Between between(const Surfaces& surfaces, const Index3& at) {
  const auto [i, j, k] = at;
  return {surfaces.endocardium(i, j, k), -surfaces.epicardium(i, j, k),
          normalized(image::gradient_at(surfaces.endocardium, i, j, k)),
          normalized(image::gradient_at(surfaces.epicardium, i, j, k))};
}

/// The gradient of the depth lies between those of the two distances, nearer to that of the nearer surface.
void set_voxel(WallCoordinates& c, std::int64_t v, const Between& b) {
  const auto at = static_cast<std::size_t>(v);
  const double inner = std::max(b.inner_mm, rounding_mm), outer = std::max(b.outer_mm, rounding_mm);
  const double depth = inner / (inner + outer);
  c.known.voxels[at] = 1;
  c.depth.voxels[at] = static_cast<float>(depth);
  c.thickness_mm.voxels[at] = static_cast<float>(inner + outer);
  c.normal.voxels[at] = normalized((1 - depth) * b.from_inside + depth * b.to_outside);
}

/// Mean of the known neighbours' linear continuations.
struct Continued {
  double depth = 0, thickness_mm = 0, bend = 0;
  Vec3 normal;
};

Continued continued_at(const WallCoordinates& c, std::int64_t v) {
  const Grid& g = c.known.grid;
  const std::int64_t i = v % g.size[0], j = v / g.size[0] % g.size[1], k = v / (g.size[0] * g.size[1]);
  Continued result;
  double count = 0;
  for (const auto& s : image::neighbors26) {
    if (!g.contains(i + s[0], j + s[1], k + s[2])) continue;
    const auto from = static_cast<std::size_t>(g.offset(i + s[0], j + s[1], k + s[2]));
    if (!c.known.voxels[from]) continue;
    const Vec3 offset_mm =
        -g.spacing_mm.x * Vec3{static_cast<double>(s[0]), static_cast<double>(s[1]), static_cast<double>(s[2])};
    result.depth += c.depth.voxels[from] + dot(c.normal.voxels[from], offset_mm) / c.thickness_mm.voxels[from];
    result.thickness_mm += c.thickness_mm.voxels[from];
    result.bend += c.bend.voxels[from];
    result.normal += c.normal.voxels[from];
    ++count;
  }
  result.depth /= count;
  result.thickness_mm /= count;
  result.bend /= count;
  return result;
}

/// Continues the coordinates around the known voxels, layer by layer.
void continue_layers(WallCoordinates& c, int layers) {
  auto front = image::known_voxels(c.known);
  for (int layer = 0; layer < layers; ++layer) {
    front = image::unknown_around(c.known, front);
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
      c.bend.voxels[v] = static_cast<float>(values[n].bend);
    }
  }
}

/// How much the wall bends at each voxel, out of the normals' sums around it: unit vectors that differ have a short
/// mean.
void set_bend(WallCoordinates& c, double sigma_voxels) {
  Volume<float> count(c.known.grid);
  for (std::size_t v = 0; v < count.voxels.size(); ++v) count.voxels[v] = c.known.voxels[v] ? 1 : 0;
  count = image::smoothed(count, sigma_voxels);
  for (std::size_t v = 0; v < count.voxels.size(); ++v) {
    if (!c.known.voxels[v]) continue;
    const double mean = norm(c.normal.voxels[v]) / double{count.voxels[v]};
    c.bend.voxels[v] = static_cast<float>(std::sqrt(std::max(0.0, 1 - mean * mean)));
  }
}

/// Mean normals of the wall around each of its voxels: label maps have steps, walls have not. Thick walls bend less.
void smooth_normals(WallCoordinates& c, double thickness_mm) {
  const double smoothing_mm = std::max(min_normal_smoothing_mm, normal_smoothing_share * thickness_mm);
  const double sigma_voxels = smoothing_mm / c.known.grid.spacing_mm.x;
  for (int axis = 0; axis < 3; ++axis) {
    Volume<float> component(c.known.grid);
    for (std::size_t v = 0; v < component.voxels.size(); ++v)
      component.voxels[v] = static_cast<float>(c.normal.voxels[v][axis]);
    component = image::smoothed(component, sigma_voxels);
    for (std::size_t v = 0; v < component.voxels.size(); ++v)
      if (c.known.voxels[v]) c.normal.voxels[v][axis] = component.voxels[v];
  }
  set_bend(c, sigma_voxels);
  for (Vec3& n : c.normal.voxels) n = normalized(n);
}

/// The wall's voxels, x fastest.
std::vector<Index3> voxels_of(const Volume<std::uint8_t>& parts, Part wall) {
  const Grid& g = parts.grid;
  std::vector<Index3> voxels;
  for (std::int64_t k = 0; k < g.size[2]; ++k)
    for (std::int64_t j = 0; j < g.size[1]; ++j)
      for (std::int64_t i = 0; i < g.size[0]; ++i)
        if (is(parts(i, j, k), wall)) voxels.push_back({i, j, k});
  return voxels;
}

double median_thickness_mm(const std::vector<Between>& wall) {
  if (wall.empty()) return 0;
  std::vector<double> sums;
  sums.reserve(wall.size());
  for (const Between& b : wall) sums.push_back(b.inner_mm + b.outer_mm);
  return upper_median(sums);
}

bool in_outflow_tract(const WallEnds& ends, const Index3& at, double thickness_mm) {
  constexpr double margin_mm = 2;
  return !ends.to_outflow.voxels.empty() && ends.to_outflow(at[0], at[1], at[2]) <= thickness_mm + margin_mm;
}

/// Where the wall ends, at valves and roots, its surfaces bend and are no longer its own: within a few mm of what lies
/// beyond, and in a thick wall also where the two surfaces are far from parallel.
std::vector<std::uint8_t> at_basal_end(const std::vector<Index3>& voxels, const std::vector<Between>& wall, bool thick,
                                       double thickness_mm, const WallEnds& wall_end) {
  constexpr double parallel_cosine = 0.906;  // 25 degrees
  const double end_mm =
      thick ? priors::left_end_mm : priors::right_end_mm + priors::right_end_thicknesses * thickness_mm;
  std::vector<std::uint8_t> result(voxels.size());
  for (std::size_t n = 0; n < voxels.size(); ++n) {
    const auto [i, j, k] = voxels[n];
    result[n] =
        (wall_end.to_other(i, j, k) < end_mm && (thick || !in_outflow_tract(wall_end, voxels[n], thickness_mm))) ||
        (thick && dot(wall[n].from_inside, wall[n].to_outside) < parallel_cosine);
  }
  return result;
}

/// Continues both surfaces of a thick wall into the voxels with `ends` by quadratic fits of their distances.
void continue_surfaces(const Grid& grid, const std::vector<Index3>& voxels, const std::vector<std::uint8_t>& ends,
                       std::vector<Between>& wall) {
  constexpr double lattice_mm = 2.5;  // every so far a voxel is used for the fits
  const auto step = std::max<std::int64_t>(1, std::llround(lattice_mm / grid.spacing_mm.x));
  const auto point_of = [&](std::size_t n) {
    return image::voxel_center(grid, grid.offset(voxels[n][0], voxels[n][1], voxels[n][2]));
  };
  DistanceSamples samples;
  for (std::size_t n = 0; n < voxels.size(); ++n) {
    const auto [i, j, k] = voxels[n];
    if (ends[n] || i % step || j % step || k % step) continue;
    samples.points_mm.push_back(point_of(n));
    samples.values.push_back({wall[n].inner_mm, wall[n].outer_mm});
  }
  const QuadraticContinuation fits(std::move(samples));
  parallel::parallel_for(0, static_cast<std::int64_t>(voxels.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n) {
      if (!ends[n]) continue;
      if (const auto fit = fits(point_of(n)))
        wall[n] = {fit->value[0], fit->value[1], normalized(fit->gradient[0]), -normalized(fit->gradient[1])};
    }
  });
}

template <class T>
Volume<T> crop_if_known(const Volume<T>& volume, const Box& box) {
  return volume.voxels.empty() ? Volume<T>{} : crop(volume, box);
}

/// What the wall's coordinates depend on, and no more: a ventricle is half of a heart.
Ventricles near_wall(const Ventricles& ventricles, const Box& box) {
  Ventricles near;
  near.parts = crop(ventricles.parts, box);
  const PartShares& shares = ventricles.shares;
  near.shares = {crop_if_known(shares.lv_cavity, box), crop_if_known(shares.rv_cavity, box),
                 crop_if_known(shares.left, box), crop_if_known(shares.both, box)};
  near.trabeculae = crop_if_known(ventricles.trabeculae, box);
  near.beyond = crop_if_known(ventricles.beyond, box);
  near.label_spacing_mm = ventricles.label_spacing_mm;
  near.label_steps_mm = ventricles.label_steps_mm;
  return near;
}

WallCoordinates nothing_known(const Grid& grid) {
  return {Mask(grid), Volume<float>(grid), Volume<float>(grid), Volume<Vec3>(grid), Volume<float>(grid)};
}

WallCoordinates coordinates_on_grid(const Ventricles& ventricles, Part wall) {
  const auto& parts = ventricles.parts;
  const WallEnds wall_end = wall_ends(ventricles, wall);
  const Surfaces surfaces = surfaces_of(ventricles, wall, wall_end);
  const CompactWall compact = compact_wall(ventricles, wall, surfaces, wall_end);
  const auto voxels = voxels_of(parts, wall);
  std::vector<Between> at(voxels.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(at.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n)
      use_compact_wall(compact, wall_end, surfaces, voxels[n], at[n] = between(surfaces, voxels[n]));
  });
  const double thickness_mm = median_thickness_mm(at);
  const bool thick = thickness_mm > priors::thick_wall_mm;
  const auto ends = at_basal_end(voxels, at, thick, thickness_mm, wall_end);
  if (thick) continue_surfaces(parts.grid, voxels, ends, at);
  WallCoordinates result = nothing_known(parts.grid);
  for (std::size_t n = 0; n < voxels.size(); ++n)
    if (thick || !ends[n]) set_voxel(result, parts.grid.offset(voxels[n][0], voxels[n][1], voxels[n][2]), at[n]);
  smooth_normals(result, thickness_mm);
  const double unknown_mm = thick || thickness_mm <= 0 ? 0 : thickness_mm + 2;
  continue_layers(result, continued_layers + static_cast<int>(unknown_mm / parts.grid.spacing_mm.x));
  return result;
}

}  // namespace

WallCoordinates wall_coordinates(const Ventricles& ventricles, Part wall) {
  const Grid& grid = ventricles.parts.grid;
  const Box box =
      bounding_box(ventricles.parts, static_cast<std::int64_t>(std::ceil(priors::wall_end_mm / grid.spacing_mm.x)),
                   [&](auto v) { return is(v, wall); });
  WallCoordinates result = nothing_known(grid);
  if (box.empty()) return result;
  const WallCoordinates near = coordinates_on_grid(near_wall(ventricles, box), wall);
  paste(near.known, box, result.known);
  paste(near.depth, box, result.depth);
  paste(near.thickness_mm, box, result.thickness_mm);
  paste(near.normal, box, result.normal);
  paste(near.bend, box, result.bend);
  return result;
}

std::optional<WallPoint> wall_point(const WallCoordinates& c, const HeartFrame& frame, const Vec3& point_mm) {
  const Grid& g = c.known.grid;
  double total = 0, depth = 0, thickness = 0, bend = 0;
  Vec3 normal;
  mesh_queries::for_corners(index_from_lps(g, point_mm),
                            [&](double weight, std::int64_t i, std::int64_t j, std::int64_t k) {
                              if (weight == 0 || !g.contains(i, j, k) || !c.known(i, j, k)) return;
                              total += weight;
                              depth += weight * c.depth(i, j, k);
                              thickness += weight * c.thickness_mm(i, j, k);
                              bend += weight * c.bend(i, j, k);
                              normal += weight * c.normal(i, j, k);
                            });
  if (total < 1e-3 || norm(normal) < 1e-6) return std::nullopt;
  WallPoint at;
  at.depth = std::clamp(depth / total, 0.0, 1.0);
  at.thickness_mm = thickness / total;
  at.bend = bend / total;
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
  const double angle = math::atan2(up, around) * 180 / math::acos(-1.0);
  return angle > 90 ? angle - 180 : angle <= -90 ? angle + 180 : angle;
}

}  // namespace heartgen::ventricles
