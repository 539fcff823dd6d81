// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Work on a mesh by several threads at once: slabs across its longest axis, every other one at the same time. What is
/// done depends on the slabs, which only the mesh decides, and not on the threads.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "generator/parallel/tasks.hpp"
#include "generator/tetmesh/complex.hpp"

namespace heartgen::tetmesh {

struct Slabs {
  int axis = 0;
  double low_mm = 0, step_mm = 1;
  std::size_t count = 1;
  std::size_t of(const Vec3& p) const;
};

/// At most `max_slabs`, each at least so many cells wide: with 1, no two nodes of slabs that are not neighbours share
/// a cell.
Slabs slabs_across(const Complex& complex, int cells, std::size_t max_slabs);

/// Calls work(i) once for each of `count` items: in the order of the items inside a slab, first in all slabs with even
/// numbers, then in the others. `place(i)` is where item i lies before the work begins. Items of different slabs of one
/// kind must not touch the same data.
template <class PlaceOf, class Work>
void for_slabs(const Slabs& slabs, std::size_t count, PlaceOf&& place, Work&& work) {
  std::vector<std::vector<std::uint32_t>> items(slabs.count);
  for (std::size_t i = 0; i < count; ++i) items[slabs.of(place(i))].push_back(static_cast<std::uint32_t>(i));
  for (const std::size_t first : {0U, 1U}) {
    std::vector<std::function<void()>> tasks;
    for (std::size_t s = first; s < slabs.count; s += 2)
      tasks.emplace_back([&, s] {
        for (const auto i : items[s]) work(static_cast<std::size_t>(i));
      });
    parallel::run_tasks(tasks);
  }
}

}  // namespace heartgen::tetmesh
