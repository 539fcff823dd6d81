// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <map>

#include "generator/naming/pieces.hpp"
#include "model/quantile.hpp"

namespace heartgen::naming {
namespace {

constexpr double hardly_a_neck = 0.97;                      // way / narrower basin
constexpr double small_ml = 5, neck_of_a_small_one = 0.85;  // no part of a heart begins so small
constexpr double crumb_ml = 1, smallest_piece_ml = 0.8, crumb_tolerance = 3;

struct Basin {
  double ml = 0, hu = 0, peak_mm = 0;
  std::map<std::int32_t, image::Contact> contacts;
};

std::vector<Basin> measure(const image::Basins& basins, const Volume<float>& hu) {
  std::vector<Basin> result(static_cast<std::size_t>(basins.count) + 1);
  std::vector<std::vector<float>> values(result.size());
  for (std::size_t v = 0; v < hu.voxels.size(); ++v) {
    const auto label = static_cast<std::size_t>(basins.label.voxels[v]);
    if (label == 0) continue;
    values[label].push_back(hu.voxels[v]);
    result[label].peak_mm = std::max(result[label].peak_mm, static_cast<double>(basins.depth_mm.voxels[v]));
  }
  for (std::size_t b = 1; b < result.size(); ++b) {
    result[b].ml = static_cast<double>(values[b].size()) * hu.grid.voxel_volume_mm3() / 1000;
    if (!values[b].empty()) result[b].hu = static_cast<double>(upper_median(values[b]));
  }
  for (const auto& [pair, contact] : basins.contacts) {
    result[static_cast<std::size_t>(pair.first)].contacts[pair.second] = contact;
    result[static_cast<std::size_t>(pair.second)].contacts[pair.first] = contact;
  }
  return result;
}

/// b becomes a part of a.
void join(std::vector<Basin>& basins, std::int32_t a, std::int32_t b) {
  Basin &into = basins[static_cast<std::size_t>(a)], &gone = basins[static_cast<std::size_t>(b)];
  const double ml = into.ml + gone.ml;
  into.hu = (into.hu * into.ml + gone.hu * gone.ml) / ml;
  into.ml = ml;
  into.peak_mm = std::max(into.peak_mm, gone.peak_mm);
  for (const auto& [other, contact] : gone.contacts) {
    auto& others = basins[static_cast<std::size_t>(other)].contacts;
    others.erase(b);
    if (other == a) continue;
    auto& joined = into.contacts[other];
    joined.area_mm2 += contact.area_mm2;
    joined.width_mm = std::max(joined.width_mm, contact.width_mm);
    others[a] = joined;
  }
  into.contacts.erase(b);
  gone.contacts.clear();
}

/// Joins the pair of the highest score again and again, as long as there is one above 0.
template <class Score>
void join_best_first(std::vector<Basin>& basins, std::vector<std::int32_t>& parent, Score&& score) {
  for (;;) {
    double best = 0;
    std::int32_t first = 0, second = 0;
    for (std::int32_t a = 1; a < std::ssize(basins); ++a)
      for (const auto& [b, contact] : basins[static_cast<std::size_t>(a)].contacts) {
        if (b < a) continue;
        const double s = score(basins[static_cast<std::size_t>(a)], basins[static_cast<std::size_t>(b)], contact);
        if (s <= best) continue;
        best = s;
        first = a;
        second = b;
      }
    if (first == 0) return;
    join(basins, first, second);
    parent[static_cast<std::size_t>(second)] = first;
  }
}

}  // namespace

void join_basins(image::Basins& basins, const Volume<float>& hu, double tolerance_hu) {
  image::measure_contacts(basins);
  auto measured = measure(basins, hu);
  std::vector<std::int32_t> parent(measured.size());
  for (std::size_t b = 0; b < parent.size(); ++b) parent[b] = static_cast<std::int32_t>(b);
  join_best_first(measured, parent, [&](const Basin& a, const Basin& b, const image::Contact& contact) {
    const double ratio = contact.width_mm / std::min(a.peak_mm, b.peak_mm);
    const double least = std::min(a.ml, b.ml) < small_ml ? neck_of_a_small_one : hardly_a_neck;
    return std::abs(a.hu - b.hu) <= tolerance_hu && ratio >= least ? ratio : 0;
  });
  join_best_first(measured, parent, [&](const Basin& a, const Basin& b, const image::Contact& contact) {
    const bool is_crumb = std::min(a.ml, b.ml) < crumb_ml && std::abs(a.hu - b.hu) < crumb_tolerance * tolerance_hu;
    return is_crumb ? contact.area_mm2 : 0;
  });
  std::vector<std::int32_t> number(parent.size(), 0);
  std::int32_t count = 0;
  for (std::size_t b = 1; b < parent.size(); ++b) {
    const auto root = static_cast<std::size_t>(parent[b]);  // a parent may itself have been joined to another
    if (root == b && measured[b].ml >= smallest_piece_ml) number[b] = ++count;
  }
  const auto root_of = [&](std::int32_t b) {
    while (parent[static_cast<std::size_t>(b)] != b) b = parent[static_cast<std::size_t>(b)];
    return b;
  };
  for (auto& label : basins.label.voxels)
    if (label > 0) label = number[static_cast<std::size_t>(root_of(label))];
  basins.count = count;
}

}  // namespace heartgen::naming
