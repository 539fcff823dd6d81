#include "generator/mesh/shares.hpp"

#include <algorithm>
#include <cmath>

#include "generator/parallel/threads.hpp"

namespace heart::mesh {
namespace {

constexpr double reach_sigmas = 3;

std::int64_t radius_of(const std::vector<float>& weights) { return static_cast<std::int64_t>(weights.size() / 2); }

double bell(double x, double sigma) { return std::exp(-0.5 * x * x / (sigma * sigma)) / sigma; }

template <class Weight>
std::vector<float> kernel(double reach_voxels, Weight&& weight) {
  const auto radius = std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(reach_voxels)));
  double sum = 0;
  for (auto i = -radius; i <= radius; ++i) sum += weight(static_cast<double>(i));
  std::vector<float> weights;
  for (auto i = -radius; i <= radius; ++i) weights.push_back(static_cast<float>(weight(static_cast<double>(i)) / sum));
  return weights;
}

// Works on whole rows, so that it vectorises.
void smooth_axis(Volume<float>& volume, std::size_t axis, const std::vector<float>& weights) {
  const auto& grid = volume.grid;
  const auto& size = grid.size;
  const std::int64_t radius = radius_of(weights), row_length = size[0];
  std::vector<float> result(volume.voxels.size(), 0.0F);
  const auto smooth_slices = [&](std::int64_t begin, std::int64_t end) {
    std::vector<float> padded(static_cast<std::size_t>(row_length + 2 * radius));
    for (std::int64_t k = begin; k < end; ++k)
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
          const float* in =
              axis == 0 ? padded.data() + radius + tap
                        : &volume.voxels[static_cast<std::size_t>(grid.offset(0, shifted(j, 1), shifted(k, 2)))];
          for (std::int64_t i = 0; i < row_length; ++i) out[i] += weight * in[i];
        }
      }
  };
  parallel::parallel_for(0, size[2], smooth_slices);
  volume.voxels.swap(result);
}

}  // namespace

void Box::add(const Index3& at) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis] = std::min(low[axis], at[axis]);
    high[axis] = std::max(high[axis], at[axis]);
  }
}

Kernels gaussian_kernels(const Vec3& sigma_voxels) {
  Kernels kernels;
  for (int axis = 0; axis < 3; ++axis) {
    const double sigma = sigma_voxels[axis];
    kernels[static_cast<std::size_t>(axis)] = kernel(reach_sigmas * sigma, [&](double x) { return bell(x, sigma); });
  }
  return kernels;
}

Kernels sharp_kernels(const Vec3& sigma_voxels) {
  Kernels kernels;
  for (int axis = 0; axis < 3; ++axis) {
    const double once = sigma_voxels[axis], twice = std::sqrt(2.0) * once;
    kernels[static_cast<std::size_t>(axis)] =
        kernel(reach_sigmas * twice, [&](double x) { return 2 * bell(x, once) - bell(x, twice); });
  }
  return kernels;
}

void smooth(Volume<float>& volume, const Kernels& kernels) {
  for (std::size_t axis = 0; axis < 3; ++axis) smooth_axis(volume, axis, kernels[axis]);
}

ShareField share_field(const LabelVolume& labels, std::uint8_t label, const Box& box, const Kernels& kernels) {
  ShareField field;
  field.label = label;
  Grid grid;
  grid.spacing_mm = labels.grid.spacing_mm;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto margin = radius_of(kernels[axis]) + 1;
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
  smooth(field.share, kernels);
  return field;
}

float share_at(const ShareField& field, const Index3& voxel) {
  const Index3 at{voxel[0] - field.first[0], voxel[1] - field.first[1], voxel[2] - field.first[2]};
  return field.share.grid.contains(at[0], at[1], at[2]) ? field.share(at[0], at[1], at[2]) : 0.0F;
}

void add_kernel(ShareField& field, const Index3& voxel, float amount, const Kernels& kernels) {
  Index3 low, high, first_weight;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int64_t radius = radius_of(kernels[a]), center = voxel[a] - field.first[a];
    low[a] = std::max<std::int64_t>(0, center - radius);
    high[a] = std::min(field.share.grid.size[a] - 1, center + radius);
    first_weight[a] = radius - center;
  }
  const auto weight = [&](std::size_t axis, std::int64_t at) {
    return kernels[axis][static_cast<std::size_t>(at + first_weight[axis])];
  };
  for (auto k = low[2]; k <= high[2]; ++k)
    for (auto j = low[1]; j <= high[1]; ++j) {
      const float of_row = amount * weight(2, k) * weight(1, j);
      for (auto i = low[0]; i <= high[0]; ++i) field.share(i, j, k) += of_row * weight(0, i);
    }
}

}  // namespace heart::mesh
