// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/median.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

#include "model/error.hpp"

namespace heartgen::pde {
namespace {

using parallel::Comm;
using parallel::Slab;
using Labels = std::span<const std::uint8_t>;
using Histogram = std::span<const std::int64_t>;
using Counts = std::vector<std::uint32_t>;

/// Each rank counts 16 bits of the keys at a time, which are two passes over its values; what the ranks add up is one
/// digit of 8 bits at a time, which are small messages.
constexpr unsigned count_bits = 16, digit_bits = 8;
constexpr std::size_t bins = std::size_t{1} << count_bits, digits = std::size_t{1} << digit_bits;

/// Monotonous: a < b as floats exactly when key(a) < key(b). Adding 0 turns -0 into +0.
std::uint32_t key(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value + 0.0f);
  return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

float value_of(std::uint32_t bits) { return std::bit_cast<float>(bits & 0x80000000u ? bits & 0x7fffffffu : ~bits); }

/// What is known of a label's median.
struct Search {
  std::uint32_t prefix = 0;  ///< its key's first digits
  std::int64_t rank = 0;     ///< its place among the values that begin with them
  bool empty = false;        ///< no value has the label
};

/// Histograms over the upper or the lower half of the keys of this rank's values, one per label, one after the other;
/// over the lower half of those values only that begin with what is known.
Counts count(const Slab<float>& values, const Slab<std::uint8_t>& mask, Labels labels, std::span<const Search> searches,
             bool lower) {
  std::array<std::size_t, 256> place;
  place.fill(labels.size());
  for (std::size_t n = 0; n < labels.size(); ++n) place[labels[n]] = n;
  const auto v = values.owned();
  const auto m = mask.owned();
  const auto size = labels.size() * bins;
  std::vector<Counts> pieces(static_cast<std::size_t>(parallel::thread_count()));
  parallel::parallel_for(0, static_cast<std::int64_t>(v.size()), [&](std::int64_t begin, std::int64_t end, int piece) {
    auto& histogram = pieces[static_cast<std::size_t>(piece)];
    histogram.assign(size, 0);
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      const auto n = place[m[i]];
      if (n == labels.size()) continue;
      const std::uint32_t bits = key(v[i]), upper = bits >> count_bits;
      if (!lower)
        ++histogram[n * bins + upper];
      else if (upper == searches[n].prefix)
        ++histogram[n * bins + bits % bins];
    }
  });
  Counts sums = std::move(pieces[0]);  // the calling thread's; none where there are no values
  sums.resize(size, 0);
  for (std::size_t piece = 1; piece < pieces.size(); ++piece)
    for (std::size_t bin = 0; bin < pieces[piece].size(); ++bin) sums[bin] += pieces[piece][bin];
  return sums;
}

/// Infinities and NaN have keys beyond those of all finite values, in bins of their own. @collective
void refuse_not_finite(const Counts& upper, const Comm& comm) {
  constexpr std::size_t first_finite = 0x0080, first_positive_infinity = 0xff80;
  std::int64_t bad = 0;
  for (std::size_t label = 0; label < upper.size(); label += bins) {
    for (std::size_t bin = 0; bin < first_finite; ++bin) bad += upper[label + bin];
    for (std::size_t bin = first_positive_infinity; bin < bins; ++bin) bad += upper[label + bin];
  }
  bad = parallel::sum_int64(comm, bad);
  if (bad > 0)
    throw UserError(fmt::format("{} values are not finite", bad), "median", "replace NaN and infinity first");
}

/// Histograms over the first digit of the counted bits, or over the second where the first is known. @collective
std::vector<std::int64_t> digit_counts(const Counts& counted, std::span<const Search> searches, bool second,
                                       const Comm& comm) {
  std::vector<std::int64_t> sums(searches.size() * digits, 0);
  for (std::size_t n = 0; n < searches.size(); ++n)
    for (std::size_t digit = 0; digit < digits; ++digit) {
      const auto first = counted.begin() + static_cast<std::ptrdiff_t>(n * bins);
      const auto known = searches[n].prefix % digits;
      sums[n * digits + digit] =
          second ? first[static_cast<std::ptrdiff_t>(known * digits + digit)]
                 : std::accumulate(first + static_cast<std::ptrdiff_t>(digit * digits),
                                   first + static_cast<std::ptrdiff_t>((digit + 1) * digits), std::int64_t{0});
    }
  parallel::sum_int64(comm, sums);
  return sums;
}

/// The label's search begins: which of its values the median is.
Search begin_search(Histogram first_digit) {
  const auto total = std::accumulate(first_digit.begin(), first_digit.end(), std::int64_t{0});
  return {0, (total - 1) / 2, total == 0};
}

/// One digit more: that of the values among which the wanted one is.
void narrow(Search& search, Histogram histogram) {
  if (search.empty) return;
  std::uint32_t digit = 0;
  for (; search.rank >= histogram[digit]; ++digit) search.rank -= histogram[digit];
  search.prefix = search.prefix << digit_bits | digit;
}

}  // namespace

std::vector<std::optional<float>> medians(const Slab<float>& values, const Slab<std::uint8_t>& mask, Labels labels,
                                          const Comm& comm) {
  std::vector<Search> searches(labels.size());
  for (const bool lower : {false, true}) {
    const auto counted = count(values, mask, labels, searches, lower);
    if (!lower) refuse_not_finite(counted, comm);
    for (const bool second : {false, true}) {
      const auto histograms = digit_counts(counted, searches, second, comm);
      for (std::size_t n = 0; n < labels.size(); ++n) {
        const auto histogram = Histogram(histograms).subspan(n * digits, digits);
        if (!lower && !second) searches[n] = begin_search(histogram);
        narrow(searches[n], histogram);
      }
    }
  }
  std::vector<std::optional<float>> result;
  result.reserve(searches.size());
  for (const auto& search : searches)
    result.push_back(search.empty ? std::nullopt : std::optional(value_of(search.prefix)));
  return result;
}

std::optional<float> median(const Slab<float>& values, const Slab<std::uint8_t>& mask, std::uint8_t label,
                            const Comm& comm) {
  return medians(values, mask, {&label, 1}, comm).front();
}

}  // namespace heartgen::pde
