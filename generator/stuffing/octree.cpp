// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/stuffing/octree.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "generator/parallel/gather.hpp"
#include "generator/parallel/threads.hpp"

namespace heartgen::stuffing {
namespace {

constexpr int deepest = 5;              // root cells are at most 32 finest cells wide
constexpr std::int32_t min_roots = 12;  // along the shortest axis: rounding stretches cells by 4 % at most

/// The finest level that is needed inside each cell of one level; its cells are 2^level finest cells wide.
struct Level {
  TreeIndex size;
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
  while (level < deepest && shortest / static_cast<double>(2 << level) >= min_roots) ++level;
  return level;
}

/// The level of cells, counted from cells `cell_mm` wide, whose lattice has edges of about a length.
std::int32_t level_of(double edge_mm, double cell_mm, std::int32_t root) {
  const double ratio = edge_mm / (mean_edge_per_cell * cell_mm);
  std::int32_t allowed = 0;
  while (allowed < root && ratio > std::ldexp(1.41, allowed)) ++allowed;
  return allowed;
}

Vec3 center_of(const BoxCells& cells, std::int32_t i, std::int32_t j, std::int32_t k) {
  const Vec3& step = cells.step_mm;
  return cells.origin_mm + Vec3{(i + 0.5) * step.x, (j + 0.5) * step.y, (k + 0.5) * step.z};
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

using EdgeAt = std::function<double(const Vec3&)>;

// How often the finest cells are halved so that they are about as short as the spots wish.
int extra_levels(const BoxCells& cells, const EdgeAt& edge_mm, const std::vector<tetmesh::FineSpot>& spots) {
  constexpr double max_finest_cells = 5e7;
  const double count = static_cast<double>(cells.size[0]) * cells.size[1] * cells.size[2];
  int extra = 0;
  for (const auto& spot : spots) {
    const double wanted = std::ldexp(edge_mm(spot.center_mm), -spot.halvings) / mean_edge_per_cell;
    while (std::ldexp(cells.mean_step_mm, -extra) > std::numbers::sqrt2 * wanted &&
           std::ldexp(count, 3 * (extra + 1)) < max_finest_cells)
      ++extra;
  }
  return extra;
}

BoxCells halved(const BoxCells& cells, int times) {
  BoxCells fine = cells;
  for (auto& size : fine.size) size <<= times;
  fine.step_mm = std::ldexp(1.0, -times) * cells.step_mm;
  fine.mean_step_mm = std::ldexp(cells.mean_step_mm, -times);
  fine.root += times;
  return fine;
}

// Only the finest cells in a spot are looked at: of all of the box there may be many more. Those of level 0 need no
// entry: they are never divided.
void lower_in_spot(std::vector<Level>& levels, const BoxCells& r, const EdgeAt& edge_mm,
                   const tetmesh::FineSpot& spot) {
  TreeIndex low, high;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const double center = (spot.center_mm[axis] - r.origin_mm[axis]) / r.step_mm[axis],
                 reach = spot.radius_mm / r.step_mm[axis];
    low[a] = std::max(0, static_cast<std::int32_t>(std::floor(center - reach)));
    high[a] = std::min(r.size[a], static_cast<std::int32_t>(std::ceil(center + reach)));
  }
  for (std::int32_t k = low[2]; k < high[2]; ++k)
    for (std::int32_t j = low[1]; j < high[1]; ++j)
      for (std::int32_t i = low[0]; i < high[0]; ++i) {
        const Vec3 center = center_of(r, i, j, k), way = center - spot.center_mm;
        if (dot(way, way) >= spot.radius_mm * spot.radius_mm) continue;
        const auto wanted =
            static_cast<std::uint8_t>(level_of(std::ldexp(edge_mm(center), -spot.halvings), r.mean_step_mm, r.root));
        for (int number = 1; number <= r.root; ++number) {
          auto& value = levels[static_cast<std::size_t>(number)].at(i >> number, j >> number, k >> number);
          value = std::min(value, wanted);
        }
      }
}

// Of the cells of all levels, finest first; none of level 0 where there are spots.
std::vector<Level> make_levels(const WantedLevels& wanted, const BoxCells& finest, const EdgeAt& edge_mm,
                               const std::vector<tetmesh::FineSpot>& spots) {
  std::vector<Level> levels{{wanted.cells.size, wanted.level}};
  for (int number = 1; number <= wanted.cells.root; ++number) levels.push_back(coarser(levels.back()));
  const int extra = finest.root - wanted.cells.root;
  for (auto& level : levels)
    for (auto& value : level.finest) value = static_cast<std::uint8_t>(value + extra);
  for (int number = extra - 1; number >= 0; --number) {
    const TreeIndex size{finest.size[0] >> number, finest.size[1] >> number, finest.size[2] >> number};
    const auto cells =
        static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2]);
    levels.insert(levels.begin(), {size, std::vector<std::uint8_t>(number > 0 ? cells : 0, extra)});
  }
  for (const auto& spot : spots) lower_in_spot(levels, finest, edge_mm, spot);
  return levels;
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

// Of one root cell, along a space-filling curve.
void add_leaves(std::vector<Level>& levels, const TreeIndex& cell, int number, std::vector<Leaf>& leaves) {
  if (number > 0 && levels[static_cast<std::size_t>(number)].at(cell[0], cell[1], cell[2]) < number) {
    for (std::int32_t child = 0; child < 8; ++child)
      add_leaves(levels, {2 * cell[0] + (child & 1), 2 * cell[1] + ((child >> 1) & 1), 2 * cell[2] + (child >> 2)},
                 number - 1, leaves);
    return;
  }
  leaves.push_back({{cell[0] << number, cell[1] << number, cell[2] << number}, number});
}

std::vector<Leaf> leaves_of(std::vector<Level>& levels, const BoxCells& cells) {
  const std::int64_t nx = cells.size[0] >> cells.root, ny = cells.size[1] >> cells.root,
                     nz = cells.size[2] >> cells.root;
  const auto find = [&](std::int64_t begin, std::int64_t end, std::vector<Leaf>& leaves) {
    for (auto r = begin; r < end; ++r)
      add_leaves(levels,
                 {static_cast<std::int32_t>(r % nx), static_cast<std::int32_t>(r / nx % ny),
                  static_cast<std::int32_t>(r / (nx * ny))},
                 cells.root, leaves);
  };
  return parallel::gather<Leaf>(0, nx * ny * nz, find);
}

void note_levels(Octree& tree) {
  tree.level.resize(tree.offset({0, 0, tree.size[2]}));
  parallel::parallel_for(0, std::ssize(tree.leaves), [&](std::int64_t begin, std::int64_t end) {
    for (auto l = begin; l < end; ++l) {
      const auto& [low, number] = tree.leaves[static_cast<std::size_t>(l)];
      const std::int32_t width = 1 << number;
      for (std::int32_t k = 0; k < width; ++k)
        for (std::int32_t j = 0; j < width; ++j)
          std::fill_n(tree.level.begin() + static_cast<std::ptrdiff_t>(tree.offset({low[0], low[1] + j, low[2] + k})),
                      width, static_cast<std::uint8_t>(number));
    }
  });
}

}  // namespace

bool is_leaf_corner(const Octree& tree, const TreeIndex& at) {
  for (std::int32_t cell = 0; cell < 8; ++cell) {
    const TreeIndex beside{at[0] - (cell & 1), at[1] - ((cell >> 1) & 1), at[2] - (cell >> 2)};
    if (!tree.contains(beside)) continue;
    const std::int32_t rest = (1 << tree.level[tree.offset(beside)]) - 1;
    if (((at[0] | at[1] | at[2]) & rest) == 0) return true;
  }
  return false;
}

WantedLevels wanted_levels(const Vec3& box_min_mm, const Vec3& box_max_mm, double finest_edge_mm,
                           const std::function<double(const Vec3&)>& edge_mm) {
  const Vec3 box = box_max_mm - box_min_mm;
  WantedLevels wanted;
  auto& cells = wanted.cells;
  cells.origin_mm = box_min_mm;
  cells.mean_step_mm = finest_edge_mm / mean_edge_per_cell;
  cells.root = root_level(box, cells.mean_step_mm);
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const auto roots = std::max<std::int64_t>(1, std::llround(box[axis] / std::ldexp(cells.mean_step_mm, cells.root)));
    cells.size[a] = static_cast<std::int32_t>(roots << cells.root);
    cells.step_mm[axis] = box[axis] / static_cast<double>(cells.size[a]);
  }
  const auto slice = static_cast<std::size_t>(cells.size[0]) * static_cast<std::size_t>(cells.size[1]);
  wanted.level.resize(slice * static_cast<std::size_t>(cells.size[2]));
  parallel::parallel_for(0, cells.size[2], [&](std::int64_t begin, std::int64_t end) {
    for (auto k = static_cast<std::int32_t>(begin); k < end; ++k) {
      auto* level = wanted.level.data() + slice * static_cast<std::size_t>(k);
      for (std::int32_t j = 0; j < cells.size[1]; ++j)
        for (std::int32_t i = 0; i < cells.size[0]; ++i)
          *level++ =
              static_cast<std::uint8_t>(level_of(edge_mm(center_of(cells, i, j, k)), cells.mean_step_mm, cells.root));
    }
  });
  return wanted;
}

Octree make_octree(const WantedLevels& wanted, const std::function<double(const Vec3&)>& edge_mm,
                   const std::vector<tetmesh::FineSpot>& spots) {
  const auto finest = halved(wanted.cells, extra_levels(wanted.cells, edge_mm, spots));
  auto levels = make_levels(wanted, finest, edge_mm, spots);
  for (int number = 1; number < finest.root; ++number)
    divide_parents(levels[static_cast<std::size_t>(number)], levels[static_cast<std::size_t>(number) + 1], number);
  Octree tree{finest.origin_mm, finest.step_mm, finest.size, leaves_of(levels, finest), {}};
  note_levels(tree);
  return tree;
}

}  // namespace heartgen::stuffing
