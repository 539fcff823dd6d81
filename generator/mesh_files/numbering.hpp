// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Nodes and elements that a file numbers as it likes: from any number on, with gaps, in any order.
#pragma once
#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace heartgen::mesh_files {

struct Numbering {
  std::vector<std::pair<std::int64_t, std::int32_t>> sorted;  ///< (number in the file, place in the file)

  explicit Numbering(const std::vector<std::int64_t>& numbers) {
    sorted.reserve(numbers.size());
    for (const auto number : numbers) sorted.emplace_back(number, static_cast<std::int32_t>(sorted.size()));
    if (!std::is_sorted(sorted.begin(), sorted.end())) std::sort(sorted.begin(), sorted.end());
  }
  /// -1: there is none.
  std::int32_t find(std::int64_t number) const {
    if (sorted.empty() || number < sorted.front().first) return -1;
    // unsigned, because the difference of hostile numbers may leave the range
    const auto guess = static_cast<std::uint64_t>(number) - static_cast<std::uint64_t>(sorted.front().first);
    if (guess < sorted.size() && sorted[guess].first == number) return sorted[guess].second;
    const auto found = std::lower_bound(sorted.begin(), sorted.end(), std::pair{number, std::int32_t{0}});
    return found != sorted.end() && found->first == number ? found->second : -1;
  }
  /// A number that stands there twice, if there is one.
  std::optional<std::int64_t> repeated() const {
    const auto same = [](const auto& a, const auto& b) { return a.first == b.first; };
    const auto found = std::adjacent_find(sorted.begin(), sorted.end(), same);
    return found == sorted.end() ? std::nullopt : std::optional(found->first);
  }
};

}  // namespace heartgen::mesh_files
