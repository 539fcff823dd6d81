// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/stuffing/under_resolved.hpp"

#include <algorithm>

#include "generator/parallel/gather.hpp"

namespace heartgen::stuffing {
namespace {

constexpr int min_alike = 3;  // of eight; behind a plane there are four at least

bool is_center_delicate(const Lattice& lattice, const Leaf& leaf) {
  const auto& [tree, near] = lattice;
  const auto label = near.center_label[tree.offset(leaf.low)];
  int alike = 0;
  for (std::int32_t corner = 0; corner < 8; ++corner)
    alike += near.corner_label[tree.corner_offset(corner_of(leaf, corner))] == label;
  return alike < min_alike;
}

// What lies beyond a side of the box counts as alike.
bool is_corner_delicate(const Lattice& lattice, const TreeIndex& at) {
  const auto& [tree, near] = lattice;
  const auto label = near.corner_label[tree.corner_offset(at)];
  int alike = 0;
  for (std::int32_t cell = 0; cell < 8; ++cell) {
    const TreeIndex beside{at[0] - (cell & 1), at[1] - ((cell >> 1) & 1), at[2] - (cell >> 2)};
    alike += !tree.contains(beside) || near.center_label[tree.offset(tree.leaf_over(beside).low)] == label;
  }
  return alike < min_alike;
}

// A node that has few alike around has a leaf with nodes of several labels.
bool is_delicate(const Lattice& lattice, const Leaf& leaf) {
  const auto& [tree, near] = lattice;
  const auto label = near.center_label[tree.offset(leaf.low)];
  bool is_mixed = false;
  for (std::int32_t corner = 0; corner < 8 && !is_mixed; ++corner)
    is_mixed = near.corner_label[tree.corner_offset(corner_of(leaf, corner))] != label;
  if (!is_mixed) return false;
  if (is_center_delicate(lattice, leaf)) return true;
  for (std::int32_t corner = 0; corner < 8; ++corner)
    if (is_corner_delicate(lattice, corner_of(leaf, corner))) return true;
  return false;
}

}  // namespace

LatticePart under_resolved_part(const Lattice& lattice) {
  const auto& tree = lattice.tree;
  const auto find = [&](std::int64_t begin, std::int64_t end, std::vector<Leaf>& found) {
    for (auto l = begin; l < end; ++l) {
      const Leaf& leaf = tree.leaves[static_cast<std::size_t>(l)];
      if (lattice.near.is_near[tree.offset(leaf.low)] != 0 && is_delicate(lattice, leaf)) found.push_back(leaf);
    }
  };
  const auto leaves = parallel::gather<Leaf>(0, static_cast<std::int64_t>(tree.leaves.size()), find);
  LatticePart part{lattice, {}};
  auto& is_near = part.lattice.near.is_near;
  std::fill(is_near.begin(), is_near.end(), std::uint8_t{0});
  for (const auto& leaf : leaves) is_near[tree.offset(leaf.low)] = 1;
  part.is_core = is_near;
  // Where the part ends, labels settle otherwise than in the whole: it takes two leaves until that is forgotten.
  const auto around = add_leaves_around(tree, leaves, Sharing::corner, part.lattice.near);
  add_leaves_around(tree, around, Sharing::face, part.lattice.near);
  return part;
}

bool is_in_core(const LatticePart& part, const Vec3& position_mm) {
  const auto& tree = part.lattice.tree;
  const TreeIndex at = tree.finest_cell_at(position_mm);
  return tree.contains(at) && part.is_core[tree.offset(tree.leaf_over(at).low)] != 0;
}

}  // namespace heartgen::stuffing
