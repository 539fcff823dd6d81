#include "generator/lattice/octree.hpp"

#include <algorithm>
#include <cmath>

#include "generator/parallel/threads.hpp"

namespace heart::lattice {
namespace {

constexpr int deepest = 5;                 // root cells are at most 32 finest cells wide
constexpr std::int32_t fewest_roots = 12;  // along the shortest axis: rounding stretches cells by 4 % at most

/// The finest level that is needed inside each cell of one level; its cells are 2^level finest cells wide.
struct Level {
  Place size;
  std::vector<std::uint8_t> finest;
  std::uint8_t& at(std::int32_t i, std::int32_t j, std::int32_t k) {
    return finest[(static_cast<std::size_t>(k) * static_cast<std::size_t>(size[1]) + static_cast<std::size_t>(j)) *
                      static_cast<std::size_t>(size[0]) +
                  static_cast<std::size_t>(i)];
  }
};

int root_level(const Vec3& box_mm, double cell_mm) {
  const double shortest = std::min({box_mm.x, box_mm.y, box_mm.z}) / cell_mm;
  int level = 0;
  while (level < deepest && shortest / static_cast<double>(2 << level) >= fewest_roots) ++level;
  return level;
}

Level finest_level(const Octree& tree, int root, double cell_mm, const std::function<double(const Vec3&)>& edge_mm) {
  Level level{tree.size, std::vector<std::uint8_t>(tree.level.size())};
  parallel::parallel_for(0, tree.size[2], [&](std::int64_t begin, std::int64_t end) {
    for (auto k = static_cast<std::int32_t>(begin); k < end; ++k)
      for (std::int32_t j = 0; j < tree.size[1]; ++j)
        for (std::int32_t i = 0; i < tree.size[0]; ++i) {
          const Vec3 center{(i + 0.5) * tree.step_mm.x, (j + 0.5) * tree.step_mm.y, (k + 0.5) * tree.step_mm.z};
          const double ratio = edge_mm(tree.origin_mm + center) / (mean_edge_per_cell * cell_mm);
          int allowed = 0;
          for (double limit = 1.41; allowed < root && ratio > limit; limit *= 2) ++allowed;
          level.at(i, j, k) = static_cast<std::uint8_t>(allowed);
        }
  });
  return level;
}

Level coarser(Level& fine) {
  Level coarse{{fine.size[0] / 2, fine.size[1] / 2, fine.size[2] / 2}, {}};
  coarse.finest.resize(fine.finest.size() / 8, 255);
  for (std::int32_t k = 0; k < fine.size[2]; ++k)
    for (std::int32_t j = 0; j < fine.size[1]; ++j)
      for (std::int32_t i = 0; i < fine.size[0]; ++i) {
        auto& value = coarse.at(i / 2, j / 2, k / 2);
        value = std::min(value, fine.at(i, j, k));
      }
  return coarse;
}

// Where a cell is divided, its 18 neighbours exist: their parents are divided too.
void divide_parents(Level& level, Level& parents, int number) {
  const auto divide = [&](std::int32_t i, std::int32_t j, std::int32_t k) {
    if (i < 0 || j < 0 || k < 0 || i >= level.size[0] || j >= level.size[1] || k >= level.size[2]) return;
    auto& value = parents.at(i / 2, j / 2, k / 2);
    value = std::min(value, static_cast<std::uint8_t>(number));
  };
  for (std::int32_t k = 0; k < level.size[2]; ++k)
    for (std::int32_t j = 0; j < level.size[1]; ++j)
      for (std::int32_t i = 0; i < level.size[0]; ++i) {
        if (level.at(i, j, k) >= number) continue;
        for (int dk = -1; dk <= 1; ++dk)
          for (int dj = -1; dj <= 1; ++dj)
            for (int di = -1; di <= 1; ++di)
              if (di == 0 || dj == 0 || dk == 0) divide(i + di, j + dj, k + dk);
      }
}

void add_leaves(Octree& tree, std::vector<Level>& levels, const Place& cell, int number) {
  auto& level = levels[static_cast<std::size_t>(number)];
  if (level.at(cell[0], cell[1], cell[2]) < number) {
    for (std::int32_t child = 0; child < 8; ++child)
      add_leaves(tree, levels,
                 {2 * cell[0] + (child & 1), 2 * cell[1] + ((child >> 1) & 1), 2 * cell[2] + (child >> 2)}, number - 1);
    return;
  }
  const std::int32_t width = 1 << number;
  const Place low{cell[0] * width, cell[1] * width, cell[2] * width};
  tree.leaves.push_back({low, number});
  for (std::int32_t k = 0; k < width; ++k)
    for (std::int32_t j = 0; j < width; ++j)
      std::fill_n(tree.level.begin() + static_cast<std::ptrdiff_t>(tree.offset({low[0], low[1] + j, low[2] + k})),
                  width, static_cast<std::uint8_t>(number));
}

}  // namespace

bool is_leaf_corner(const Octree& tree, const Place& at) {
  for (std::int32_t cell = 0; cell < 8; ++cell) {
    const Place beside{at[0] - (cell & 1), at[1] - ((cell >> 1) & 1), at[2] - (cell >> 2)};
    if (!tree.contains(beside)) continue;
    const std::int32_t rest = (1 << tree.level[tree.offset(beside)]) - 1;
    if (((at[0] | at[1] | at[2]) & rest) == 0) return true;
  }
  return false;
}

Octree make_octree(const Vec3& box_min_mm, const Vec3& box_max_mm, double finest_edge_mm,
                   const std::function<double(const Vec3&)>& edge_mm) {
  const double cell_mm = finest_edge_mm / mean_edge_per_cell;
  const Vec3 box = box_max_mm - box_min_mm;
  const int root = root_level(box, cell_mm);
  const std::int32_t width = 1 << root;
  Octree tree;
  tree.origin_mm = box_min_mm;
  for (int axis = 0; axis < 3; ++axis) {
    const auto roots = std::max<std::int64_t>(1, std::llround(box[axis] / (cell_mm * width)));
    tree.size[static_cast<std::size_t>(axis)] = static_cast<std::int32_t>(roots) * width;
    tree.step_mm[axis] = box[axis] / static_cast<double>(tree.size[static_cast<std::size_t>(axis)]);
  }
  tree.level.resize(tree.offset({0, 0, tree.size[2]}));
  std::vector<Level> levels{finest_level(tree, root, cell_mm, edge_mm)};
  for (int number = 1; number <= root; ++number) levels.push_back(coarser(levels.back()));
  for (int number = 1; number < root; ++number)
    divide_parents(levels[static_cast<std::size_t>(number)], levels[static_cast<std::size_t>(number) + 1], number);
  const Place roots{tree.size[0] / width, tree.size[1] / width, tree.size[2] / width};
  for (std::int32_t k = 0; k < roots[2]; ++k)
    for (std::int32_t j = 0; j < roots[1]; ++j)
      for (std::int32_t i = 0; i < roots[0]; ++i) add_leaves(tree, levels, {i, j, k}, root);
  return tree;
}

}  // namespace heart::lattice
