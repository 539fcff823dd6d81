// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/naming/levels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "generator/chest/working_image.hpp"
#include "generator/image/distance.hpp"
#include "generator/naming/priors.hpp"
#include "model/mathematics.hpp"
#include "model/quantile.hpp"

namespace heartgen::naming {
namespace {

std::vector<double> smoothed(const std::vector<double>& counts, double sigma) {
  const auto half = static_cast<std::ptrdiff_t>(std::ceil(4 * sigma)), last = std::ssize(counts) - 1;
  std::vector<double> kernel;
  double weight = 0;
  for (std::ptrdiff_t n = -half; n <= half; ++n) {
    kernel.push_back(math::exp(-0.5 * static_cast<double>(n * n) / (sigma * sigma)));
    weight += kernel.back();
  }
  std::vector<double> result(counts.size());
  for (std::ptrdiff_t at = 0; at <= last; ++at) {
    double sum = 0;
    for (std::ptrdiff_t n = -half; n <= half; ++n)
      sum += kernel[static_cast<std::size_t>(n + half)] *
             counts[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(at + n, 0, last))];
    result[static_cast<std::size_t>(at)] = sum / weight;
  }
  return result;
}

/// Counts of whole HU from `lowest` on; what lies outside is left out.
std::vector<double> histogram(const std::vector<float>& values, int lowest, int highest) {
  std::vector<double> counts(static_cast<std::size_t>(highest - lowest + 1), 0);
  for (const float value : values) {
    const int hu = static_cast<int>(std::floor(value));
    if (hu >= lowest && hu <= highest) counts[static_cast<std::size_t>(hu - lowest)] += 1;
  }
  return counts;
}

/// The most frequent value between the limits; the median where none stands out; none without values.
std::optional<double> mode(const std::vector<float>& values, int lowest, int highest) {
  constexpr double width_hu = 6, stands_out = 1.8;
  std::vector<float> within;
  for (const float v : values)
    if (v > static_cast<float>(lowest) && v < static_cast<float>(highest)) within.push_back(v);
  if (within.empty()) return std::nullopt;
  const auto counts = smoothed(histogram(within, lowest, highest), width_hu);
  const auto top = std::max_element(counts.begin(), counts.end());
  const double mean = static_cast<double>(within.size()) / static_cast<double>(counts.size());
  if (*top > stands_out * mean) return lowest + static_cast<double>(top - counts.begin());
  return static_cast<double>(upper_median(within));
}

/// Smoothed values around the brightest blood, where its muscle is.
std::vector<float> around_blood(const Volume<float>& smooth, const Mask& room, double bright_hu) {
  const auto& grid = smooth.grid;
  const Mask bright = chest::mask_where(grid, [&](const Vec3&, std::size_t v) {
    return room.voxels[v] != 0 && static_cast<double>(smooth.voxels[v]) > bright_hu;
  });
  const auto depth = chest::depth_of(bright);
  const auto core = image::distance_to(chest::mask_where(
      grid, [&](const Vec3&, std::size_t v) { return static_cast<double>(depth.voxels[v]) > core_mm; }));
  const auto outside = image::distance_to(chest::mask_where(
      grid, [&](const Vec3&, std::size_t v) { return static_cast<double>(core.voxels[v]) <= core_mm; }));
  std::vector<float> shell;
  for (std::size_t v = 0; v < smooth.voxels.size(); ++v) {
    const auto distance = static_cast<double>(outside.voxels[v]);
    if (distance > wall_from_mm && distance < wall_to_mm && room.voxels[v] && !bright.voxels[v])
      shell.push_back(smooth.voxels[v]);
  }
  return shell;
}

struct Window {
  int from = 0, to = 0;  ///< HU above muscle
};

/// The lowest valley, for what is hardly brighter than muscle.
std::optional<int> first_valley(const std::vector<double>& counts, const Window& window, int zero) {
  for (int hu = window.from + 1; hu < window.to; ++hu) {
    const auto at = static_cast<std::size_t>(zero + hu);
    if (counts[at] <= counts[at - 1] && counts[at] < counts[at + 1]) return hu;
  }
  return std::nullopt;
}

/// The middle of the longest stretch that is as empty as it gets.
double emptiest(const std::vector<double>& counts, const Window& window, int zero) {
  constexpr double nearly = 0.02;
  const auto first = counts.begin() + zero + window.from, end = counts.begin() + zero + window.to + 1;
  const double limit = *std::min_element(first, end) + nearly * *std::max_element(first, end);
  double middle = window.from, longest = 0;
  for (auto from = first; from < end;) {
    if (*from > limit) {
      ++from;
      continue;
    }
    auto to = from;
    while (to < end && *to <= limit) ++to;
    if (const auto length = static_cast<double>(to - from); length > longest) {
      longest = length;
      middle = window.from + static_cast<double>(from - first) + 0.5 * (length - 1);
    }
    from = to;
  }
  return middle;
}

}  // namespace

bool Levels::has_contrast() const { return deep_ml >= min_deep_ml; }

Levels find_levels(const Volume<float>& smooth, const Mask& room) {
  const Mask enhanced = chest::mask_where(smooth.grid, [&](const Vec3&, std::size_t v) {
    return room.voxels[v] != 0 && static_cast<double>(smooth.voxels[v]) > enhanced_hu;
  });
  const auto depth = chest::depth_of(enhanced);
  std::vector<float> deep, mixed;
  for (std::size_t v = 0; v < smooth.voxels.size(); ++v) {
    if (static_cast<double>(depth.voxels[v]) <= deep_mm) continue;
    deep.push_back(smooth.voxels[v]);
    if (static_cast<double>(smooth.voxels[v]) < undiluted_hu) mixed.push_back(smooth.voxels[v]);
  }
  Levels levels;
  levels.deep_ml = static_cast<double>(deep.size()) * smooth.grid.voxel_volume_mm3() / 1000;
  if (!levels.has_contrast()) return levels;
  levels.blood_hu = static_cast<double>(upper_median(mixed.empty() ? deep : mixed));
  const double between = 0.5 * (levels.blood_hu + soft_tissue_hu);
  constexpr int darkest_muscle_hu = 20;
  levels.muscle_hu = mode(around_blood(smooth, room, between), darkest_muscle_hu,
                          static_cast<int>(std::min(brightest_muscle_hu, between)))
                         .value_or(soft_tissue_hu);
  return levels;
}

std::vector<double> thresholds(const std::vector<float>& flat, const Levels& levels, double noise_hu) {
  constexpr int below_muscle = 40;
  constexpr double share_of_noise = 0.3, least_hu = 14, least_from_hu = 8, lowest_window = 0.14;
  const double contrast = levels.contrast_hu();
  const int muscle = static_cast<int>(std::lround(levels.muscle_hu));
  const int zero = below_muscle, highest = static_cast<int>(std::max(contrast + 1, 81.0));
  const auto counts = smoothed(histogram(flat, muscle - zero, muscle + highest), std::max(3.0, 0.1 * noise_hu));
  const double least_to = std::max(least_hu, share_of_noise * noise_hu);
  std::vector<double> result;
  for (const auto& [from, to] : {std::pair{.32, .55}, {lowest_window, .32}, {0.0, lowest_window}}) {
    const Window window{static_cast<int>(std::max(from * contrast, least_from_hu)),
                        std::min(static_cast<int>(std::max(to * contrast, least_to)), highest - 1)};
    if (window.to <= window.from) continue;
    const bool is_lowest = from == 0;
    const auto valley = is_lowest ? first_valley(counts, window, zero) : std::nullopt;
    const double above = valley ? *valley : emptiest(counts, window, zero);
    const double level = levels.muscle_hu + above;
    if (result.empty() || level < result.back() - 1) result.push_back(level);
  }
  return result;
}

}  // namespace heartgen::naming
