// What threads find in pieces of a range, joined so that nobody can tell where the pieces began.
#pragma once
#include <algorithm>
#include <cstdint>
#include <iterator>
#include <utility>
#include <vector>

#include "generator/parallel/threads.hpp"
#include "model/sort_unique.hpp"

namespace heart::parallel {

/// Calls find(begin, end, values) for the pieces of a range; what they append, in the order of the pieces. `finish` is
/// done to each piece's values by its thread.
template <class T, class Find, class Finish>
std::vector<std::vector<T>> find_in_pieces(std::int64_t first, std::int64_t last, Find&& find, Finish&& finish) {
  std::vector<std::vector<T>> of_piece(static_cast<std::size_t>(thread_count()));
  parallel_for(first, last, [&](std::int64_t begin, std::int64_t end, int piece) {
    std::vector<T> own;  // threads must not share cache lines
    find(begin, end, own);
    finish(own);
    of_piece[static_cast<std::size_t>(piece)] = std::move(own);
  });
  return of_piece;
}

/// The values in the order of the range.
template <class T, class Find>
std::vector<T> gather(std::int64_t first, std::int64_t last, Find&& find) {
  auto of_piece = find_in_pieces<T>(first, last, find, [](std::vector<T>&) {});
  std::vector<T> all = std::move(of_piece[0]);
  for (std::size_t p = 1; p < of_piece.size(); ++p) all.insert(all.end(), of_piece[p].begin(), of_piece[p].end());
  return all;
}

/// The values in their own order, one of each.
template <class T, class Find>
std::vector<T> gather_sorted(std::int64_t first, std::int64_t last, Find&& find) {
  auto of_piece = find_in_pieces<T>(first, last, find, [](std::vector<T>& own) { sort_unique(own); });
  std::vector<T> all = std::move(of_piece[0]);
  for (std::size_t p = 1; p < of_piece.size(); ++p) {
    if (of_piece[p].empty()) continue;
    std::vector<T> joined;
    joined.reserve(all.size() + of_piece[p].size());
    std::set_union(all.begin(), all.end(), of_piece[p].begin(), of_piece[p].end(), std::back_inserter(joined));
    all = std::move(joined);
  }
  return all;
}

}  // namespace heart::parallel
