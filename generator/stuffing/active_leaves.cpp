// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/stuffing/active_leaves.hpp"

#include <algorithm>
#include <array>

#include "generator/parallel/gather.hpp"
#include "generator/parallel/threads.hpp"
#include "generator/tetmesh/shared_marks.hpp"

namespace heartgen::stuffing {
namespace {

// Every corner of a leaf is the first of the leaf over it, or no leaf's first.
void label_corners(const Octree& tree, const std::function<int(const Vec3&)>& label_at, NearLeaves& near) {
  near.corner_label.resize(tree.corner_offset({0, 0, tree.size[2] + 1}));
  const auto is_first = [&](const TreeIndex& at) { return tree.contains(at) && tree.leaf_over(at).low == at; };
  parallel::parallel_for(0, static_cast<std::int64_t>(tree.leaves.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto l = static_cast<std::size_t>(begin); l < static_cast<std::size_t>(end); ++l) {
      const Leaf& leaf = tree.leaves[l];
      for (std::int32_t corner = 0; corner < 8; ++corner) {
        const TreeIndex at = corner_of(leaf, corner);
        if (corner != 0 && is_first(at)) continue;
        const Vec3 position =
            tree.position_mm({static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2])});
        tetmesh::set_to(near.corner_label[tree.corner_offset(at)], static_cast<std::uint8_t>(label_at(position)));
      }
    }
  });
}

// Corners of finer leaves on its faces and edges count: half-way between its own.
bool has_labelled_corner(const Octree& tree, const Leaf& leaf, const NearLeaves& near) {
  const std::int32_t width = 1 << leaf.level, step = leaf.level == 0 ? 1 : width / 2;
  for (std::int32_t k = 0; k <= width; k += step)
    for (std::int32_t j = 0; j <= width; j += step)
      for (std::int32_t i = 0; i <= width; i += step)
        if (near.corner_label[tree.corner_offset({leaf.low[0] + i, leaf.low[1] + j, leaf.low[2] + k})] != 0)
          return true;
  return false;
}

bool has_unlabelled_corner(const Octree& tree, const Leaf& leaf, const NearLeaves& near) {
  for (std::int32_t corner = 0; corner < 8; ++corner)
    if (near.corner_label[tree.corner_offset(corner_of(leaf, corner))] == 0) return true;
  return false;
}

// The lattice has a node in the middle of a leaf's face in a side of the box.
bool has_labelled_side(const Octree& tree, const Leaf& leaf, const std::function<int(const Vec3&)>& label_at) {
  const std::int32_t width = 1 << leaf.level;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const std::int32_t plane : {leaf.low[axis], leaf.low[axis] + width}) {
      if (plane != 0 && plane != tree.size[axis]) continue;
      std::array<double, 3> middle;
      for (std::size_t a = 0; a < 3; ++a) middle[a] = leaf.low[a] + 0.5 * width;
      middle[axis] = plane;
      if (label_at(tree.position_mm(middle)) != 0) return true;
    }
  return false;
}

void label_leaves(const Octree& tree, const std::function<int(const Vec3&)>& label_at, NearLeaves& near) {
  near.center_label.resize(tree.level.size());
  near.is_near.resize(tree.level.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(tree.leaves.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto l = static_cast<std::size_t>(begin); l < static_cast<std::size_t>(end); ++l) {
      const Leaf& leaf = tree.leaves[l];
      const double half = 0.5 * (1 << leaf.level);
      const int label = label_at(tree.position_mm({leaf.low[0] + half, leaf.low[1] + half, leaf.low[2] + half}));
      const auto at = tree.offset(leaf.low);
      near.center_label[at] = static_cast<std::uint8_t>(label);
      near.is_near[at] = label != 0 || has_labelled_corner(tree, leaf, near) || has_labelled_side(tree, leaf, label_at);
    }
  });
}

// Calls visit for the leaf on every side of one, and if that is smaller for those beside it on the same side too.
template <class Visit>
void for_leaves_around(const Octree& tree, const Leaf& leaf, Sharing sharing, const Visit& visit) {
  const std::int32_t width = 1 << leaf.level;
  const auto visit_over = [&](const TreeIndex& at) {
    const Leaf other = tree.leaf_over(at);
    visit(other);
    return other.level;
  };
  for (std::int32_t k = -1; k <= 1; ++k)
    for (std::int32_t j = -1; j <= 1; ++j)
      for (std::int32_t i = -1; i <= 1; ++i) {
        const TreeIndex side{i, j, k};
        const auto outside = std::ranges::count_if(side, [](std::int32_t d) { return d != 0; });
        if (outside == 0 || (sharing == Sharing::face && outside > 1)) continue;
        TreeIndex first = leaf.low;
        for (std::size_t a = 0; a < 3; ++a) first[a] += side[a] < 0 ? -1 : side[a] * width;
        if (!tree.contains(first) || visit_over(first) >= leaf.level) continue;
        for (std::int32_t other = 1; other < 8; ++other) {  // a bit for each axis
          TreeIndex at = first;
          bool is_beside = true;
          for (std::size_t a = 0; a < 3; ++a) {
            if ((other >> a & 1) == 0) continue;
            is_beside = is_beside && side[a] == 0;
            at[a] += width / 2;
          }
          if (is_beside) visit_over(at);
        }
      }
}

}  // namespace

std::vector<Leaf> add_leaves_around(const Octree& tree, const std::vector<Leaf>& leaves, Sharing sharing,
                                    NearLeaves& near) {
  const auto find = [&](std::int64_t begin, std::int64_t end, std::vector<Leaf>& found) {
    const auto add = [&](const Leaf& leaf) {
      if (tetmesh::set_first(near.is_near[tree.offset(leaf.low)], std::uint8_t{1})) found.push_back(leaf);
    };
    for (auto l = begin; l < end; ++l) for_leaves_around(tree, leaves[static_cast<std::size_t>(l)], sharing, add);
  };
  return parallel::gather<Leaf>(0, std::ssize(leaves), find);
}

NearLeaves active_leaves(const Octree& tree, const std::function<int(const Vec3&)>& label_at) {
  NearLeaves near;
  label_corners(tree, label_at, near);
  label_leaves(tree, label_at, near);
  const auto find = [&](std::int64_t begin, std::int64_t end, std::vector<Leaf>& found) {
    for (auto l = begin; l < end; ++l) {
      const Leaf& leaf = tree.leaves[static_cast<std::size_t>(l)];
      if (near.is_near[tree.offset(leaf.low)] != 0 && has_unlabelled_corner(tree, leaf, near)) found.push_back(leaf);
    }
  };
  // Around the others all leaves have a labelled corner.
  const auto labelled = parallel::gather<Leaf>(0, static_cast<std::int64_t>(tree.leaves.size()), find);
  const auto beside = add_leaves_around(tree, labelled, Sharing::face, near);
  add_leaves_around(tree, beside, Sharing::face, near);
  add_leaves_around(tree, labelled, Sharing::corner, near);
  return near;
}

}  // namespace heartgen::stuffing
