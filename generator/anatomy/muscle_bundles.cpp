// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/muscle_bundles.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "generator/image/gaussian.hpp"
#include "generator/parallel/threads.hpp"
#include "model/mathematics.hpp"

namespace heartgen::anatomy {
namespace {

// Of mere noise: some ten thousand places, directions and sizes are tried. Fewer where anchors leave a third of them,
// but that is one nat, and one mirrored image tells of the rarest rods of the other no better than to within two.
constexpr double usual_chance_nats = 10;
constexpr double beyond_chance = 1.3;  // times that: one in ten to twenty images of noise
constexpr double bulk_of_muscle = 3;
constexpr double max_evidence = 1;                     // nats per mm³ of a grey value (grey_evidence)
constexpr double across_mm = 1.5, half_length_mm = 6;  // of the lines that give the first guess
constexpr double first_radius_mm = 2.5;
constexpr double thinnest_mm = 1.5, thickest_mm = 5, longest_mm = 40;  // radius, radius, distance of the ends
constexpr std::size_t max_guesses = 60;
constexpr double blur_mm = 0.8;  // standard deviation: the scanner's, and that of the working grid

double distance_mm(const MuscleBundle& bundle, const Vec3& p) {
  const Vec3 axis = bundle.to_mm - bundle.from_mm, from = p - bundle.from_mm;
  const double square = dot(axis, axis);
  const double t = square > 0 ? std::clamp(dot(from, axis) / square, 0.0, 1.0) : 0.0;
  return norm(from - t * axis) - bundle.radius_mm;
}

/// x of where a row of voxels may come within `reach` of the bundle's axis; empty where first > last. The axis is cut
/// to where it comes as near along y and z.
struct RowPart {
  double first, last;
};
RowPart part_of_row(const MuscleBundle& bundle, double reach, double y, double z) {
  constexpr double rounding_mm = 1e-6;
  const Vec3 axis = bundle.to_mm - bundle.from_mm;
  double begin = 0, end = 1;
  for (const int a : {1, 2}) {
    const double off = (a == 1 ? y : z) - bundle.from_mm[a], near = reach + rounding_mm;
    if (std::abs(axis[a]) < rounding_mm) {
      if (std::abs(off) > near + rounding_mm) return {1, 0};
      continue;
    }
    const double one = (off - near) / axis[a], other = (off + near) / axis[a];
    begin = std::max(begin, std::min(one, other));
    end = std::min(end, std::max(one, other));
  }
  if (begin > end) return {1, 0};
  const double from = bundle.from_mm.x + begin * axis.x, to = bundle.from_mm.x + end * axis.x;
  return {std::min(from, to) - reach - rounding_mm, std::max(from, to) + reach + rounding_mm};
}

/// body(offset, distance to the bundle's surface) for every voxel up to `margin_mm` from it.
template <class Body>
void for_each_within(const Grid& grid, const MuscleBundle& bundle, double margin_mm, const Body& body) {
  const double reach = bundle.radius_mm + margin_mm, spacing = grid.spacing_mm.x;
  Index3 low, high;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const double first = (std::min(bundle.from_mm[axis], bundle.to_mm[axis]) - reach) / spacing;
    const double last = (std::max(bundle.from_mm[axis], bundle.to_mm[axis]) + reach) / spacing;
    low[a] = std::max<std::int64_t>(static_cast<std::int64_t>(std::ceil(first)), 0);
    high[a] = std::min(static_cast<std::int64_t>(std::floor(last)), grid.size[a] - 1);
  }
  for (std::int64_t k = low[2]; k <= high[2]; ++k)
    for (std::int64_t j = low[1]; j <= high[1]; ++j) {
      const double y = static_cast<double>(j) * spacing, z = static_cast<double>(k) * spacing;
      const auto [first, last] = part_of_row(bundle, reach, y, z);
      const auto begin = std::max(low[0], static_cast<std::int64_t>(std::ceil(first / spacing)));
      const auto end = std::min(high[0], static_cast<std::int64_t>(std::floor(last / spacing)));
      for (std::int64_t i = begin; i <= end; ++i) {
        const Vec3 p{static_cast<double>(i) * spacing, y, z};
        const double distance = distance_mm(bundle, p);
        if (distance < margin_mm) body(static_cast<std::size_t>(grid.offset(i, j, k)), distance);
      }
    }
}

/// Share of muscle that is seen at a distance from the surface of a blurred rod; its half lies inside the rod, by half
/// the square of the blur times the curvature.
double share(double distance_mm, double radius_mm) {
  const double shift_mm = 0.5 * blur_mm * blur_mm / radius_mm;
  return 0.5 * math::erfc((distance_mm + shift_mm) / (std::numbers::sqrt2 * blur_mm));
}

/// What speaks for muscle: nats per mm³ of every voxel, and of muscle's mean grey value.
struct Evidence {
  Volume<float> nats;
  double muscle = 0;
};

struct Weight {
  double nats = 0, volume_mm3 = 0;
};

/// By how much the bundle is more likely than none. Where a share s of muscle is seen, the mean grey value is s of the
/// way from blood to muscle, which makes the log-likelihood s times the voxel's nats, and s (1 - s) times muscle's.
Weight weigh(const Evidence& evidence, const MuscleBundle& bundle) {
  const double voxel = evidence.nats.grid.voxel_volume_mm3();
  Weight sum;
  for_each_within(evidence.nats.grid, bundle, 2 * blur_mm, [&](std::size_t v, double distance) {
    if (evidence.nats.voxels[v] == 0) return;
    const double part = share(distance, bundle.radius_mm);
    sum.nats += voxel * part * (static_cast<double>(evidence.nats.voxels[v]) + (1 - part) * evidence.muscle);
    sum.volume_mm3 += voxel * part;
  });
  return sum;
}

/// One of every pair of opposite directions to the 26 neighbours.
std::array<Index3, 13> directions() {
  std::array<Index3, 13> result;
  std::size_t n = 0;
  for (std::int64_t k = 0; k <= 1; ++k)
    for (std::int64_t j = -1; j <= 1; ++j)
      for (std::int64_t i = -1; i <= 1; ++i)
        if (k > 0 || j > 0 || (j == 0 && i > 0)) result[n++] = {i, j, k};
  return result;
}

Vec3 to_vec(const Index3& v) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

/// The greatest sum along a line through every voxel, and its direction.
struct LineSums {
  Volume<float> greatest;
  Volume<std::uint8_t> direction;
};

LineSums line_sums(const Volume<float>& smooth) {
  const Grid& grid = smooth.grid;
  LineSums sums{Volume<float>(grid), Volume<std::uint8_t>(grid)};
  const auto all = directions();
  const auto sum_along = [&](const Index3& at, const Index3& step, double step_mm) {
    const auto reach = std::lround(half_length_mm / step_mm);
    float sum = 0;
    for (std::int64_t n = -reach; n <= reach; ++n) {
      const Index3 to{at[0] + n * step[0], at[1] + n * step[1], at[2] + n * step[2]};
      if (grid.contains(to[0], to[1], to[2])) sum += smooth(to[0], to[1], to[2]);
    }
    return sum * static_cast<float>(step_mm);
  };
  parallel::parallel_for(0, grid.size[2], [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < grid.size[1]; ++j)
        for (std::int64_t i = 0; i < grid.size[0]; ++i) {
          if (smooth(i, j, k) <= 0) continue;
          for (std::size_t d = 0; d < all.size(); ++d) {
            const float sum = sum_along({i, j, k}, all[d], norm(to_vec(all[d])) * grid.spacing_mm.x);
            if (sum <= sums.greatest(i, j, k)) continue;
            sums.greatest(i, j, k) = sum;
            sums.direction(i, j, k) = static_cast<std::uint8_t>(d);
          }
        }
  });
  return sums;
}

/// Whether no neighbour has more.
bool is_peak(const Volume<float>& values, const Index3& at) {
  for (std::int64_t k = -1; k <= 1; ++k)
    for (std::int64_t j = -1; j <= 1; ++j)
      for (std::int64_t i = -1; i <= 1; ++i)
        if (values(at[0] + i, at[1] + j, at[2] + k) > values(at[0], at[1], at[2])) return false;
  return true;
}

std::vector<MuscleBundle> first_guesses(const Volume<float>& evidence) {
  const LineSums sums = line_sums(image::gaussian(evidence, across_mm));
  const Grid& grid = evidence.grid;
  std::vector<std::pair<float, Index3>> peaks;
  for (std::int64_t k = 1; k + 1 < grid.size[2]; ++k)
    for (std::int64_t j = 1; j + 1 < grid.size[1]; ++j)
      for (std::int64_t i = 1; i + 1 < grid.size[0]; ++i)
        if (sums.greatest(i, j, k) > 0 && is_peak(sums.greatest, {i, j, k}))
          peaks.push_back({-sums.greatest(i, j, k), {i, j, k}});
  std::sort(peaks.begin(), peaks.end());
  if (peaks.size() > max_guesses) peaks.resize(max_guesses);
  std::vector<MuscleBundle> guesses;
  for (const auto& [sum, at] : peaks) {
    const Vec3 middle = grid.spacing_mm.x * to_vec(at);
    const Vec3 half = half_length_mm * normalized(to_vec(directions()[sums.direction(at[0], at[1], at[2])]));
    guesses.push_back({middle - half, middle + half, first_radius_mm, 0});
  }
  return guesses;
}

/// The bundle with one thing changed: an end, both ends, the length or the radius.
std::vector<MuscleBundle> changes(const MuscleBundle& bundle, double step_mm) {
  std::vector<MuscleBundle> result;
  const auto add = [&](const Vec3& from, const Vec3& to, double radius) {
    result.push_back({bundle.from_mm + from, bundle.to_mm + to, bundle.radius_mm + radius, 0});
  };
  const Vec3 axis = normalized(bundle.to_mm - bundle.from_mm);
  for (const double step : {-step_mm, step_mm}) {
    for (int n = 0; n < 3; ++n) {
      Vec3 shift;
      shift[n] = step;
      add(shift, {}, 0);
      add({}, shift, 0);
      add(shift, shift, 0);
    }
    add(step * axis, {}, 0);
    add({}, step * axis, 0);
    add({}, {}, step / 2);
  }
  return result;
}

bool allowed(const MuscleBundle& bundle) {
  const double length = norm(bundle.to_mm - bundle.from_mm);
  return bundle.radius_mm >= thinnest_mm && bundle.radius_mm <= thickest_mm && length >= 1 && length <= longest_mm;
}

/// The best bundle that changes lead to; large ones first, which noise along the way does not stop.
MuscleBundle refine(const Evidence& evidence, MuscleBundle bundle) {
  constexpr int max_changes = 12;
  bundle.nats = weigh(evidence, bundle).nats;
  for (const double step_mm : {8.0, 4.0, 2.0, 1.0, 0.5})
    for (int n = 0; n < max_changes; ++n) {
      MuscleBundle best = bundle;
      for (MuscleBundle& other : changes(bundle, step_mm)) {
        if (!allowed(other)) continue;
        other.nats = weigh(evidence, other).nats;
        if (other.nats > best.nats) best = other;
      }
      if (best.nats <= bundle.nats) break;
      bundle = best;
    }
  return bundle;
}

/// What a bundle is seen in says nothing for another one.
void clear(const MuscleBundle& bundle, Volume<float>& nats) {
  constexpr double unseen = 0.05;
  for_each_within(nats.grid, bundle, 2 * blur_mm, [&](std::size_t v, double distance) {
    if (share(distance, bundle.radius_mm) > unseen) nats.voxels[v] = 0;
  });
}

/// Whether the anatomy of a ventricle allows the bundle, see MuscleAnchors.
bool is_held(const MuscleBundle& bundle, const std::optional<MuscleAnchors>& anchors) {
  constexpr double wall_mm = 2;      // by which contour and ends may be wrong
  constexpr double points_to = 0.5;  // cosine, 60 degrees
  if (!anchors) return true;
  const auto on_wall = [&](const Vec3& end) {
    const Volume<float>& from_wall = anchors->from_wall_mm;
    return sample_linear(from_wall, (1 / from_wall.grid.spacing_mm.x) * end) <= bundle.radius_mm + wall_mm;
  };
  const bool from = on_wall(bundle.from_mm), to = on_wall(bundle.to_mm);
  if (from == to || !anchors->orifice_mm) return from || to;
  const Vec3 &foot = from ? bundle.from_mm : bundle.to_mm, &tip = from ? bundle.to_mm : bundle.from_mm;
  return dot(normalized(tip - foot), normalized(*anchors->orifice_mm - tip)) > points_to;
}

/// Those of at least `least` nats, the surest first; what is far more than muscle, or not held as a muscle, is none.
std::vector<MuscleBundle> surest(const Evidence& evidence, const std::optional<MuscleAnchors>& anchors, double least) {
  Evidence left = evidence;
  std::vector<MuscleBundle> guesses = first_guesses(evidence.nats), found;
  parallel::parallel_for(0, static_cast<std::int64_t>(guesses.size()), [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t n = begin; n < end; ++n) {
      auto& guess = guesses[static_cast<std::size_t>(n)];
      guess = refine(left, guess);
    }
  });
  const auto surer = [](const MuscleBundle& a, const MuscleBundle& b) { return a.nats < b.nats; };
  while (!guesses.empty()) {
    const auto best = std::max_element(guesses.begin(), guesses.end(), surer);
    const MuscleBundle bundle = *best;
    const Weight weight = weigh(left, bundle);
    const bool taken = weight.nats < 0.99 * bundle.nats;  // a surer one has taken part of it: what remains?
    if (taken) *best = refine(left, bundle);
    if (taken && best->nats >= least && best->nats < bundle.nats) continue;
    guesses.erase(best);
    if (taken || bundle.nats < least || !is_held(bundle, anchors)) continue;
    if (weight.nats <= bulk_of_muscle * evidence.muscle * weight.volume_mm3) found.push_back(bundle);
    clear(bundle, left.nats);
  }
  return found;
}

/// The image mirrored at blood's grey value: noise of the same grain, and no muscle.
Evidence mirrored(Evidence evidence) {
  const auto twice = static_cast<float>(2 * evidence.muscle);
  for (float& nats : evidence.nats.voxels)
    if (nats != 0) nats = -twice - nats;
  return evidence;
}

}  // namespace

std::vector<MuscleBundle> find_muscle_bundles(const Volume<float>& evidence, double muscle_evidence,
                                              const std::optional<MuscleAnchors>& anchors) {
  const Evidence seen{evidence, std::min(muscle_evidence, max_evidence)};
  const auto chance = surest(mirrored(seen), anchors, usual_chance_nats);
  return surest(seen, anchors, beyond_chance * (chance.empty() ? usual_chance_nats : chance.front().nats));
}

void carve_bundles(const std::vector<MuscleBundle>& bundles, const Mask& where, Volume<float>& blood) {
  constexpr double margin_mm = 1;
  for (const auto& bundle : bundles)
    for_each_within(blood.grid, bundle, margin_mm, [&](std::size_t v, double distance) {
      const auto off = static_cast<float>(std::max(distance, -margin_mm));
      if (where.voxels[v]) blood.voxels[v] = std::min(blood.voxels[v], off);
    });
}

}  // namespace heartgen::anatomy
