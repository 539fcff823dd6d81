// SPDX-License-Identifier: GPL-3.0-or-later
// Between numpy's arrays and heartgen's plain data. An array of an image is indexed [k, j, i] as it lies in memory.
#pragma once
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <heartgen/images.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace heartgen::python {

namespace py = pybind11;

template <class T>
using Array = py::array_t<T, py::array::c_style | py::array::forcecast>;

/// Where an array's voxels lie: spacing (x, y, z), origin (x, y, z) and direction (3 rows of 3) in LPS mm.
struct Geometry {
  std::array<double, 3> spacing{1, 1, 1}, origin{0, 0, 0};
  std::array<std::array<double, 3>, 3> direction{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
};

inline Geometry geometry_of(const Grid& grid) {
  Geometry g;
  for (int a = 0; a < 3; ++a) {
    const auto at = static_cast<std::size_t>(a);
    g.spacing[at] = grid.spacing_mm[a];
    g.origin[at] = grid.origin_mm[a];
    for (int b = 0; b < 3; ++b) g.direction[at][static_cast<std::size_t>(b)] = grid.direction[a][b];
  }
  return g;
}

/// Throws UserError for other arrays than of two or three dimensions, and spacings that are not positive.
template <class T>
Grid grid_of(const Array<T>& array, const Geometry& g) {
  if (array.ndim() != 2 && array.ndim() != 3)
    throw UserError("has " + std::to_string(array.ndim()) + " dimensions", "array", "give 2 (j, i) or 3 (k, j, i)");
  Grid grid;
  for (py::ssize_t axis = 0; axis < 3; ++axis)
    grid.size[static_cast<std::size_t>(axis)] = axis < array.ndim() ? array.shape(array.ndim() - 1 - axis) : 1;
  for (int a = 0; a < 3; ++a) {
    const auto at = static_cast<std::size_t>(a);
    if (!(g.spacing[at] > 0)) throw UserError("must be positive", "spacing", "give mm along x, y and z");
    grid.spacing_mm[a] = g.spacing[at];
    grid.origin_mm[a] = g.origin[at];
    for (int b = 0; b < 3; ++b) grid.direction[a][b] = g.direction[at][static_cast<std::size_t>(b)];
  }
  return grid;
}

/// One copy: a volume owns its voxels.
template <class T>
Volume<T> volume_of(const Array<T>& array, const Geometry& geometry) {
  Volume<T> volume;
  volume.grid = grid_of(array, geometry);
  volume.voxels.assign(array.data(), array.data() + array.size());
  return volume;
}

/// Numbers that numpy shows where they are; they live as long as the array.
template <class T, class Owned>
py::array_t<T> array_over(Owned&& values, std::vector<py::ssize_t> shape) {
  auto kept = std::make_unique<std::decay_t<Owned>>(std::forward<Owned>(values));
  const T* const data = reinterpret_cast<const T*>(kept->data());
  const py::capsule owner(kept.release(), [](void* held) { delete static_cast<std::decay_t<Owned>*>(held); });
  return py::array_t<T>(std::move(shape), data, owner);
}

/// Without a copy.
template <class T>
py::array_t<T> array_of(Volume<T>&& volume) {
  const auto& size = volume.grid.size;
  return array_over<T>(std::move(volume.voxels), {size[2], size[1], size[0]});
}

/// The array and its geometry, as Image takes them.
template <class T>
py::tuple image_of(Volume<T>&& volume) {
  const Geometry g = geometry_of(volume.grid);
  return py::make_tuple(array_of(std::move(volume)), g.spacing, g.origin, g.direction);
}

/// Runs work on plain data without Python's lock.
template <class Work>
auto unlocked(Work&& work) {
  const py::gil_scoped_release release;
  return work();
}

/// Throws UserError naming `where` for a value of another kind.
template <class T>
T value_of(const py::object& value, const std::string& where) {
  try {
    return py::cast<T>(value);
  } catch (const py::cast_error&) {
    throw UserError("is of another kind: " + py::cast<std::string>(py::repr(value)), where,
                    "docs/inputs.md has the recipe's settings");
  }
}

/// Sets members of a settings struct by their names. Throws UserError for a name that it does not have.
template <class Settings>
void set_members(Settings& settings, const py::dict& given, const std::string& section) {
  std::vector<std::string> names;
  Settings::describe(
      [&](const char* key, auto& member, const char*) {
        using Member = std::decay_t<decltype(member)>;
        names.emplace_back(key);
        if constexpr (std::is_default_constructible_v<py::detail::make_caster<Member>>)
          if (given.contains(key)) member = value_of<Member>(given[key], section + ": " + key);
      },
      settings);
  for (const auto& [key, value] : given) {
    const auto name = py::cast<std::string>(key);
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    std::string known;
    for (const auto& one : names) known += (known.empty() ? "" : ", ") + one;
    throw UserError("has no setting \"" + name + "\"", section, "its settings: " + known);
  }
}

}  // namespace heartgen::python
