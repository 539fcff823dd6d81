// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/landmarks/named_chambers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <set>

#include "generator/chest/working_image.hpp"
#include "generator/image/distance.hpp"
#include "generator/image/flood.hpp"

namespace heartgen::landmarks {
namespace {

using naming::Name;

constexpr std::uint8_t elsewhere = 255;  // what a flood takes away from the chambers
constexpr std::array<Name, 4> four_chambers = {Name::lv, Name::la, Name::rv, Name::ra};

/// Of the label maps here; `elsewhere` for vessels that end outside of the heart.
std::uint8_t tag_of(Name name) {
  switch (name) {
    case Name::lv:
      return tag(Region::lv_blood);
    case Name::la:
      return tag(Region::la_blood);
    case Name::rv:
      return tag(Region::rv_blood);
    case Name::ra:
      return tag(Region::ra_blood);
    case Name::aorta:
    case Name::descending_aorta:
      return tag(Region::aorta);
    case Name::pulmonary_artery:
      return tag(Region::pulmonary_artery);
    default:
      return elsewhere;
  }
}

/// The map of tags on the names' grid; 0 where no piece is.
LabelVolume tags_of(const naming::Naming& named) {
  LabelVolume tags(named.names.grid);
  for (std::size_t v = 0; v < tags.voxels.size(); ++v)
    if (named.names.voxels[v] || named.others.voxels[v])
      tags.voxels[v] = tag_of(static_cast<Name>(named.names.voxels[v]));
  return tags;
}

/// Calls visit(voxel of `grid`, offset there, offset in `names`) where the grids overlap, both along the LPS axes.
template <class Visit>
void for_common_voxels(const Grid& grid, const Grid& names, Visit&& visit) {
  std::size_t v = 0;
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i, ++v) {
        const Index3 at = chest::nearest_voxel(names, chest::position_mm(grid, i, j, k));
        if (names.contains(at[0], at[1], at[2]))
          visit(Index3{i, j, k}, v, static_cast<std::size_t>(names.offset(at[0], at[1], at[2])));
      }
}

bool is_right(std::uint8_t label) {
  return label == tag(Region::rv_blood) || label == tag(Region::ra_blood) || label == tag(Region::pulmonary_artery);
}

/// Voxels of `own` that lie so far from other parts that the border between both cannot be there. The right heart's
/// parts open wide into each other: pieces end farther from its valves.
Mask certain(const LabelVolume& tags, std::uint8_t own) {
  constexpr float border_mm = 5, right_border_mm = 12;  // two voxels and the watershed's uncertainty
  const auto distance_where = [&](const auto& rule) {
    return image::distance_to(
        chest::mask_where(tags.grid, [&](const Vec3&, std::size_t v) { return rule(tags.voxels[v]); }));
  };
  const bool own_is_right = is_right(own);
  const auto from_others = distance_where([&](std::uint8_t tag) { return tag != 0 && tag != own; });
  const auto from_right = distance_where([&](std::uint8_t tag) { return own_is_right && tag != own && is_right(tag); });
  return chest::mask_where(tags.grid, [&](const Vec3&, std::size_t v) {
    return tags.voxels[v] == own && from_others.voxels[v] > border_mm && from_right.voxels[v] > right_border_mm;
  });
}

/// Of a part that is too small to have certain voxels all are taken.
LabelVolume certain(const LabelVolume& tags) {
  LabelVolume kept(tags.grid);
  std::set<std::uint8_t> parts(tags.voxels.begin(), tags.voxels.end());
  parts.erase(0);
  for (const auto own : parts) {
    const Mask sure = certain(tags, own);
    const bool has_any = std::any_of(sure.voxels.begin(), sure.voxels.end(), [](auto set) { return set != 0; });
    for (std::size_t v = 0; v < tags.voxels.size(); ++v)
      if (has_any ? sure.voxels[v] != 0 : tags.voxels[v] == own) kept.voxels[v] = own;
  }
  return kept;
}

}  // namespace

LabelVolume named_chambers(const Mask& blood, const naming::Naming& named) {
  const LabelVolume sure = certain(tags_of(named));
  std::vector<image::Marker> markers;
  for_common_voxels(blood.grid, sure.grid, [&](const Index3& at, std::size_t v, std::size_t n) {
    if (blood.voxels[v] && sure.voxels[n]) markers.push_back({sure.voxels[n], at});
  });
  auto labels = image::flood_from_markers(blood, chest::depth_of(blood), markers, image::ValveBarrier(blood.grid));
  std::replace(labels.voxels.begin(), labels.voxels.end(), elsewhere, std::uint8_t{0});
  return labels;
}

Mask named_blood(const Grid& grid, const naming::Naming& named) {
  Mask blood(grid);
  for_common_voxels(grid, named.names.grid,
                    [&](const Index3&, std::size_t v, std::size_t n) { blood.voxels[v] = named.names.voxels[n] != 0; });
  return blood;
}

Vec3 middle_of_chambers(const naming::Naming& named) {
  Vec3 sum;
  int count = 0;
  for (const Name name : four_chambers) {
    if (named[name].ml == 0) continue;
    sum += named[name].center_mm;
    ++count;
  }
  return sum / std::max(count, 1);
}

namespace {

/// Voxels by the tag of one search (row) and the name of the other.
using Counts = std::array<std::array<std::int64_t, naming::name_count>, 256>;

Counts count_common(const LabelVolume& chambers, const naming::Naming& named) {
  Counts counts{};
  for_common_voxels(chambers.grid, named.names.grid, [&](const Index3&, std::size_t v, std::size_t n) {
    ++counts[chambers.voxels[v]][named.names.voxels[n]];
  });
  return counts;
}

std::int64_t sum(const std::array<std::int64_t, naming::name_count>& row) {
  return std::accumulate(row.begin(), row.end(), std::int64_t{0});
}

/// Voxels with the name, whatever their tag.
std::int64_t sum_of(const Counts& counts, Name name) {
  std::int64_t voxels = 0;
  for (const auto& row : counts) voxels += row[static_cast<std::size_t>(name)];
  return voxels;
}

}  // namespace

Disputes disputes(const LabelVolume& chambers, const naming::Naming& named) {
  constexpr double min_share = 0.5, min_dice = 0.65, min_named_ml = 5;
  const Counts counts = count_common(chambers, named);
  const double voxel_ml = chambers.grid.voxel_volume_mm3() / 1000;
  const auto ml = [&](std::int64_t voxels) { return static_cast<double>(voxels) * voxel_ml; };
  Disputes found;
  for (const auto name : {Name::aorta, Name::pulmonary_artery, Name::lv, Name::la, Name::rv, Name::ra}) {
    const auto& row = counts[tag_of(name)];
    const auto word = naming::usual_of(name).word;
    std::int64_t same = 0;
    for (int n = 0; n < naming::name_count; ++n)
      if (tag_of(static_cast<Name>(n)) == tag_of(name)) same += row[static_cast<std::size_t>(n)];
    const auto with_a_name = sum(row) - row[0];
    if (ml(with_a_name) > min_named_ml && static_cast<double>(same) < min_share * static_cast<double>(with_a_name)) {
      const auto other = std::max_element(row.begin() + 1, row.end()) - row.begin();
      found.names.push_back(fmt::format("what one search takes for {} another takes for {}", word,
                                        naming::usual_of(static_cast<Name>(other)).word));
      continue;
    }
    const bool is_chamber = std::find(four_chambers.begin(), four_chambers.end(), name) != four_chambers.end();
    const auto both = sum(row) + sum_of(counts, name);
    if (is_chamber && 2.0 * static_cast<double>(same) < min_dice * static_cast<double>(both))
      found.extents.push_back(
          fmt::format("of {} one search finds {:.0f} ml, another {:.0f} ml, and {:.0f} ml of both are the same", word,
                      ml(sum(row)), ml(sum_of(counts, name)), ml(same)));
  }
  return found;
}

}  // namespace heartgen::landmarks
