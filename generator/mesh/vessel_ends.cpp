// SPDX-License-Identifier: GPL-3.0-or-later
// Tips of a tubular mask: leaves of the tree of geodesic shells (the connected pieces of equal distance from a far
// point inside the lumen), short leaves pruned as bumps.
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>
#include <numeric>
#include <queue>
#include <utility>

#include "generator/image/sections.hpp"
#include "generator/mesh/mesh_vessel.hpp"
#include "model/quantile.hpp"

namespace heartgen::mesh {
namespace {

constexpr double bump_length_radii = 1.5;  // branches shorter than this many radii are bumps of the wall
constexpr double cut_back_radii = 1;       // the plane lies at least this far behind the tip
constexpr double axis_length_radii = 2.5;  // the axis at a cut comes from this length of vessel
constexpr double full_section = 0.75;      // the plane lies where the section has this share of the usual area
constexpr double min_component = 0.2;      // share of the largest component's voxels; smaller ones have no ends

struct Lumen {
  Grid grid;
  std::vector<Index3> voxels;        // set voxels in memory order
  std::vector<std::int32_t> number;  // per voxel of the grid: its place in `voxels`, -1 outside

  std::int32_t at(const Index3& p) const {
    return grid.contains(p[0], p[1], p[2]) ? number[static_cast<std::size_t>(grid.offset(p[0], p[1], p[2]))] : -1;
  }
  Vec3 lps(std::int32_t v) const {
    const auto& p = voxels[static_cast<std::size_t>(v)];
    return lps_from_index(grid, {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])});
  }
};

Lumen make_lumen(const Mask& mask) {
  Lumen lumen{mask.grid, {}, std::vector<std::int32_t>(mask.voxels.size(), -1)};
  std::size_t at = 0;
  for (std::int64_t k = 0; k < mask.grid.size[2]; ++k)
    for (std::int64_t j = 0; j < mask.grid.size[1]; ++j)
      for (std::int64_t i = 0; i < mask.grid.size[0]; ++i, ++at) {
        if (mask.voxels[at] == 0) continue;
        lumen.number[at] = static_cast<std::int32_t>(lumen.voxels.size());
        lumen.voxels.push_back({i, j, k});
      }
  return lumen;
}

void for_neighbours(const Lumen& lumen, std::int32_t voxel, const auto& visit) {
  const auto& p = lumen.voxels[static_cast<std::size_t>(voxel)];
  const auto& s = lumen.grid.spacing_mm;
  for (int dk = -1; dk <= 1; ++dk)
    for (int dj = -1; dj <= 1; ++dj)
      for (int di = -1; di <= 1; ++di) {
        if (di == 0 && dj == 0 && dk == 0) continue;
        const auto other = lumen.at({p[0] + di, p[1] + dj, p[2] + dk});
        if (other >= 0) visit(other, norm(Vec3{di * s.x, dj * s.y, dk * s.z}));
      }
}

constexpr double unreached = std::numeric_limits<double>::max();

std::vector<double> geodesic_distance(const Lumen& lumen, const std::vector<std::int32_t>& sources) {
  std::vector<double> distance(lumen.voxels.size(), unreached);
  using Item = std::pair<double, std::int32_t>;
  std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;
  for (const auto source : sources) {
    distance[static_cast<std::size_t>(source)] = 0;
    queue.push({0, source});
  }
  while (!queue.empty()) {
    const auto [d, voxel] = queue.top();
    queue.pop();
    if (d > distance[static_cast<std::size_t>(voxel)]) continue;
    for_neighbours(lumen, voxel, [&, d = d](std::int32_t other, double length) {
      auto& value = distance[static_cast<std::size_t>(other)];
      if (d + length >= value) return;
      value = d + length;
      queue.push({value, other});
    });
  }
  return distance;
}

std::int32_t farthest(const std::vector<double>& distance) {
  std::int32_t best = -1;
  for (std::size_t v = 0; v < distance.size(); ++v)
    if (distance[v] != unreached && (best < 0 || distance[v] > distance[static_cast<std::size_t>(best)]))
      best = static_cast<std::int32_t>(v);
  return best;
}

/// A connected piece of the lumen between two geodesic distances.
struct Shell {
  std::int64_t layer = 0;
  std::vector<std::int32_t> voxels;
  Vec3 center_mm;
  double area_mm2 = 0;  // volume over thickness
  int parent = -1;      // the shell it touches one layer nearer to the source; the largest of several
  double depth_mm = 0;  // distance from here to the end of the longest branch beyond
  double radius_mm() const { return std::sqrt(area_mm2 / std::numbers::pi); }
};

std::vector<Shell> make_shells(const Lumen& lumen, const std::vector<double>& distance, double thickness) {
  const auto layer_of = [&](std::int32_t v) {
    return static_cast<std::int64_t>(distance[static_cast<std::size_t>(v)] / thickness);
  };
  std::vector<int> shell_of(lumen.voxels.size(), -1);
  std::vector<Shell> shells;
  for (std::int32_t seed = 0; seed < static_cast<std::int32_t>(lumen.voxels.size()); ++seed) {
    if (distance[static_cast<std::size_t>(seed)] == unreached || shell_of[static_cast<std::size_t>(seed)] >= 0)
      continue;
    const int id = static_cast<int>(shells.size());
    Shell shell{layer_of(seed), {seed}, {}, 0, -1, 0};
    shell_of[static_cast<std::size_t>(seed)] = id;
    for (std::size_t next = 0; next < shell.voxels.size(); ++next) {
      shell.center_mm += lumen.lps(shell.voxels[next]);
      for_neighbours(lumen, shell.voxels[next], [&](std::int32_t other, double) {
        auto& owner = shell_of[static_cast<std::size_t>(other)];
        if (owner >= 0 || layer_of(other) != shell.layer) return;
        owner = id;
        shell.voxels.push_back(other);
      });
    }
    const auto count = static_cast<double>(shell.voxels.size());
    shell.center_mm = shell.center_mm / count;
    shell.area_mm2 = count * lumen.grid.voxel_volume_mm3() / thickness;
    shells.push_back(std::move(shell));
  }
  for (auto& shell : shells)
    for (const auto voxel : shell.voxels)
      for_neighbours(lumen, voxel, [&](std::int32_t other, double) {
        const int candidate = shell_of[static_cast<std::size_t>(other)];
        if (candidate < 0 || shells[static_cast<std::size_t>(candidate)].layer != shell.layer - 1) return;
        const auto size = [&](int id) { return shells[static_cast<std::size_t>(id)].voxels.size(); };
        if (shell.parent < 0 || size(candidate) > size(shell.parent)) shell.parent = candidate;
      });
  return shells;
}

// Depth of every shell, and whether its parent continues into it (the deepest child does).
std::vector<bool> mark_continuations(std::vector<Shell>& shells, double thickness) {
  std::vector<int> order(shells.size());
  for (std::size_t s = 0; s < order.size(); ++s) order[s] = static_cast<int>(s);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return shells[static_cast<std::size_t>(a)].layer > shells[static_cast<std::size_t>(b)].layer;
  });
  std::vector<int> deepest_child(shells.size(), -1);
  for (const int s : order) {
    const auto& shell = shells[static_cast<std::size_t>(s)];
    if (shell.parent < 0) continue;
    auto& parent = shells[static_cast<std::size_t>(shell.parent)];
    if (shell.depth_mm + thickness <= parent.depth_mm) continue;
    parent.depth_mm = shell.depth_mm + thickness;
    deepest_child[static_cast<std::size_t>(shell.parent)] = s;
  }
  std::vector<bool> continues(shells.size(), false);
  for (const int child : deepest_child)
    if (child >= 0) continues[static_cast<std::size_t>(child)] = true;
  return continues;
}

// Shells from a leaf back towards the source, as far as the branch is its own.
std::vector<const Shell*> branch_of(const std::vector<Shell>& shells, const std::vector<bool>& continues, int leaf) {
  std::vector<const Shell*> branch;
  for (int s = leaf; s >= 0; s = shells[static_cast<std::size_t>(s)].parent) {
    branch.push_back(&shells[static_cast<std::size_t>(s)]);
    if (!continues[static_cast<std::size_t>(s)]) break;
  }
  return branch;
}

double typical_area(const std::vector<const Shell*>& branch) {
  std::vector<double> areas;
  for (std::size_t i = 0; i < std::min<std::size_t>(branch.size(), 12); ++i) areas.push_back(branch[i]->area_mm2);
  return upper_median(areas);
}

// Least-squares line through the shells' centres from `first` on, over `length` mm.
Vec3 axis_of(const std::vector<const Shell*>& branch, std::size_t first, double length, double thickness) {
  const auto wanted = static_cast<std::size_t>(std::max(3.0, std::ceil(length / thickness)));
  const std::size_t end = std::min(branch.size(), first + wanted);
  Vec3 mean, slope;
  double middle = 0;
  for (std::size_t i = first; i < end; ++i) {
    mean += branch[i]->center_mm / static_cast<double>(end - first);
    middle += static_cast<double>(i) / static_cast<double>(end - first);
  }
  for (std::size_t i = first; i < end; ++i) slope += (middle - static_cast<double>(i)) * (branch[i]->center_mm - mean);
  return normalized(slope);
}

VesselEnd end_of_branch(const Lumen& lumen, const std::vector<const Shell*>& branch, double thickness) {
  const double area = typical_area(branch);
  const double radius = std::sqrt(area / std::numbers::pi);
  std::size_t cut = static_cast<std::size_t>(std::ceil(cut_back_radii * radius / thickness));
  while (cut + 3 < branch.size() && branch[cut]->area_mm2 < full_section * area) ++cut;
  cut = std::min(cut, branch.size() >= 3 ? branch.size() - 3 : 0);
  VesselEnd end;
  end.center_mm = branch[cut]->center_mm;
  end.normal = axis_of(branch, cut, axis_length_radii * radius, thickness);
  end.radius_mm = radius;
  for (std::size_t i = 0; i <= cut; ++i)
    for (const auto voxel : branch[i]->voxels)
      end.reach_mm = std::max(end.reach_mm, norm(lumen.lps(voxel) - end.center_mm));
  const auto& s = lumen.grid.spacing_mm;
  end.reach_mm = std::max(end.reach_mm, 1.5 * radius) + std::max({s.x, s.y, s.z});
  return end;
}

struct Tips {
  std::vector<std::int32_t> voxels;
  std::vector<VesselEnd> ends;
};

// Ends at the leaves of the shell tree that starts at `source`. The source's own end is not among them.
Tips tips_from(const Lumen& lumen, const std::vector<double>& distance, double thickness) {
  auto shells = make_shells(lumen, distance, thickness);
  const auto continues = mark_continuations(shells, thickness);
  Tips tips;
  for (std::size_t s = 0; s < shells.size(); ++s) {
    if (shells[s].depth_mm > 0) continue;
    const auto branch = branch_of(shells, continues, static_cast<int>(s));
    const int stem = branch.back()->parent;
    const double stem_radius =
        stem < 0 ? 0 : std::max(shells[static_cast<std::size_t>(stem)].radius_mm(), branch.back()->radius_mm());
    if (static_cast<double>(branch.size()) * thickness < bump_length_radii * stem_radius) continue;
    tips.voxels.push_back(shells[s].voxels.front());
    tips.ends.push_back(end_of_branch(lumen, branch, thickness));
  }
  return tips;
}

std::vector<VesselEnd> ends_of_component(const Lumen& lumen, std::int32_t seed, double thickness) {
  const auto root = farthest(geodesic_distance(lumen, {seed}));
  const auto distance = geodesic_distance(lumen, {root});
  auto ends = tips_from(lumen, distance, thickness).ends;
  // Seen from the farthest tip, the root is a leaf as well: the one nearest to it.
  const auto back = tips_from(lumen, geodesic_distance(lumen, {farthest(distance)}), thickness);
  std::size_t best = back.voxels.size();
  const auto gap = [&](std::size_t tip) { return distance[static_cast<std::size_t>(back.voxels[tip])]; };
  for (std::size_t tip = 0; tip < back.voxels.size(); ++tip)
    if (best == back.voxels.size() || gap(tip) < gap(best)) best = tip;
  if (best < back.voxels.size()) ends.push_back(back.ends[best]);
  return ends;
}

double shell_thickness(const Grid& grid) {
  return 1.5 * std::max({grid.spacing_mm.x, grid.spacing_mm.y, grid.spacing_mm.z});
}

constexpr double section_step_mm = 1;
constexpr double section_search_mm = 1.5;

/// Sections of a lumen across an end's normal, from `first_mm` to `last_mm` along it.
std::vector<image::Section> sections_along(const Volume<float>& lumen, const VesselEnd& end, double first_mm,
                                           double last_mm) {
  std::vector<image::Section> sections;
  for (double along = first_mm; along <= last_mm; along += section_step_mm)
    if (const auto found = image::section_at(lumen, end.center_mm + along * end.normal, end.normal, section_search_mm))
      sections.push_back(*found);
  return sections;
}

double usual_area_mm2(const std::vector<image::Section>& sections) {
  std::vector<double> areas;
  for (const auto& section : sections) areas.push_back(section.area_mm2);
  return upper_median(areas);
}

/// The plane across the line through the centres of the sections behind it. Oblique sections of a tube have their
/// centres on its axis too, so that a first axis that is off, as geodesic distances in voxels make it, is mended.
VesselEnd turned_across_sections(const Volume<float>& lumen, VesselEnd end) {
  constexpr int rounds = 4;
  constexpr double least_share = 0.75, greatest_share = 1.4;  // of the usual area: neither cut off nor a chamber's
  const double length = axis_length_radii * end.radius_mm;
  for (int round = 0; round < rounds; ++round) {
    auto sections = sections_along(lumen, end, -length, 0);
    if (sections.empty()) return end;
    const double usual = usual_area_mm2(sections);
    std::erase_if(sections, [&](const image::Section& s) {
      return s.area_mm2 < least_share * usual || s.area_mm2 > greatest_share * usual;
    });
    if (sections.size() < 4) return end;
    const double middle = static_cast<double>(sections.size() - 1) / 2;
    Vec3 mean, slope;
    for (std::size_t s = 0; s < sections.size(); ++s) {
      mean += sections[s].centre_mm / static_cast<double>(sections.size());
      slope += (static_cast<double>(s) - middle) * sections[s].centre_mm;
    }
    if (norm(slope) < 1e-9) return end;
    end.normal = normalized(slope);
    end.center_mm = mean + dot(end.center_mm - mean, end.normal) * end.normal;
  }
  return end;
}

/// The plane moved along its axis to where the section is whole for the last time: farther in than the first guess
/// where the tip is cut obliquely, farther out where it is not.
VesselEnd moved_to_last_section(const Volume<float>& lumen, VesselEnd end) {
  constexpr double step_mm = 0.25, whole = 0.97, inwards_radii = 2.5, outwards_radii = 2;
  constexpr std::size_t averaged = 5;
  const auto own = sections_along(lumen, end, -inwards_radii * end.radius_mm, -end.radius_mm);
  if (own.empty()) return end;
  const double usual = usual_area_mm2(own);
  // Areas are counted in pixels: the mean of neighbouring sections decides.
  std::deque<double> latest;
  double last = -end.radius_mm;
  for (double along = last; along <= outwards_radii * end.radius_mm; along += step_mm) {
    const auto found = image::section_at(lumen, end.center_mm + along * end.normal, end.normal, section_search_mm);
    if (!found) break;
    latest.push_back(found->area_mm2);
    if (latest.size() > averaged) latest.pop_front();
    if (std::accumulate(latest.begin(), latest.end(), 0.0) >= whole * usual * static_cast<double>(latest.size()))
      last = along - 0.5 * step_mm * static_cast<double>(latest.size() - 1);
  }
  end.center_mm += last * end.normal;
  return end;
}

/// How far from the plane's centre the tip beyond it reaches.
double reach_of_tip(const Lumen& lumen, const VesselEnd& end) {
  const auto& s = lumen.grid.spacing_mm;
  const double voxel = std::max({s.x, s.y, s.z});
  const auto beyond = [&](std::int32_t v) { return dot(lumen.lps(v) - end.center_mm, end.normal); };
  double reach = 1.5 * end.radius_mm;
  std::vector<std::uint8_t> is_seen(lumen.voxels.size(), 0);
  std::vector<std::int32_t> tip;
  for (std::int32_t v = 0; v < static_cast<std::int32_t>(lumen.voxels.size()); ++v)
    if (beyond(v) > 0 && beyond(v) < 2 * voxel && norm(lumen.lps(v) - end.center_mm) < reach) {
      is_seen[static_cast<std::size_t>(v)] = 1;
      tip.push_back(v);
    }
  for (std::size_t next = 0; next < tip.size(); ++next) {
    reach = std::max(reach, norm(lumen.lps(tip[next]) - end.center_mm));
    for_neighbours(lumen, tip[next], [&](std::int32_t other, double) {
      auto& seen = is_seen[static_cast<std::size_t>(other)];
      if (seen || beyond(other) <= 0) return;
      seen = 1;
      tip.push_back(other);
    });
  }
  return reach + voxel;
}

}  // namespace

std::vector<VesselEnd> find_vessel_ends(const Mask& given, const Mask& start) {
  Mask mask = given;
  mask.grid.origin_mm = {};
  mask.grid.direction = Grid{}.direction;
  const auto lumen = make_lumen(mask);
  std::vector<std::int32_t> sources;
  for (std::size_t v = 0; v < lumen.voxels.size(); ++v) {
    const auto& p = lumen.voxels[v];
    if (start(p[0], p[1], p[2]) != 0) sources.push_back(static_cast<std::int32_t>(v));
  }
  if (sources.empty()) return {};
  auto ends = tips_from(lumen, geodesic_distance(lumen, sources), shell_thickness(mask.grid)).ends;
  Volume<float> sampled(mask.grid);
  std::copy(mask.voxels.begin(), mask.voxels.end(), sampled.voxels.begin());
  for (auto& end : ends) {
    end = moved_to_last_section(sampled, turned_across_sections(sampled, end));
    end.reach_mm = reach_of_tip(lumen, end);
  }
  return ends;
}

std::vector<VesselEnd> find_vessel_ends(const Mask& mask) {
  const auto lumen = make_lumen(mask);
  const double thickness = shell_thickness(mask.grid);
  struct Component {
    std::int64_t size;
    std::int32_t seed;
  };
  std::vector<Component> components;
  std::vector<bool> seen(lumen.voxels.size(), false);
  for (std::size_t v = 0; v < lumen.voxels.size(); ++v) {
    if (seen[v]) continue;
    std::vector<std::int32_t> part{static_cast<std::int32_t>(v)};
    seen[v] = true;
    for (std::size_t next = 0; next < part.size(); ++next)
      for_neighbours(lumen, part[next], [&](std::int32_t other, double) {
        if (seen[static_cast<std::size_t>(other)]) return;
        seen[static_cast<std::size_t>(other)] = true;
        part.push_back(other);
      });
    components.push_back({static_cast<std::int64_t>(part.size()), static_cast<std::int32_t>(v)});
  }
  std::int64_t largest = 0;
  for (const auto& c : components) largest = std::max(largest, c.size);
  std::vector<VesselEnd> ends;
  for (const auto& c : components) {
    if (static_cast<double>(c.size) < min_component * static_cast<double>(largest)) continue;
    for (const auto& end : ends_of_component(lumen, c.seed, thickness)) ends.push_back(end);
  }
  std::stable_sort(ends.begin(), ends.end(),
                   [](const VesselEnd& a, const VesselEnd& b) { return a.center_mm.z > b.center_mm.z; });
  return ends;
}

}  // namespace heartgen::mesh
