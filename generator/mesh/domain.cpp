#include "generator/mesh/domain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "generator/mesh/size_field.hpp"
#include "model/error.hpp"

namespace heart::mesh {
namespace {

constexpr std::size_t label_count = 18;
// 0.8 would leave a quarter of the stairs that 0.6 leaves, but takes 2 % more of the volume of a ball of 7 voxels.
constexpr double least_smoothing_voxels = 0.6;

using Shares = std::array<float, label_count>;

struct Box {
  Index3 low{INT64_MAX, INT64_MAX, INT64_MAX};
  Index3 high{-1, -1, -1};  // inclusive
  bool empty() const { return high[0] < 0; }
};

std::array<Box, label_count> boxes_of(const LabelVolume& labels) {
  std::array<Box, label_count> boxes;
  const auto& size = labels.grid.size;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j) {
      const auto* row = &labels.voxels[static_cast<std::size_t>(labels.grid.offset(0, j, k))];
      for (std::int64_t i = 0; i < size[0]; ++i) {
        if (row[i] >= label_count)
          throw UserError(fmt::format("label {} is not a known region", row[i]), "label map",
                          "labels are the region tags 0 to 17");
        if (i > 0 && row[i] == row[i - 1] && i <= boxes[row[i]].high[0]) continue;
        auto& box = boxes[row[i]];
        const Index3 at{i, j, k};
        for (std::size_t axis = 0; axis < 3; ++axis) {
          box.low[axis] = std::min(box.low[axis], at[axis]);
          box.high[axis] = std::max(box.high[axis], at[axis]);
        }
      }
    }
  return boxes;
}

std::vector<float> gaussian(double sigma_voxels) {
  const int radius = std::max(1, static_cast<int>(std::ceil(3 * sigma_voxels)));
  std::vector<double> weights;
  double sum = 0;
  for (int i = -radius; i <= radius; ++i) {
    weights.push_back(std::exp(-0.5 * i * i / (sigma_voxels * sigma_voxels)));
    sum += weights.back();
  }
  std::vector<float> normalized_weights;
  normalized_weights.reserve(weights.size());
  for (const double w : weights) normalized_weights.push_back(static_cast<float>(w / sum));
  return normalized_weights;
}

// Convolution along one axis, border values continued. Works on whole rows, so that it vectorises.
void smooth_axis(Volume<float>& volume, std::size_t axis, const std::vector<float>& weights) {
  const auto& grid = volume.grid;
  const auto& size = grid.size;
  const std::int64_t radius = static_cast<std::int64_t>(weights.size() / 2);
  const std::int64_t row_length = size[0];
  std::vector<float> result(volume.voxels.size(), 0.0F);
  std::vector<float> padded(static_cast<std::size_t>(row_length + 2 * radius));
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j) {
      float* out = &result[static_cast<std::size_t>(grid.offset(0, j, k))];
      if (axis == 0) {
        const float* row = &volume.voxels[static_cast<std::size_t>(grid.offset(0, j, k))];
        for (std::int64_t i = 0; i < row_length + 2 * radius; ++i)
          padded[static_cast<std::size_t>(i)] = row[std::clamp<std::int64_t>(i - radius, 0, row_length - 1)];
      }
      for (std::int64_t tap = -radius; tap <= radius; ++tap) {
        const float weight = weights[static_cast<std::size_t>(tap + radius)];
        const auto shifted = [&](std::int64_t at, std::size_t along) {
          return along == axis ? std::clamp<std::int64_t>(at + tap, 0, size[along] - 1) : at;
        };
        const float* in = axis == 0
                              ? padded.data() + radius + tap
                              : &volume.voxels[static_cast<std::size_t>(grid.offset(0, shifted(j, 1), shifted(k, 2)))];
        for (std::int64_t i = 0; i < row_length; ++i) out[i] += weight * in[i];
      }
    }
  volume.voxels.swap(result);
}

ShareField share_field(const LabelVolume& labels, std::uint8_t label, const Box& box,
                       const std::array<std::vector<float>, 3>& weights) {
  ShareField field;
  field.label = label;
  Grid grid;
  grid.spacing_mm = labels.grid.spacing_mm;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto margin = static_cast<std::int64_t>(weights[axis].size() / 2) + 1;
    field.first[axis] = std::max<std::int64_t>(0, box.low[axis] - margin);
    grid.size[axis] = std::min(labels.grid.size[axis], box.high[axis] + margin + 1) - field.first[axis];
  }
  field.share = Volume<float>(grid);
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j) {
      const auto* in = &labels(field.first[0], field.first[1] + j, field.first[2] + k);
      float* out = &field.share(0, j, k);
      for (std::int64_t i = 0; i < grid.size[0]; ++i) out[i] = in[i] == label ? 1.0F : 0.0F;
    }
  for (std::size_t axis = 0; axis < 3; ++axis) smooth_axis(field.share, axis, weights[axis]);
  return field;
}

std::array<std::vector<float>, 3> weights_of(const Grid& grid, double smoothing_mm) {
  std::array<std::vector<float>, 3> weights;
  for (int axis = 0; axis < 3; ++axis)
    weights[static_cast<std::size_t>(axis)] =
        gaussian(std::max(smoothing_mm / grid.spacing_mm[axis], least_smoothing_voxels));
  return weights;
}

constexpr std::array left_blood{Region::lv_blood, Region::la_blood, Region::aorta};
constexpr std::array right_blood{Region::rv_blood, Region::ra_blood, Region::pulmonary_artery};
constexpr std::array walls{Region::lv_myocardium, Region::rv_myocardium, Region::papillary, Region::la_wall,
                           Region::ra_wall};
constexpr std::array others{Region::none,  Region::lung,    Region::bone,   Region::liver,
                            Region::torso, Region::trachea, Region::carotid};
/// Regions that far from the heart get edges of the torso.
constexpr std::array bulk{Region::none, Region::lung, Region::bone, Region::liver, Region::torso};

std::uint32_t bits_of(const auto& regions) {
  std::uint32_t bits = 0;
  for (const Region r : regions) bits |= 1U << tag(r);
  return bits;
}

float sum_of(const Shares& shares, const auto& regions) {
  float sum = 0;
  for (const Region r : regions) sum += shares[tag(r)];
  return sum;
}

std::uint8_t largest(const Shares& shares, const auto& regions) {
  Region best = regions[0];
  for (const Region r : regions)
    if (shares[tag(r)] > shares[tag(best)]) best = r;
  return tag(best);
}

std::uint8_t decide(const Shares& shares) {
  const float left = sum_of(shares, left_blood);
  if (left > 0.5F) return largest(shares, left_blood);
  const float right = sum_of(shares, right_blood);
  if (right > 0.5F) return largest(shares, right_blood);
  const float wall = sum_of(shares, walls);
  if (left + right + wall <= 0.5F) return largest(shares, others);
  if (wall > 0) return largest(shares, walls);
  return left >= right ? largest(shares, left_blood) : largest(shares, right_blood);
}

std::vector<std::uint8_t> decide_voxels(const MeshDomain& domain, const LabelVolume& labels) {
  const auto& size = domain.grid.size;
  std::array<const ShareField*, label_count> field_of{};
  for (const auto& field : domain.shares) field_of[field.label] = &field;
  const auto share = [](const ShareField& f, const Index3& at) {
    const Index3 local{at[0] - f.first[0], at[1] - f.first[1], at[2] - f.first[2]};
    return f.share.grid.contains(local[0], local[1], local[2]) ? f.share(local[0], local[1], local[2]) : 0.0F;
  };
  const auto body = bits_of(bulk);
  std::vector<std::uint8_t> result = labels.voxels;
  std::size_t voxel = 0;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i, ++voxel) {
        const Index3 at{i, j, k};
        // More than a half of one label decides, but for one that is smoothed more than the others.
        const bool is_bulk = (body >> result[voxel] & 1U) != 0;
        if (share(*field_of[result[voxel]], at) > (is_bulk ? 0.99F : 0.5F)) continue;
        Shares shares{};
        for (const auto& field : domain.shares) shares[field.label] = share(field, at);
        result[voxel] = decide(shares);
      }
  return result;
}

std::vector<std::uint8_t> uniform_cubes(const Grid& grid, const std::vector<std::uint8_t>& voxels) {
  std::vector<std::uint8_t> cubes(voxels.size());
  const auto& size = grid.size;
  std::size_t cube = 0;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i, ++cube) {
        const std::int64_t di = i + 1 < size[0], dj = j + 1 < size[1] ? size[0] : 0,
                           dk = k + 1 < size[2] ? size[0] * size[1] : 0;
        const auto* corner = &voxels[cube];
        const std::uint8_t label = corner[0];
        const bool same = corner[di] == label && corner[dj] == label && corner[di + dj] == label &&
                          corner[dk] == label && corner[di + dk] == label && corner[dj + dk] == label &&
                          corner[di + dj + dk] == label;
        cubes[cube] = same ? label : MeshDomain::mixed;
      }
  return cubes;
}

float trilinear(const ShareField& field, const Index3& cube, const std::array<float, 3>& fraction) {
  const auto& size = field.share.grid.size;
  std::int64_t at[3], step[3] = {1, size[0], size[0] * size[1]};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    at[axis] = cube[axis] - field.first[axis];
    // Outside its box a share is 0; a cube that straddles the box's end has a share of 0 too (margin of one voxel).
    if (at[axis] < 0 || at[axis] >= size[axis]) return 0;
    if (at[axis] + 1 >= size[axis]) step[axis] = 0;
  }
  const float* p = &field.share(at[0], at[1], at[2]);
  const auto mix = [](float a, float b, float t) { return a + t * (b - a); };
  const float low =
      mix(mix(p[0], p[step[0]], fraction[0]), mix(p[step[1]], p[step[0] + step[1]], fraction[0]), fraction[1]);
  p += step[2];
  const float high =
      mix(mix(p[0], p[step[0]], fraction[0]), mix(p[step[1]], p[step[0] + step[1]], fraction[0]), fraction[1]);
  return mix(low, high, fraction[2]);
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

ShareSample sample_share(const ShareField& field, const Index3& cube, const std::array<float, 3>& fraction) {
  const auto& size = field.share.grid.size;
  std::int64_t at[3], step[3] = {1, size[0], size[0] * size[1]};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    at[axis] = cube[axis] - field.first[axis];
    if (at[axis] < 0 || at[axis] >= size[axis]) return {};
    if (at[axis] + 1 >= size[axis]) step[axis] = 0;
  }
  const float* p = &field.share(at[0], at[1], at[2]);
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

CubePlace place_of(const Grid& grid, const Vec3& index) {
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
  const auto place = place_of(domain.grid, index);
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

MeshDomain make_domain(const LabelVolume& labels, double smoothing_mm, double body_smoothing_mm) {
  const auto boxes = boxes_of(labels);
  if (std::all_of(boxes.begin() + 1, boxes.end(), [](const Box& box) { return box.empty(); }))
    throw UserError("the label map has no labelled voxel", "label map", "nothing can be meshed");
  const auto fine = weights_of(labels.grid, smoothing_mm);
  const auto coarse = weights_of(labels.grid, std::max(smoothing_mm, body_smoothing_mm));
  const auto body = bits_of(bulk);
  MeshDomain domain;
  domain.grid = labels.grid;
  for (std::size_t label = 0; label < label_count; ++label)
    if (!boxes[label].empty())
      domain.shares.push_back(share_field(labels, static_cast<std::uint8_t>(label), boxes[label],
                                          (body >> label & 1U) != 0 ? coarse : fine));
  domain.voxels = decide_voxels(domain, labels);
  domain.cubes = uniform_cubes(domain.grid, domain.voxels);
  return domain;
}

MeshDomain make_domain(const LabelVolume& labels, const MeshSettings& settings) {
  const double body_edge_mm = finest_body_edge_mm(settings);
  return make_domain(labels, settings.smoothing_mm, settings.smoothing_mm * body_edge_mm / settings.heart_edge_mm);
}

std::uint8_t region_at(const MeshDomain& domain, const Vec3& index) {
  const auto [cube, fraction] = place_of(domain.grid, index);
  const auto label = domain.cubes[static_cast<std::size_t>(domain.grid.offset(cube[0], cube[1], cube[2]))];
  if (label != MeshDomain::mixed) return label;
  Shares shares{};
  for (const auto& field : domain.shares) shares[field.label] = trilinear(field, cube, fraction);
  return decide(shares);
}

}  // namespace heart::mesh
