// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/domain.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "generator/parallel/threads.hpp"

namespace heartgen::mesh {
namespace {

using Shares = std::array<float, label_count>;

constexpr std::array left_blood{Region::lv_blood, Region::la_blood, Region::aorta};
constexpr std::array right_blood{Region::rv_blood, Region::ra_blood, Region::pulmonary_artery};
constexpr std::array walls{Region::lv_myocardium, Region::rv_myocardium, Region::papillary, Region::la_wall,
                           Region::ra_wall};
constexpr std::array others{Region::none,  Region::lung,    Region::bone,   Region::liver,
                            Region::torso, Region::trachea, Region::carotid};

std::uint8_t largest(const Shares& shares, const auto& regions) {
  Region best = regions[0];
  for (const Region r : regions)
    if (shares[tag(r)] > shares[tag(best)]) best = r;
  return tag(best);
}

/// The region where labels have these shares; share_at(label) is asked only for those that matter.
template <class ShareAt>
std::uint8_t decide(ShareAt&& share_at) {
  Shares shares{};
  const auto sum_of = [&](const auto& regions) {
    float sum = 0;
    for (const Region r : regions) sum += shares[tag(r)] = share_at(tag(r));
    return sum;
  };
  const float left = sum_of(left_blood);
  if (left > 0.5F) return largest(shares, left_blood);
  const float right = sum_of(right_blood);
  if (right > 0.5F) return largest(shares, right_blood);
  const float wall = sum_of(walls);
  if (left + right + wall <= 0.5F) {
    sum_of(others);
    return largest(shares, others);
  }
  if (wall > 0) return largest(shares, walls);
  return left >= right ? largest(shares, left_blood) : largest(shares, right_blood);
}

/// Shares of a row of voxels of the label map, 0 outside [first, last).
struct ShareRow {
  const float* share = nullptr;
  std::int64_t first = 0, last = 0;
  float at(std::int64_t i) const { return i >= first && i < last ? share[i - first] : 0.0F; }
};

ShareRow row_of(const FractionField& field, std::int64_t j, std::int64_t k) {
  const auto& size = field.share.grid.size;
  const auto y = j - field.first[1], z = k - field.first[2];
  if (y < 0 || y >= size[1] || z < 0 || z >= size[2]) return {};
  return {&field.share(0, y, z), field.first[0], field.first[0] + size[0]};
}

void decide_voxels(MeshDomain& domain, const LabelVolume& labels, const Spans& changed) {
  const auto& size = domain.grid.size;
  parallel::parallel_for(0, size[2], [&](std::int64_t begin, std::int64_t end) {
    std::array<ShareRow, label_count> rows;
    for (auto k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < size[1]; ++j) {
        const auto span = changed.row(j, k);
        if (span.last < 0) continue;
        for (const auto& field : domain.shares) rows[field.label] = row_of(field, j, k);
        const auto row = static_cast<std::size_t>(domain.grid.offset(0, j, k));
        for (auto i = span.first; i <= span.last; ++i) {
          const auto voxel = row + static_cast<std::size_t>(i);
          const auto label = labels.voxels[voxel];
          // More than a half of one label decides, but for one that is smoothed more than the others.
          const bool is_bulk = (bulk_bits >> label & 1U) != 0;
          const bool is_sure = rows[label].at(i) > (is_bulk ? 0.99F : 0.5F);
          domain.voxels[voxel] = is_sure ? label : decide([&](std::uint8_t l) { return rows[l].at(i); });
        }
      }
  });
}

/// Of the cubes from voxel `first` to `last` of a row, whose corners lie in four rows of voxels. Written as sums of
/// differences, so that it vectorises.
void find_uniform_cubes(const std::array<const std::uint8_t*, 4>& corners, std::int64_t first, std::int64_t last,
                        std::int64_t step, std::uint8_t* cubes) {
  for (auto i = first; i < last; ++i) {
    const std::uint8_t label = corners[0][i];
    int different = 0;
    for (const auto* row : corners) different |= (row[i] ^ label) | (row[i + step] ^ label);
    cubes[i] = different == 0 ? label : MeshDomain::mixed;
  }
}

// The cubes at the voxels that have changed.
void find_uniform_cubes(MeshDomain& domain, const Spans& changed) {
  const auto& size = domain.grid.size;
  parallel::parallel_for(0, size[2], [&](std::int64_t begin, std::int64_t end) {
    for (auto k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < size[1]; ++j) {
        auto span = changed.row(j, k);
        for (const auto& [dj, dk] : {std::pair{1, 0}, std::pair{0, 1}, std::pair{1, 1}})
          span.add(changed.row(j + dj, k + dk));
        if (span.last < 0) continue;
        const auto row = [&](std::int64_t dj, std::int64_t dk) {
          return domain.voxels.data() +
                 domain.grid.offset(0, std::min(j + dj, size[1] - 1), std::min(k + dk, size[2] - 1));
        };
        const std::array<const std::uint8_t*, 4> corners{row(0, 0), row(1, 0), row(0, 1), row(1, 1)};
        auto* cubes = domain.cubes.data() + domain.grid.offset(0, j, k);
        const auto last = std::min(span.last + 1, size[0] - 1);  // the cube of the last voxel has no width
        find_uniform_cubes(corners, std::max<std::int64_t>(0, span.first - 1), last, 1, cubes);
        find_uniform_cubes(corners, last, span.last + 1, 0, cubes);
      }
  });
}

/// The values of a share at the corners of a cube.
struct CubeCorners {
  const float* first = nullptr;  // null: the share is 0 there
  std::array<std::int64_t, 3> step;
};

CubeCorners corners_of(const FractionField& field, const Index3& cube) {
  const auto& size = field.share.grid.size;
  CubeCorners corners{nullptr, {1, size[0], size[0] * size[1]}};
  Index3 at;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    at[axis] = cube[axis] - field.first[axis];
    // Outside its box a share is 0; a cube that straddles the box's end has a share of 0 too (margin of one voxel).
    if (at[axis] < 0 || at[axis] >= size[axis]) return corners;
    if (at[axis] + 1 >= size[axis]) corners.step[axis] = 0;
  }
  corners.first = &field.share(at[0], at[1], at[2]);
  return corners;
}

float mix(float a, float b, float t) { return a + t * (b - a); }

float trilinear(const FractionField& field, const Index3& cube, const std::array<float, 3>& fraction) {
  const auto [first, step] = corners_of(field, cube);
  if (first == nullptr) return 0;
  const float* p = first;
  const float low =
      mix(mix(p[0], p[step[0]], fraction[0]), mix(p[step[1]], p[step[0] + step[1]], fraction[0]), fraction[1]);
  p += step[2];
  const float high =
      mix(mix(p[0], p[step[0]], fraction[0]), mix(p[step[1]], p[step[0] + step[1]], fraction[0]), fraction[1]);
  return mix(low, high, fraction[2]);
}

// The same bits as trilinear at fractions of 1/4 and 3/4.
std::array<float, 8> shares_of_eighths(const FractionField& field, const Index3& cube) {
  constexpr std::array fractions{0.25F, 0.75F};
  std::array<float, 8> shares{};
  const auto [p, step] = corners_of(field, cube);
  if (p == nullptr) return shares;
  for (std::size_t i = 0; i < 2; ++i) {
    std::array<float, 4> rows;  // y, then z
    for (std::size_t row = 0; row < 4; ++row) {
      const float* q =
          p + static_cast<std::int64_t>(row & 1U) * step[1] + static_cast<std::int64_t>(row >> 1U) * step[2];
      rows[row] = mix(q[0], q[step[0]], fractions[i]);
    }
    for (std::size_t j = 0; j < 2; ++j) {
      const float low = mix(rows[0], rows[1], fractions[j]), high = mix(rows[2], rows[3], fractions[j]);
      for (std::size_t k = 0; k < 2; ++k) shares[i + 2 * j + 4 * k] = mix(low, high, fractions[k]);
    }
  }
  return shares;
}

/// Shares of some labels and their gradients at one place.
struct ShareSample {
  double value = 0;
  Vec3 gradient;
  ShareSample& operator+=(const ShareSample& other) {
    value += other.value;
    gradient += other.gradient;
    return *this;
  }
};

ShareSample sample_share(const FractionField& field, const Index3& cube, const std::array<float, 3>& fraction) {
  const auto [p, step] = corners_of(field, cube);
  if (p == nullptr) return {};
  const double u = static_cast<double>(fraction[0]), v = static_cast<double>(fraction[1]),
               w = static_cast<double>(fraction[2]);
  double along[4], rise[4];  // of the four rows of the cube
  for (std::size_t row = 0; row < 4; ++row) {
    const float* q =
        p + (row & 1U) * static_cast<std::size_t>(step[1]) + (row >> 1U) * static_cast<std::size_t>(step[2]);
    rise[row] = static_cast<double>(q[step[0]]) - static_cast<double>(q[0]);
    along[row] = static_cast<double>(q[0]) + u * rise[row];
  }
  const double low = along[0] + v * (along[1] - along[0]), high = along[2] + v * (along[3] - along[2]);
  const double rise_low = rise[0] + v * (rise[1] - rise[0]), rise_high = rise[2] + v * (rise[3] - rise[2]);
  const double over_low = along[1] - along[0], over_high = along[3] - along[2];
  const auto& spacing = field.share.grid.spacing_mm;
  return {low + w * (high - low),
          {(rise_low + w * (rise_high - rise_low)) / spacing.x, (over_low + w * (over_high - over_low)) / spacing.y,
           (high - low) / spacing.z}};
}

/// Where an index lies: its cube and the place inside it. Beyond the border, the border.
struct CubePlace {
  Index3 cube;
  std::array<float, 3> fraction;
};

CubePlace extract_cavity(const Grid& grid, const Vec3& index) {
  CubePlace place;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const double inside = std::clamp(index[axis], 0.0, static_cast<double>(grid.size[a] - 1));
    place.cube[a] = static_cast<std::int64_t>(inside);
    place.fraction[a] = static_cast<float>(inside - static_cast<double>(place.cube[a]));
  }
  return place;
}

}  // namespace

int equations_at(const MeshDomain& domain, std::uint32_t labels, const Vec3& index,
                 std::span<SurfaceEquation> equations) {
  // In the order of `decide`: each group against what comes after it, and inside a group the shares against each other.
  const std::array groups{bits_of(left_blood), bits_of(right_blood), bits_of(walls), bits_of(others)};
  const auto place = extract_cavity(domain.grid, index);
  const auto sum = [&](std::uint32_t wanted) {
    ShareSample total;
    for (const auto& field : domain.shares)
      if ((wanted >> field.label & 1U) != 0) total += sample_share(field, place.cube, place.fraction);
    return total;
  };
  std::size_t count = 0;
  const auto add = [&](const ShareSample& s) {
    if (count < equations.size()) equations[count++] = {s.value, s.gradient};
  };
  std::uint32_t inside = 0;  // of the heart, up to the present group
  for (const auto group : groups) {
    inside |= group;
    const std::uint32_t present = labels & group;
    if (present == 0) continue;
    labels &= ~group;
    if (labels != 0) {
      auto share = sum(group == groups[2] ? inside : group);
      share.value -= 0.5;
      add(share);
    }
    const std::uint32_t first = present & (~present + 1);
    if (present == first) continue;
    const auto one = sum(first);
    for (std::uint32_t rest = present & ~first; rest != 0; rest &= rest - 1) {
      auto other = sum(rest & (~rest + 1));
      add({other.value - one.value, other.gradient - one.gradient});
    }
  }
  return static_cast<int>(count);
}

void update_regions(MeshDomain& domain, const LabelVolume& labels, const Spans& changed) {
  domain.voxels.resize(labels.voxels.size());
  domain.cubes.resize(labels.voxels.size());
  decide_voxels(domain, labels, changed);
  find_uniform_cubes(domain, changed);
}

std::uint8_t region_at(const MeshDomain& domain, const Vec3& index) {
  const auto [cube, fraction] = extract_cavity(domain.grid, index);
  const auto label = domain.cubes[static_cast<std::size_t>(domain.grid.offset(cube[0], cube[1], cube[2]))];
  if (label != MeshDomain::mixed) return label;
  return decide([&, &cube = cube, &fraction = fraction](std::uint8_t l) {
    const auto field = domain.share_of[l];
    return field < 0 ? 0.0F : trilinear(domain.shares[static_cast<std::size_t>(field)], cube, fraction);
  });
}

std::array<std::uint8_t, 8> regions_of_eighths(const MeshDomain& domain, const Index3& cube) {
  std::array<std::array<float, 8>, label_count> shares;
  std::uint32_t known = 0;
  std::array<std::uint8_t, 8> regions;
  for (std::size_t part = 0; part < regions.size(); ++part)
    regions[part] = decide([&](std::uint8_t l) {
      if (const auto field = domain.share_of[l]; (known >> l & 1U) == 0)
        shares[l] = field < 0 ? std::array<float, 8>{}
                              : shares_of_eighths(domain.shares[static_cast<std::size_t>(field)], cube);
      known |= 1U << l;
      return shares[l][part];
    });
  return regions;
}

HeartShares heart_shares(const MeshDomain& domain, const Vec3& index) {
  const auto [cube, fraction] = extract_cavity(domain.grid, index);
  const auto sum = [&, &cube = cube, &fraction = fraction](const auto& regions) {
    float total = 0;
    for (const Region r : regions)
      if (const auto field = domain.share_of[tag(r)]; field >= 0)
        total += trilinear(domain.shares[static_cast<std::size_t>(field)], cube, fraction);
    return total;
  };
  HeartShares shares{sum(left_blood), sum(right_blood), 0};
  shares.heart = shares.left_blood + shares.right_blood + sum(walls);
  return shares;
}

}  // namespace heartgen::mesh
