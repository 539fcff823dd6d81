#include "generator/segment/median.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

#include "model/error.hpp"

namespace heart::segment {
namespace {

using parallel::Comm;
using parallel::Slab;
using Labels = std::span<const std::uint8_t>;
using Histogram = std::span<const std::int64_t>;

constexpr std::size_t bins = 65536;

/// Monotonous: a < b as floats exactly when key(a) < key(b). Adding 0 turns -0 into +0.
std::uint32_t key(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value + 0.0f);
  return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

float value_of(std::uint32_t key_bits) {
  return std::bit_cast<float>(key_bits & 0x80000000u ? key_bits & 0x7fffffffu : ~key_bits);
}

/// One histogram per label, one after the other, over all ranks. bin_of(value, label's place) gives the bin; a bin
/// outside [0, bins) is not counted.
template <class T, class BinOf>
std::vector<std::int64_t> count(const Slab<T>& values, const Slab<std::uint8_t>& mask, Labels labels, const Comm& comm,
                                BinOf bin_of) {
  std::array<std::size_t, 256> place;
  place.fill(labels.size());
  for (std::size_t n = 0; n < labels.size(); ++n) place[labels[n]] = n;
  const auto v = values.owned();
  const auto m = mask.owned();
  const auto size = labels.size() * bins;
  std::vector<std::vector<std::uint32_t>> pieces(static_cast<std::size_t>(parallel::thread_count()));
  parallel::parallel_for(0, static_cast<std::int64_t>(v.size()), [&](std::int64_t begin, std::int64_t end, int piece) {
    auto& histogram = pieces[static_cast<std::size_t>(piece)];
    histogram.assign(size, 0);
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      const auto n = place[m[i]];
      if (n == labels.size()) continue;
      const std::size_t bin = bin_of(v[i], n);
      if (bin < bins) ++histogram[n * bins + bin];
    }
  });
  std::vector<std::int64_t> sums(size, 0);
  for (const auto& histogram : pieces)
    for (std::size_t bin = 0; bin < histogram.size(); ++bin) sums[bin] += histogram[bin];
  parallel::sum_int64(comm, sums);
  return sums;
}

/// Where the median lies: its bin and its place among the values of that bin. Nothing for an empty histogram.
struct Place {
  std::size_t bin;
  std::int64_t rank;
};

/// The bin that holds the element `rank` of the sorted values.
Place find(Histogram histogram, std::int64_t rank) {
  std::size_t bin = 0;
  for (; rank >= histogram[bin]; ++bin) rank -= histogram[bin];
  return {bin, rank};
}

std::optional<Place> find_median(Histogram histogram) {
  const auto total = std::accumulate(histogram.begin(), histogram.end(), std::int64_t{0});
  if (total == 0) return {};
  return find(histogram, (total - 1) / 2);
}

/// Infinities and NaN have keys beyond those of all finite values, in bins of their own.
void refuse_not_finite(Histogram high) {
  constexpr std::size_t first_finite = 0x0080, first_positive_infinity = 0xff80;
  std::int64_t bad = 0;
  for (std::size_t bin = 0; bin < high.size(); ++bin)
    if (bin % bins < first_finite || bin % bins >= first_positive_infinity) bad += high[bin];
  if (bad > 0)
    throw UserError(fmt::format("{} values are not finite", bad), "median", "replace NaN and infinity first");
}

}  // namespace

std::vector<std::optional<float>> medians(const Slab<float>& values, const Slab<std::uint8_t>& mask, Labels labels,
                                          const Comm& comm) {
  const auto high = count(values, mask, labels, comm, [](float v, std::size_t) { return std::size_t{key(v) >> 16}; });
  refuse_not_finite(high);
  std::vector<std::optional<Place>> upper;
  for (std::size_t n = 0; n < labels.size(); ++n) upper.push_back(find_median(Histogram(high).subspan(n * bins, bins)));
  const auto low = count(values, mask, labels, comm, [&upper](float v, std::size_t n) {
    const auto bits = key(v);
    return upper[n] && bits >> 16 == upper[n]->bin ? std::size_t{bits & 0xffffu} : bins;
  });
  std::vector<std::optional<float>> result(labels.size());
  for (std::size_t n = 0; n < labels.size(); ++n) {
    if (!upper[n]) continue;
    const auto lower = find(Histogram(low).subspan(n * bins, bins), upper[n]->rank);
    result[n] = value_of(static_cast<std::uint32_t>(upper[n]->bin << 16 | lower.bin));
  }
  return result;
}

std::optional<float> median(const Slab<float>& values, const Slab<std::uint8_t>& mask, std::uint8_t label,
                            const Comm& comm) {
  return medians(values, mask, {&label, 1}, comm).front();
}

std::optional<std::int16_t> median(const Slab<std::int16_t>& values, const Slab<std::uint8_t>& mask, std::uint8_t label,
                                   const Comm& comm) {
  const auto histogram = count(values, mask, Labels{&label, 1}, comm,
                               [](std::int16_t v, std::size_t) { return static_cast<std::size_t>(int{v} + 32768); });
  const auto found = find_median(histogram);
  if (!found) return {};
  return static_cast<std::int16_t>(static_cast<int>(found->bin) - 32768);
}

}  // namespace heart::segment
