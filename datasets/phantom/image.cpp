// SPDX-License-Identifier: GPL-3.0-or-later
#include "datasets/phantom/image.hpp"

#include <algorithm>
#include <cmath>

#include "generator/parallel/threads.hpp"
#include "model/mathematics.hpp"

namespace heartgen::phantom {
namespace {

/// Calls body(k) for every slice; slices are dealt out in turn because those through the heart cost the most.
template <class Body>
void for_each_slice(const Grid& grid, const Body& body) {
  constexpr std::int64_t hands = 16;
  std::vector<std::int64_t> order;
  for (std::int64_t hand = 0; hand < hands; ++hand)
    for (std::int64_t k = hand; k < grid.size[2]; k += hands) order.push_back(k);
  parallel::parallel_for(0, static_cast<std::int64_t>(order.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto i = begin; i < end; ++i) body(order[static_cast<std::size_t>(i)]);
  });
}

/// Whether a voxel has a neighbour of another grey value.
bool is_mixed(const Volume<std::uint8_t>& tissues, const std::array<float, tissue_count>& grey, std::int64_t i,
              std::int64_t j, std::int64_t k) {
  const auto& size = tissues.grid.size;
  const float own = grey[tissues(i, j, k)];
  for (std::int64_t c = std::max<std::int64_t>(k - 1, 0); c <= std::min(k + 1, size[2] - 1); ++c)
    for (std::int64_t b = std::max<std::int64_t>(j - 1, 0); b <= std::min(j + 1, size[1] - 1); ++b)
      for (std::int64_t a = std::max<std::int64_t>(i - 1, 0); a <= std::min(i + 1, size[0] - 1); ++a)
        if (grey[tissues(a, b, c)] != own) return true;
  return false;
}

float mean_grey(const Anatomy& anatomy, const Grid& grid, const Vec3& index,
                const std::array<float, tissue_count>& grey) {
  float sum = 0;
  for (int part = 0; part < 8; ++part) {
    const Vec3 shift{0.5 * (part & 1) - 0.25, 0.5 * ((part >> 1) & 1) - 0.25, 0.5 * (part >> 2) - 0.25};
    sum += grey[static_cast<std::size_t>(sample_at(anatomy, lps_from_index(grid, index + shift)).tissue)];
  }
  return sum / 8;
}

/// Random values on a lattice of cubes, interpolated linearly; in [-1, 1].
double lattice_noise(std::uint64_t key, const Vec3& p) {
  const Vec3 low{std::floor(p.x), std::floor(p.y), std::floor(p.z)}, t = p - low;
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const int a = corner & 1, b = (corner >> 1) & 1, c = corner >> 2;
    const auto coordinate = [](double x) {
      return static_cast<std::uint64_t>(static_cast<std::int64_t>(x) + 4096) & 8191;
    };
    const auto id = (coordinate(low.x + a) << 26) | (coordinate(low.y + b) << 13) | coordinate(low.z + c);
    sum += (a ? t.x : 1 - t.x) * (b ? t.y : 1 - t.y) * (c ? t.z : 1 - t.z) * random_symmetric(key, id);
  }
  return sum;
}

std::vector<float> gaussian_weights(double sigma_voxels) {
  const int radius = static_cast<int>(std::ceil(3 * sigma_voxels));
  std::vector<float> weights;
  double sum = 0;
  for (int i = -radius; i <= radius; ++i) sum += math::exp(-0.5 * i * i / (sigma_voxels * sigma_voxels));
  for (int i = -radius; i <= radius; ++i)
    weights.push_back(static_cast<float>(math::exp(-0.5 * i * i / (sigma_voxels * sigma_voxels)) / sum));
  return weights;
}

void blur_axis(Volume<float>& volume, int axis, const std::vector<float>& weights) {
  const Volume<float> source = volume;
  const auto& size = volume.grid.size;
  const auto radius = static_cast<std::int64_t>(weights.size() / 2);
  const std::int64_t stride = axis == 0 ? 1 : axis == 1 ? size[0] : size[0] * size[1];
  const auto last = size[static_cast<std::size_t>(axis)] - 1;
  parallel::parallel_for(0, size[2], [&](std::int64_t begin, std::int64_t end) {
    for (auto k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < size[1]; ++j)
        for (std::int64_t i = 0; i < size[0]; ++i) {
          const auto here = axis == 0 ? i : axis == 1 ? j : k;
          const auto offset = volume.grid.offset(i, j, k);
          float sum = 0;
          for (auto d = -radius; d <= radius; ++d)
            sum += weights[static_cast<std::size_t>(d + radius)] *
                   source.voxels[static_cast<std::size_t>(
                       offset + (std::clamp<std::int64_t>(here + d, 0, last) - here) * stride)];
          volume.voxels[static_cast<std::size_t>(offset)] = sum;
        }
  });
}

}  // namespace

SampledVolume sample_volume(const Anatomy& anatomy, const Grid& grid) {
  SampledVolume samples{LabelVolume(grid), Volume<std::uint8_t>(grid)};
  for_each_slice(grid, [&](std::int64_t k) {
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i) {
        const Vec3 index{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
        const Sample sample = sample_at(anatomy, lps_from_index(grid, index));
        samples.regions(i, j, k) = tag(sample.region);
        samples.tissues(i, j, k) = static_cast<std::uint8_t>(sample.tissue);
      }
  });
  return samples;
}

Volume<float> grey_volume(const Anatomy& anatomy, const SampledVolume& samples,
                          const std::array<float, tissue_count>& grey_of_tissue) {
  const Grid& grid = samples.tissues.grid;
  Volume<float> volume(grid);
  for_each_slice(grid, [&](std::int64_t k) {
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i) {
        const Vec3 index{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
        volume(i, j, k) = is_mixed(samples.tissues, grey_of_tissue, i, j, k)
                              ? mean_grey(anatomy, grid, index, grey_of_tissue)
                              : grey_of_tissue[samples.tissues(i, j, k)];
      }
  });
  return volume;
}

void add_texture(Volume<float>& volume, const Volume<std::uint8_t>& tissues,
                 const std::array<float, tissue_count>& amplitude_of_tissue, std::uint64_t key) {
  constexpr double grain_mm = 5;
  const Grid& grid = volume.grid;
  for_each_slice(grid, [&](std::int64_t k) {
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i) {
        const float amplitude = amplitude_of_tissue[tissues(i, j, k)];
        if (amplitude == 0) continue;
        const Vec3 p = lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        volume(i, j, k) += amplitude * static_cast<float>(lattice_noise(key, p / grain_mm));
      }
  });
}

void blur(Volume<float>& volume, double sigma_mm) {
  if (sigma_mm <= 0) return;
  for (int axis = 0; axis < 3; ++axis) {
    const double sigma = sigma_mm / volume.grid.spacing_mm[axis];
    if (sigma > 0.15) blur_axis(volume, axis, gaussian_weights(sigma));
  }
}

void add_noise(Volume<float>& volume, double sigma, std::uint64_t key) {
  if (sigma <= 0) return;
  constexpr float side = 0.35f;  // weight of the neighbours in x and y
  const float norm = static_cast<float>(sigma) / (1 + 2 * side * side);
  const auto nx = volume.grid.size[0], ny = volume.grid.size[1];
  for_each_slice(volume.grid, [&](std::int64_t k) {
    std::vector<float> white(static_cast<std::size_t>((nx + 2) * (ny + 2)));
    const auto first = static_cast<std::uint64_t>(k * (nx + 2) * (ny + 2));
    for (std::size_t n = 0; n < white.size(); ++n) white[n] = random_normal(key, first + n);
    const auto row = [&](std::int64_t i, std::int64_t j) {
      const float* w = white.data() + j * (nx + 2) + i;
      return w[1] + side * (w[0] + w[2]);
    };
    for (std::int64_t j = 0; j < ny; ++j)
      for (std::int64_t i = 0; i < nx; ++i)
        volume(i, j, k) += norm * (row(i, j + 1) + side * (row(i, j) + row(i, j + 2)));
  });
}

CtVolume rounded(const Volume<float>& volume, float lowest, float highest) {
  CtVolume result(volume.grid);
  for (std::size_t n = 0; n < volume.voxels.size(); ++n)
    result.voxels[n] = static_cast<std::int16_t>(std::floor(std::clamp(volume.voxels[n], lowest, highest) + 0.5f));
  return result;
}

}  // namespace heartgen::phantom
