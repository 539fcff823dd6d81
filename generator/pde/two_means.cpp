// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/two_means.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "generator/pde/median.hpp"

namespace heartgen::pde {
namespace {

using parallel::Comm;
using parallel::Slab;

constexpr std::size_t bins = 8192;
constexpr int refinements = 20;

struct Range {
  double low = 0, high = 0;
};

Range grey_range(const Slab<float>& image, const Slab<std::uint8_t>& domain, const Comm& comm) {
  const auto g = image.owned();
  const auto d = domain.owned();
  float low = std::numeric_limits<float>::infinity(), high = -low;
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (!d[i]) continue;
    low = std::min(low, g[i]);
    high = std::max(high, g[i]);
  }
  return {parallel::min(comm, low), parallel::max(comm, high)};
}

std::vector<std::int64_t> grey_histogram(const Slab<float>& image, const Slab<std::uint8_t>& domain, const Range& range,
                                         const Comm& comm) {
  const auto g = image.owned();
  const auto d = domain.owned();
  const double scale = static_cast<double>(bins - 1) / (range.high - range.low);
  std::vector<std::int64_t> histogram(bins, 0);
  for (std::size_t i = 0; i < g.size(); ++i)
    if (d[i]) ++histogram[static_cast<std::size_t>(std::lround((double{g[i]} - range.low) * scale))];
  parallel::sum_int64(comm, histogram);
  return histogram;
}

/// Exact running sums over a histogram whose values are the bin numbers.
struct RunningSums {
  std::vector<std::int64_t> count, sum, squares;  ///< over the bins below index b, b = 0 .. bins

  explicit RunningSums(const std::vector<std::int64_t>& histogram)
      : count(histogram.size() + 1, 0), sum(count), squares(count) {
    for (std::size_t b = 0; b < histogram.size(); ++b) {
      const auto value = static_cast<std::int64_t>(b);
      count[b + 1] = count[b] + histogram[b];
      sum[b + 1] = sum[b] + histogram[b] * value;
      squares[b + 1] = squares[b] + histogram[b] * value * value;
    }
  }

  /// Bin of the lower median of the bins [from, to).
  std::size_t median(std::size_t from, std::size_t to) const {
    const auto rank = count[from] + (count[to] - count[from] - 1) / 2;
    const auto found = std::upper_bound(count.begin(), count.end(), rank);
    return static_cast<std::size_t>(found - count.begin()) - 1;
  }

  /// Sum of distances (L1) or squared distances (L2) to the best value of a class.
  double cost(Norm norm, std::size_t from, std::size_t to) const {
    const auto n = count[to] - count[from];
    if (n == 0) return 0;
    if (norm == Norm::l2) {
      const auto s = static_cast<double>(sum[to] - sum[from]);
      return static_cast<double>(squares[to] - squares[from]) - s * s / static_cast<double>(n);
    }
    const auto middle = median(from, to);
    const auto value = static_cast<std::int64_t>(middle);
    const auto below = value * (count[middle] - count[from]) - (sum[middle] - sum[from]);
    const auto above = (sum[to] - sum[middle]) - value * (count[to] - count[middle]);
    return static_cast<double>(below + above);
  }

  double center(Norm norm, std::size_t from, std::size_t to) const {
    if (norm == Norm::l1) return static_cast<double>(median(from, to));
    return static_cast<double>(sum[to] - sum[from]) / static_cast<double>(count[to] - count[from]);
  }
};

TwoClasses best_split(const std::vector<std::int64_t>& histogram, const Range& range, Norm norm) {
  const RunningSums sums(histogram);
  std::size_t best = 1;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t split = 1; split < bins; ++split) {
    if (sums.count[split] == sums.count[split - 1]) continue;  // an empty bin changes nothing
    const double cost = sums.cost(norm, 0, split) + sums.cost(norm, split, bins);
    if (cost < least) {
      least = cost;
      best = split;
    }
  }
  const double width = (range.high - range.low) / static_cast<double>(bins - 1);
  return {range.low + width * sums.center(norm, 0, best), range.low + width * sums.center(norm, best, bins)};
}

double mean(const Slab<float>& image, const Slab<std::uint8_t>& sides, Side side, double otherwise, const Comm& comm) {
  const auto nx = image.grid.size[0];
  const auto over_rows = [&](auto&& term) {
    return parallel::sum_rows(image, comm, [&](std::int64_t j, std::int64_t k) {
      const float* g = image.row(j, k);
      const std::uint8_t* s = sides.row(j, k);
      double sum = 0;
      for (std::int64_t i = 0; i < nx; ++i)
        if (s[i] == side) sum += term(g[i]);
      return sum;
    });
  };
  const double count = over_rows([](float) { return 1.0; });
  return count == 0 ? otherwise : over_rows([](float g) { return double{g}; }) / count;
}

}  // namespace

TwoClasses side_values(const Slab<float>& image, const Slab<std::uint8_t>& sides, Norm norm, const TwoClasses& before,
                       const Comm& comm) {
  if (norm == Norm::l2)
    return {mean(image, sides, side_below, before.c_below, comm), mean(image, sides, side_above, before.c_above, comm)};
  const std::uint8_t labels[] = {side_below, side_above};
  const auto found = medians(image, sides, labels, comm);
  return {found[0] ? *found[0] : before.c_below, found[1] ? *found[1] : before.c_above};
}

void divide(const Slab<float>& image, const Slab<std::uint8_t>& domain, const TwoClasses& classes,
            Slab<std::uint8_t>& sides) {
  const double threshold = (classes.c_below + classes.c_above) / 2;
  const auto nx = image.grid.size[0];
  parallel::for_rows(image, [&](std::int64_t j, std::int64_t k) {
    const float* g = image.row(j, k);
    const std::uint8_t* d = domain.row(j, k);
    std::uint8_t* side = sides.row(j, k);
    for (std::int64_t i = 0; i < nx; ++i) side[i] = !d[i] ? side_none : g[i] > threshold ? side_above : side_below;
  });
}

std::int64_t divide_at_level(const Slab<float>& field, float level, Slab<std::uint8_t>& sides, const Comm& comm) {
  const auto nx = field.grid.size[0], rows = field.grid.size[1];
  std::vector<std::int64_t> changed(static_cast<std::size_t>(parallel::thread_count()), 0);
  parallel::parallel_for(field.first * rows, field.end() * rows, [&](std::int64_t begin, std::int64_t end, int piece) {
    std::int64_t count = 0;
    for (auto row = begin; row < end; ++row) {
      const float* value = field.row(row % rows, row / rows);
      std::uint8_t* side = sides.row(row % rows, row / rows);
      for (std::int64_t i = 0; i < nx; ++i) {
        const std::uint8_t now = side[i] == side_none ? side_none : value[i] > level ? side_above : side_below;
        count += now != side[i];
        side[i] = now;
      }
    }
    changed[static_cast<std::size_t>(piece)] = count;
  });
  return parallel::sum_int64(comm, std::accumulate(changed.begin(), changed.end(), std::int64_t{0}));
}

Slab<std::uint8_t> above_mask(const Slab<std::uint8_t>& sides, const Comm& comm) {
  auto above = parallel::make_slab_like<std::uint8_t>(sides, 1);
  std::ranges::transform(sides.owned(), above.owned().begin(), [](std::uint8_t s) { return s == side_above ? 1 : 0; });
  parallel::exchange_halo(above, comm);
  return above;
}

TwoClasses two_means(const Slab<float>& image, const Slab<std::uint8_t>& domain, Norm norm, const Comm& comm) {
  const Range range = grey_range(image, domain, comm);
  if (!(range.low < range.high)) return {range.low, range.low};
  auto classes = best_split(grey_histogram(image, domain, range, comm), range, norm);
  auto sides = parallel::make_slab_like<std::uint8_t>(image, 0);
  for (int step = 0; step < refinements; ++step) {
    divide(image, domain, classes, sides);
    const auto refined = side_values(image, sides, norm, classes, comm);
    if (refined.c_below == classes.c_below && refined.c_above == classes.c_above) break;
    classes = refined;
  }
  return classes;
}

}  // namespace heartgen::pde
