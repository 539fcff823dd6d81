// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/image/distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "generator/parallel/threads.hpp"
#include "model/contract.hpp"

namespace heartgen::image {
namespace {

constexpr float unreached = std::numeric_limits<float>::infinity();
constexpr std::size_t lines_per_block = 16;

/// Squared distances (mm^2) and, where `tag` is not empty, the tag of the nearest site. Distances above the limit do
/// not matter: sites that far along one axis are left out on the next, which spares most of the work for small limits.
struct Field {
  double limit_mm2 = std::numeric_limits<double>::infinity();
  std::vector<float> squared;
  std::vector<std::uint8_t> tag;
};

/// One line on its way through an envelope, and the envelope's scratch space.
struct Line {
  explicit Line(std::size_t n) : value(n), result(n), tag(n), tag_result(n), site(n), start(n + 1) {}
  std::vector<float> value, result;
  std::vector<std::uint8_t> tag, tag_result;
  std::vector<std::size_t> site;
  std::vector<double> start;
};

/// Where the parabola rooted at `q` gets below the one rooted at `p` < `q`, in steps along the line.
double crossing(const std::vector<float>& value, std::size_t p, std::size_t q, double step2) {
  const auto a = static_cast<double>(p);
  const auto b = static_cast<double>(q);
  return (static_cast<double>(value[q] - value[p]) / step2 + (b * b - a * a)) / (2 * (b - a));
}

/// Distances along the first axis, where every value is 0 or unreached: to the last site and to the next one.
void scan_row(float* squared, std::uint8_t* tag, std::size_t n, double step2) {
  std::size_t next = 0;
  std::size_t last = n;  // none yet
  for (std::size_t x = 0; x < n; ++x) {
    if (squared[x] == 0) {
      last = x;
      continue;
    }
    if (next <= x)
      for (next = x + 1; next < n && squared[next] != 0;) ++next;
    const bool use_last = last < n && (next == n || x - last <= next - x);
    if (!use_last && next == n) return;  // no site in this row
    const auto offset = static_cast<double>(use_last ? x - last : next - x);
    squared[x] = static_cast<float>(step2 * offset * offset);
    if (tag) tag[x] = tag[use_last ? last : next];
  }
}

/// result[x] = min over q of value[q] + step2 (x - q)^2, with the tag of that q. A line without sites stays as it is.
/// Between two sites of value 0 a third such one is the nearest of nothing but itself, and is left out.
void lower_envelope(Line& line, double step2) {
  const std::size_t n = line.value.size();
  const auto is_zero = [&](std::size_t q) { return line.value[q] == 0; };
  std::size_t count = 0;
  for (std::size_t q = 0; q < n; ++q) {
    if (line.value[q] == unreached) continue;
    if (is_zero(q) && q > 0 && q + 1 < n && is_zero(q - 1) && is_zero(q + 1)) continue;
    double at = -std::numeric_limits<double>::infinity();
    while (count > 0) {
      at = crossing(line.value, line.site[count - 1], q, step2);
      if (at > line.start[count - 1]) break;
      --count;
    }
    if (count == 0) at = -std::numeric_limits<double>::infinity();
    line.site[count] = q;
    line.start[count++] = at;
  }
  if (count == 0) {
    line.result = line.value;
    line.tag_result = line.tag;
    return;
  }
  line.start[count] = std::numeric_limits<double>::infinity();
  std::size_t k = 0;
  for (std::size_t x = 0; x < n; ++x) {
    if (is_zero(x)) {
      line.result[x] = 0;
      line.tag_result[x] = line.tag[x];
      continue;
    }
    while (line.start[k + 1] < static_cast<double>(x)) ++k;
    const double offset = static_cast<double>(x) - static_cast<double>(line.site[k]);
    line.result[x] = static_cast<float>(static_cast<double>(line.value[line.site[k]]) + step2 * offset * offset);
    line.tag_result[x] = line.tag[line.site[k]];
  }
}

/// The lines that start at the `width` neighbouring voxels from `base` on. Fetched together: a cache line holds
/// sixteen neighbours, whose lines would each read it again otherwise.
void sweep_block(Field& field, std::size_t base, std::size_t width, std::size_t stride, double step2,
                 std::vector<Line>& lines) {
  const std::size_t length = lines[0].value.size();
  const bool tags = !field.tag.empty();
  for (std::size_t n = 0; n < length; ++n)
    for (std::size_t b = 0; b < width; ++b) {
      const float value = field.squared[base + n * stride + b];
      lines[b].value[n] = static_cast<double>(value) <= field.limit_mm2 ? value : unreached;
      if (tags) lines[b].tag[n] = field.tag[base + n * stride + b];
    }
  for (std::size_t b = 0; b < width; ++b) lower_envelope(lines[b], step2);
  for (std::size_t n = 0; n < length; ++n)
    for (std::size_t b = 0; b < width; ++b) {
      field.squared[base + n * stride + b] = lines[b].result[n];
      if (tags) field.tag[base + n * stride + b] = lines[b].tag_result[n];
    }
}

void sweep_rows(Field& field, const Grid& grid) {
  const auto nx = static_cast<std::size_t>(grid.size[0]);
  const double step2 = grid.spacing_mm.x * grid.spacing_mm.x;
  parallel::parallel_for(0, grid.size[1] * grid.size[2], [&](std::int64_t first, std::int64_t last) {
    for (auto row = static_cast<std::size_t>(first); row < static_cast<std::size_t>(last); ++row)
      scan_row(field.squared.data() + row * nx, field.tag.empty() ? nullptr : field.tag.data() + row * nx, nx, step2);
  });
}

/// Envelopes along the second or third axis.
void sweep(Field& field, const Grid& grid, int axis) {
  const auto nx = static_cast<std::size_t>(grid.size[0]);
  const auto ny = static_cast<std::size_t>(grid.size[1]);
  const auto length = static_cast<std::size_t>(grid.size[static_cast<std::size_t>(axis)]);
  const double step2 = grid.spacing_mm[axis] * grid.spacing_mm[axis];
  const std::size_t stride = axis == 1 ? nx : nx * ny;
  const std::size_t task_stride = axis == 1 ? nx * ny : nx;  // a task is a slice of constant k, or of constant j
  const std::int64_t tasks = axis == 1 ? grid.size[2] : grid.size[1];
  parallel::parallel_for(0, tasks, [&](std::int64_t first, std::int64_t last) {
    std::vector<Line> lines(lines_per_block, Line(length));
    for (auto task = static_cast<std::size_t>(first); task < static_cast<std::size_t>(last); ++task)
      for (std::size_t i = 0; i < nx; i += lines_per_block)
        sweep_block(field, task * task_stride + i, std::min(lines_per_block, nx - i), stride, step2, lines);
  });
}

void transform(Field& field, const Grid& grid) {
  sweep_rows(field, grid);
  for (int axis = 1; axis < 3; ++axis)
    if (grid.size[static_cast<std::size_t>(axis)] > 1) sweep(field, grid, axis);
}

Field sites(const Mask& mask, bool set, double limit_mm) {
  Field field;
  field.limit_mm2 = limit_mm * limit_mm;
  field.squared.resize(mask.voxels.size());
  for (std::size_t v = 0; v < mask.voxels.size(); ++v) field.squared[v] = (mask.voxels[v] != 0) == set ? 0 : unreached;
  return field;
}

}  // namespace

Volume<float> distance_to(const Mask& mask, float far_mm) {
  Field field = sites(mask, true, static_cast<double>(far_mm));
  transform(field, mask.grid);
  for (float& value : field.squared) value = std::min(std::sqrt(value), far_mm);
  Volume<float> result;
  result.grid = mask.grid;
  result.voxels = std::move(field.squared);
  return result;
}

LevelSet signed_distance(const Mask& mask) {
  constexpr float far_mm = 1e6F;
  const Vec3& spacing = mask.grid.spacing_mm;
  const auto half = static_cast<float>(std::min({spacing.x, spacing.y, spacing.z}) / 2);
  LevelSet result = distance_to(mask, far_mm);
  Field inside = sites(mask, false, static_cast<double>(far_mm));
  transform(inside, mask.grid);
  for (std::size_t v = 0; v < result.voxels.size(); ++v) {
    float& value = result.voxels[v];
    value = value > 0 ? value - half : half - std::min(std::sqrt(inside.squared[v]), far_mm);
  }
  return result;
}

LabelVolume nearest_label(const LabelVolume& labels, double limit_mm) {
  HEARTGEN_EXPECTS(limit_mm >= 0);
  Field field = sites(labels, true, limit_mm);
  field.tag = labels.voxels;
  transform(field, labels.grid);
  LabelVolume result(labels.grid);
  for (std::size_t v = 0; v < field.tag.size(); ++v)
    if (static_cast<double>(field.squared[v]) <= field.limit_mm2) result.voxels[v] = field.tag[v];
  return result;
}

NearestLabel nearest_label_and_distance(const LabelVolume& labels) {
  Field field = sites(labels, true, std::numeric_limits<double>::infinity());
  field.tag = labels.voxels;
  transform(field, labels.grid);
  NearestLabel result;
  result.label.grid = result.distance_mm.grid = labels.grid;
  for (float& value : field.squared) value = std::min(std::sqrt(value), 1e6F);
  result.label.voxels = std::move(field.tag);
  result.distance_mm.voxels = std::move(field.squared);
  return result;
}

}  // namespace heartgen::image
