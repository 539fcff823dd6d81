// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/shares.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "generator/parallel/simd.hpp"
#include "generator/parallel/threads.hpp"
#include "model/mathematics.hpp"

namespace heartgen::mesh {
namespace {

constexpr double reach_sigmas = 3;

std::int64_t radius_of(const std::vector<float>& weights) { return static_cast<std::int64_t>(weights.size() / 2); }

double bell(double x, double sigma) { return math::exp(-0.5 * x * x / (sigma * sigma)) / sigma; }

template <class Weight>
std::vector<float> kernel(double reach_voxels, Weight&& weight) {
  const auto radius = std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(reach_voxels)));
  double sum = 0;
  for (auto i = -radius; i <= radius; ++i) sum += weight(static_cast<double>(i));
  std::vector<float> weights;
  for (auto i = -radius; i <= radius; ++i) weights.push_back(static_cast<float>(weight(static_cast<double>(i)) / sum));
  return weights;
}

// Away from its surfaces a share is 0 or 1, mostly: stretches of rows that see one value only are filled with what the
// weights make of it, by the same sums.
constexpr std::int64_t stretch_voxels = 32;
constexpr float mixed = std::numeric_limits<float>::quiet_NaN();

/// The value of each stretch of a row where it is the same all along, else `mixed`.
struct Stretches {
  std::int64_t per_row;
  std::vector<float> value;
  float* row(std::int64_t number) { return value.data() + number * per_row; }
  const float* row(std::int64_t number) const { return value.data() + number * per_row; }
};

Stretches stretches_of(const Volume<float>& volume) {
  const auto& size = volume.grid.size;
  Stretches result{(size[0] + stretch_voxels - 1) / stretch_voxels, {}};
  result.value.resize(static_cast<std::size_t>(result.per_row * size[1] * size[2]));
  parallel::parallel_for(0, size[1] * size[2], [&](std::int64_t begin, std::int64_t end) {
    for (auto r = begin; r < end; ++r)
      for (std::int64_t s = 0; s < result.per_row; ++s) {
        const float* first = volume.voxels.data() + r * size[0] + s * stretch_voxels;
        const float* last = volume.voxels.data() + std::min((s + 1) * stretch_voxels + r * size[0], (r + 1) * size[0]);
        result.row(r)[s] = std::all_of(first, last, [&](float v) { return v == *first; }) ? *first : mixed;
      }
  });
  return result;
}

// Taps along a row, one after the other, so that it vectorises and the bits are the same for any vector length.
HEARTGEN_INLINE void add_four(const float* weights, const float* a, const float* b, const float* c, const float* d,
                              std::int64_t count, float* __restrict out) {
  for (std::int64_t i = 0; i < count; ++i)
    out[i] = (((out[i] + weights[0] * a[i]) + weights[1] * b[i]) + weights[2] * c[i]) + weights[3] * d[i];
}
HEARTGEN_INLINE void add_one(float weight, const float* in, std::int64_t count, float* __restrict out) {
  for (std::int64_t i = 0; i < count; ++i) out[i] += weight * in[i];
}

/// One axis of a convolution: where it reads (border values continued) and what it weighs.
class AxisPass {
 public:
  AxisPass(const Index3& size, const float* in, const Stretches& stretches, std::size_t axis,
           const std::vector<float>& weights)
      : size_(size), in_(in), stretches_(stretches), axis_(axis), weights_(weights), radius_(radius_of(weights)) {}

  /// Writes the row (j, k), along the first axis also to where it is read, and its stretches.
  void smooth_row(std::int64_t j, std::int64_t k, std::vector<float>& padded, float* out, float* out_stretches) const {
    const auto length = size_[0], count = stretches_.per_row;
    if (axis_ == 0) pad(j, k, padded);
    for (std::int64_t s = 0; s < count;) {
      out_stretches[s] = weighed(common_value(s, j, k));
      const auto from = s * stretch_voxels;
      if (!std::isnan(out_stretches[s])) {
        std::fill(out + from, out + std::min(from + stretch_voxels, length), out_stretches[s]);
        ++s;
        continue;
      }
      for (++s; s < count && std::isnan(common_value(s, j, k)); ++s) out_stretches[s] = mixed;
      convolve(j, k, padded, out, from, std::min(s * stretch_voxels, length));
    }
  }

 private:
  std::int64_t row_at(std::int64_t j, std::int64_t k, std::int64_t tap) const {
    if (axis_ == 1) j = std::clamp<std::int64_t>(j + tap, 0, size_[1] - 1);
    if (axis_ == 2) k = std::clamp<std::int64_t>(k + tap, 0, size_[2] - 1);
    return k * size_[1] + j;
  }

  /// The value of all voxels that a stretch depends on, or `mixed`.
  float common_value(std::int64_t s, std::int64_t j, std::int64_t k) const {
    const float own = stretches_.row(row_at(j, k, 0))[s];
    if (axis_ == 0) {
      const auto reach = (radius_ + stretch_voxels - 1) / stretch_voxels;
      const float* row = stretches_.row(row_at(j, k, 0));
      const auto last = std::min(s + reach, stretches_.per_row - 1);
      for (auto other = std::max<std::int64_t>(0, s - reach); other <= last; ++other)
        if (row[other] != own) return mixed;
      return own;
    }
    for (auto tap = -radius_; tap <= radius_; ++tap)
      if (stretches_.row(row_at(j, k, tap))[s] != own) return mixed;
    return own;
  }

  float weighed(float value) const {
    float sum = 0;
    for (const float weight : weights_) sum += weight * value;
    return sum;
  }

  // The row as it is before it is written.
  void pad(std::int64_t j, std::int64_t k, std::vector<float>& padded) const {
    const auto length = size_[0];
    const float* row = in_ + row_at(j, k, 0) * length;
    std::fill_n(padded.begin(), radius_, row[0]);
    std::copy_n(row, length, padded.begin() + radius_);
    std::fill_n(padded.begin() + radius_ + length, radius_, row[length - 1]);
  }

  void convolve(std::int64_t j, std::int64_t k, const std::vector<float>& padded, float* out, std::int64_t from,
                std::int64_t to) const {
    std::fill(out + from, out + to, 0.0F);
    const auto in = [&](std::int64_t tap) {
      return from + (axis_ == 0 ? padded.data() + radius_ + tap : in_ + row_at(j, k, tap) * size_[0]);
    };
    auto tap = -radius_;
    for (; tap + 4 <= radius_ + 1; tap += 4)
      parallel::vectorised<add_four>(weights_.data() + tap + radius_, in(tap), in(tap + 1), in(tap + 2), in(tap + 3),
                                     to - from, out + from);
    for (; tap <= radius_; ++tap)
      parallel::vectorised<add_one>(weights_[static_cast<std::size_t>(tap + radius_)], in(tap), to - from, out + from);
  }

  Index3 size_;
  const float* in_;
  const Stretches& stretches_;
  std::size_t axis_;
  const std::vector<float>& weights_;
  std::int64_t radius_;
};

// `out` may be `in` along the first axis only.
void smooth_axis(const Index3& size, const float* in, Stretches& stretches, std::size_t axis,
                 const std::vector<float>& weights, float* out) {
  const AxisPass pass(size, in, stretches, axis, weights);
  Stretches smoothed{stretches.per_row, std::vector<float>(stretches.value.size())};
  parallel::parallel_for(0, size[2], [&](std::int64_t begin, std::int64_t end) {
    std::vector<float> padded(static_cast<std::size_t>(size[0]) + weights.size());
    for (auto k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < size[1]; ++j) {
        const auto row = k * size[1] + j;
        pass.smooth_row(j, k, padded, out + row * size[0], smoothed.row(row));
      }
  });
  stretches = std::move(smoothed);
}

}  // namespace

void Box::add(const Index3& at) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis] = std::min(low[axis], at[axis]);
    high[axis] = std::max(high[axis], at[axis]);
  }
}

void Spans::Span::add(std::int64_t low, std::int64_t high) {
  first = std::min(first, low);
  last = std::max(last, high);
}

Spans::Span Spans::row(std::int64_t j, std::int64_t k) const {
  const bool is_on = j >= 0 && k >= 0 && j < size[1] && k < size[2];
  return is_on ? rows[static_cast<std::size_t>(k * size[1] + j)] : Span{};
}

void Spans::add(const Box& box) {
  const auto low = [&](std::size_t axis) { return std::max<std::int64_t>(0, box.low[axis]); };
  const auto high = [&](std::size_t axis) { return std::min(size[axis] - 1, box.high[axis]); };
  for (auto k = low(2); k <= high(2); ++k)
    for (auto j = low(1); j <= high(1); ++j) rows[static_cast<std::size_t>(k * size[1] + j)].add(low(0), high(0));
}

Spans no_spans(const Index3& size) {
  return {size, std::vector<Spans::Span>(static_cast<std::size_t>(size[1] * size[2]))};
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

void smooth(Volume<float>& volume, const Kernels& kernels, std::vector<float>& scratch) {
  const auto& size = volume.grid.size;
  auto stretches = stretches_of(volume);
  scratch.resize(std::max(scratch.size(), volume.voxels.size()));
  float* own = volume.voxels.data();
  smooth_axis(size, own, stretches, 0, kernels[0], own);
  smooth_axis(size, own, stretches, 1, kernels[1], scratch.data());
  smooth_axis(size, scratch.data(), stretches, 2, kernels[2], own);
}

void smooth(Volume<float>& volume, const Kernels& kernels) {
  std::vector<float> scratch;
  smooth(volume, kernels, scratch);
}

FractionField share_field(const LabelVolume& labels, std::uint8_t label, const Box& box, const Kernels& kernels,
                          std::vector<float>& scratch) {
  FractionField field;
  field.label = label;
  Grid grid;
  grid.spacing_mm = labels.grid.spacing_mm;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto margin = radius_of(kernels[axis]) + 1;
    field.first[axis] = std::max<std::int64_t>(0, box.low[axis] - margin);
    grid.size[axis] = std::min(labels.grid.size[axis], box.high[axis] + margin + 1) - field.first[axis];
  }
  field.share = Volume<float>(grid);
  parallel::parallel_for(0, grid.size[2], [&](std::int64_t begin, std::int64_t end) {
    for (auto k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < grid.size[1]; ++j) {
        const auto* in = &labels(field.first[0], field.first[1] + j, field.first[2] + k);
        float* out = &field.share(0, j, k);
        for (std::int64_t i = 0; i < grid.size[0]; ++i) out[i] = in[i] == label ? 1.0F : 0.0F;
      }
  });
  smooth(field.share, kernels, scratch);
  return field;
}

float share_at(const FractionField& field, const Index3& voxel) {
  const Index3 at{voxel[0] - field.first[0], voxel[1] - field.first[1], voxel[2] - field.first[2]};
  return field.share.grid.contains(at[0], at[1], at[2]) ? field.share(at[0], at[1], at[2]) : 0.0F;
}

Index3 reach_of(const Kernels& kernels) {
  return {radius_of(kernels[0]), radius_of(kernels[1]), radius_of(kernels[2])};
}

void add_kernel(FractionField& field, const Index3& voxel, float amount, const Kernels& kernels) {
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

}  // namespace heartgen::mesh
