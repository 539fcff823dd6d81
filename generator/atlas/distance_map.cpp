#include "generator/atlas/distance_map.hpp"

#include <cmath>
#include <limits>

#include "generator/parallel/threads.hpp"

namespace heart::atlas {
namespace {

constexpr float far_away = 1e9F;

/// Start offset and stride of line `line` along `axis`.
struct Line {
  std::int64_t start, stride, length;
};

std::int64_t line_count(const Grid& grid, int axis) {
  return grid.voxel_count() / grid.size[static_cast<std::size_t>(axis)];
}

Line line_along(const Grid& grid, int axis, std::int64_t line) {
  const auto nx = grid.size[0], ny = grid.size[1], nz = grid.size[2];
  if (axis == 0) return {line * nx, 1, nx};
  if (axis == 1) return {(line / nx) * nx * ny + line % nx, nx, ny};
  return {line, nx * ny, nz};
}

template <class PerLine>
void for_each_line(Volume<float>& volume, int axis, PerLine&& per_line) {
  parallel::parallel_for(0, line_count(volume.grid, axis), [&](std::int64_t begin, std::int64_t end) {
    std::vector<float> in, out;
    for (std::int64_t n = begin; n < end; ++n) {
      const Line line = line_along(volume.grid, axis, n);
      in.resize(static_cast<std::size_t>(line.length));
      out.resize(in.size());
      for (std::size_t i = 0; i < in.size(); ++i)
        in[i] = volume.voxels[static_cast<std::size_t>(line.start + static_cast<std::int64_t>(i) * line.stride)];
      per_line(in, out);
      for (std::size_t i = 0; i < in.size(); ++i)
        volume.voxels[static_cast<std::size_t>(line.start + static_cast<std::int64_t>(i) * line.stride)] = out[i];
    }
  });
}

/// Lower envelope of the parabolas f(q) + (p - q)^2.
void squared_distance_line(const std::vector<float>& f, std::vector<float>& d, std::vector<int>& vertex,
                           std::vector<double>& bound) {
  const int n = static_cast<int>(f.size());
  vertex.assign(f.size(), 0);
  bound.assign(f.size() + 1, 0);
  int last = -1;
  const auto value = [&](int q) { return static_cast<double>(f[static_cast<std::size_t>(q)]); };
  for (int q = 0; q < n; ++q) {
    if (value(q) >= far_away) continue;
    double cut = -std::numeric_limits<double>::infinity();
    while (last >= 0) {
      const int v = vertex[static_cast<std::size_t>(last)];
      cut = ((value(q) + static_cast<double>(q) * q) - (value(v) + static_cast<double>(v) * v)) / (2.0 * (q - v));
      if (cut > bound[static_cast<std::size_t>(last)]) break;
      --last;
      cut = -std::numeric_limits<double>::infinity();
    }
    vertex[static_cast<std::size_t>(++last)] = q;
    bound[static_cast<std::size_t>(last)] = cut;
  }
  for (int p = 0, at = 0; p < n; ++p) {
    if (last < 0) {
      d[static_cast<std::size_t>(p)] = far_away;
      continue;
    }
    while (at < last && bound[static_cast<std::size_t>(at + 1)] < p) ++at;
    const int v = vertex[static_cast<std::size_t>(at)];
    d[static_cast<std::size_t>(p)] = static_cast<float>(value(v) + static_cast<double>(p - v) * (p - v));
  }
}

std::vector<double> gaussian_weights(double sigma) {
  const int radius = std::max(1, static_cast<int>(std::ceil(4 * sigma)));
  std::vector<double> weights(static_cast<std::size_t>(radius) + 1);
  double sum = 0;
  for (int i = 0; i <= radius; ++i) {
    weights[static_cast<std::size_t>(i)] = std::exp(-0.5 * i * i / (sigma * sigma));
    sum += (i ? 2 : 1) * weights[static_cast<std::size_t>(i)];
  }
  for (double& w : weights) w /= sum;
  return weights;
}

}  // namespace

Volume<float> distance_to(const Mask& mask) {
  Volume<float> result(mask.grid, far_away);
  for (std::size_t v = 0; v < mask.voxels.size(); ++v)
    if (mask.voxels[v]) result.voxels[v] = 0;
  for (int axis = 0; axis < 3; ++axis)
    for_each_line(result, axis, [](const std::vector<float>& in, std::vector<float>& out) {
      thread_local std::vector<int> vertex;
      thread_local std::vector<double> bound;
      squared_distance_line(in, out, vertex, bound);
    });
  const auto spacing = static_cast<float>(mask.grid.spacing_mm.x);
  for (float& d : result.voxels) d = d >= far_away ? far_away : spacing * std::sqrt(d);
  return result;
}

Volume<float> smoothed(const Volume<float>& volume, double sigma_voxels) {
  Volume<float> result = volume;
  if (sigma_voxels <= 0) return result;
  const auto weights = gaussian_weights(sigma_voxels);
  const auto radius = static_cast<std::ptrdiff_t>(weights.size()) - 1;
  for (int axis = 0; axis < 3; ++axis)
    for_each_line(result, axis, [&](const std::vector<float>& in, std::vector<float>& out) {
      const auto last = static_cast<std::ptrdiff_t>(in.size()) - 1;
      for (std::ptrdiff_t p = 0; p <= last; ++p) {
        double sum = weights[0] * in[static_cast<std::size_t>(p)];
        for (std::ptrdiff_t r = 1; r <= radius; ++r)
          sum +=
              weights[static_cast<std::size_t>(r)] * (in[static_cast<std::size_t>(std::max<std::ptrdiff_t>(p - r, 0))] +
                                                      in[static_cast<std::size_t>(std::min(p + r, last))]);
        out[static_cast<std::size_t>(p)] = static_cast<float>(sum);
      }
    });
  return result;
}

LevelSet signed_distance(const Mask& mask, double sigma_voxels) {
  Mask complement(mask.grid);
  for (std::size_t v = 0; v < mask.voxels.size(); ++v) complement.voxels[v] = mask.voxels[v] ? 0 : 1;
  LevelSet outside = distance_to(mask);
  const auto inside = distance_to(complement);
  const auto half = static_cast<float>(mask.grid.spacing_mm.x / 2);
  for (std::size_t v = 0; v < mask.voxels.size(); ++v)
    outside.voxels[v] = mask.voxels[v] ? half - inside.voxels[v] : outside.voxels[v] - half;
  if (sigma_voxels <= 0) return outside;
  // A Gaussian moves a surface of mean curvature H by sigma^2 H; 2 G - G^2 does not, to second order.
  LevelSet once = smoothed(outside, sigma_voxels);
  const LevelSet twice = smoothed(once, sigma_voxels);
  for (std::size_t v = 0; v < once.voxels.size(); ++v) once.voxels[v] = 2 * once.voxels[v] - twice.voxels[v];
  return once;
}

Mask mask_where(const Volume<std::uint8_t>& volume, const std::function<bool(std::uint8_t)>& inside) {
  std::array<std::uint8_t, 256> table{};
  for (int value = 0; value < 256; ++value)
    table[static_cast<std::size_t>(value)] = inside(static_cast<std::uint8_t>(value));
  Mask mask(volume.grid);
  for (std::size_t v = 0; v < volume.voxels.size(); ++v) mask.voxels[v] = table[volume.voxels[v]];
  return mask;
}

Vec3 gradient_at(const Volume<float>& volume, std::int64_t i, std::int64_t j, std::int64_t k) {
  Vec3 gradient;
  const std::array<std::int64_t, 3> at{i, j, k};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    auto low = at, high = at;
    low[axis] = std::max<std::int64_t>(at[axis] - 1, 0);
    high[axis] = std::min(at[axis] + 1, volume.grid.size[axis] - 1);
    const auto steps = static_cast<double>(high[axis] - low[axis]);
    if (steps > 0)
      gradient[static_cast<int>(axis)] = (volume(high[0], high[1], high[2]) - volume(low[0], low[1], low[2])) /
                                         (steps * volume.grid.spacing_mm[static_cast<int>(axis)]);
  }
  return gradient;
}

}  // namespace heart::atlas
