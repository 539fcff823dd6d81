// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What threads find in pieces of a range, joined so that nobody can tell where the pieces began.
#pragma once
#include <algorithm>
#include <cstdint>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include "generator/parallel/threads.hpp"
#include "model/sort_unique.hpp"

namespace heartgen::parallel {

/// Calls find(begin, end, values) for short pieces of a range, more than there are threads; what they append, in the
/// order of the pieces.
template <class T, class Find>
std::vector<std::vector<T>> find_in_pieces(std::int64_t first, std::int64_t last, Find&& find) {
  constexpr std::int64_t pieces_per_thread = 8;
  const auto length = std::max<std::int64_t>(last - first, 0);
  const auto pieces = std::min(length, pieces_per_thread * thread_count());
  std::vector<std::vector<T>> of_piece(static_cast<std::size_t>(pieces));
  parallel_for(0, pieces, [&](std::int64_t begin, std::int64_t end) {
    for (auto piece = begin; piece < end; ++piece) {
      std::vector<T> own;  // threads must not share cache lines
      find(first + length * piece / pieces, first + length * (piece + 1) / pieces, own);
      of_piece[static_cast<std::size_t>(piece)] = std::move(own);
    }
  });
  return of_piece;
}

/// All values of some pieces, in their order.
template <class T>
std::vector<T> joined(std::span<const std::vector<T>> pieces) {
  std::size_t count = 0;
  for (const auto& piece : pieces) count += piece.size();
  std::vector<T> all;
  all.reserve(count);
  for (const auto& piece : pieces) all.insert(all.end(), piece.begin(), piece.end());
  return all;
}

/// The values in the order of the range.
template <class T, class Find>
std::vector<T> gather(std::int64_t first, std::int64_t last, Find&& find) {
  const auto of_piece = find_in_pieces<T>(first, last, find);
  return joined(std::span(of_piece));
}

/// The values in their own order, one of each.
template <class T, class Find>
std::vector<T> gather_sorted(std::int64_t first, std::int64_t last, Find&& find) {
  const auto of_piece = find_in_pieces<T>(first, last, find);
  std::vector<std::vector<T>> sorted(static_cast<std::size_t>(thread_count()));
  parallel_for(0, static_cast<std::int64_t>(of_piece.size()), [&](std::int64_t begin, std::int64_t end, int group) {
    auto own =
        joined(std::span(of_piece).subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin)));
    sort_unique(own);
    sorted[static_cast<std::size_t>(group)] = std::move(own);
  });
  std::vector<T> all = std::move(sorted[0]);
  for (std::size_t g = 1; g < sorted.size(); ++g) {
    if (sorted[g].empty()) continue;
    std::vector<T> both;
    both.reserve(all.size() + sorted[g].size());
    std::set_union(all.begin(), all.end(), sorted[g].begin(), sorted[g].end(), std::back_inserter(both));
    all = std::move(both);
  }
  return all;
}

}  // namespace heartgen::parallel
