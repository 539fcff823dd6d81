// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/atlas/exnode_geometry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "model/error.hpp"
#include "model/mathematics.hpp"

namespace heartgen::atlas::exnode {
namespace {

[[noreturn]] void fail_element(const std::string& path, const std::string& what) {
  throw UserError(what, path, "check that the .exnode and .exelem files belong together");
}

/// An angle falls along xi1, and the element's four edges in that direction lie in the same turn.
void unwind(Contributions& angle) {
  constexpr double turn = 2 * std::numbers::pi;
  for (std::size_t c = 0; c < corners; c += 2) {
    auto &first = angle[c][0], &second = angle[c + 1][0];
    if (first < second) first += turn;
    const double turns = std::round((angle[0][0] + angle[1][0] - first - second) / (2 * turn));
    first += turns * turn;
    second += turns * turn;
  }
}

Contributions contributions(const std::string& path, const NodeFile& nodes, const ExElement& element,
                            const ExComponent& component) {
  Contributions all;
  const auto wanted = std::size_t{1} << std::count(component.hermite.begin(), component.hermite.end(), true);
  for (std::size_t c = 0; c < corners; ++c) {
    const auto local = component.node[c];
    const auto node = local < element.nodes.size() ? nodes.nodes.find(element.nodes[local]) : nodes.nodes.end();
    if (node == nodes.nodes.end()) fail_element(path, "an element names a node that does not exist");
    const auto& layout = nodes.layouts[node->second.layout];
    const auto start = layout.find(component.name);
    if (start == layout.end() || component.value[c].size() != wanted || component.scale[c].size() != wanted)
      fail_element(path, fmt::format("values of \"{}\" are missing", component.name));
    for (std::size_t v = 0; v < wanted; ++v) {
      const auto at = start->second + component.value[c][v], scale = component.scale[c][v];
      if (at >= node->second.values.size() || scale >= element.scale.size())
        fail_element(path, fmt::format("values of \"{}\" end early", component.name));
      all[c].push_back(node->second.values[at] * element.scale[scale]);
    }
  }
  if (component.decreasing) unwind(all);
  return all;
}

/// One-dimensional basis function of an end (0 or 1), of its value or its derivative, and that function's slope.
struct Basis {
  double value, slope;
};

Basis basis_at(bool hermite, bool end, bool derivative, double x) {
  if (!hermite) return end ? Basis{x, 1} : Basis{1 - x, -1};
  if (!derivative)
    return end ? Basis{x * x * (3 - 2 * x), 6 * x * (1 - x)} : Basis{1 - x * x * (3 - 2 * x), 6 * x * (x - 1)};
  return end ? Basis{x * x * (x - 1), x * (3 * x - 2)} : Basis{x * (1 - x) * (1 - x), (1 - x) * (1 - 3 * x)};
}

/// A component and its derivatives by xi.
struct Jet {
  double value = 0;
  std::array<double, 3> slope{};
};

Jet evaluate(const ExComponent& component, const Contributions& from, const Vec3& xi) {
  Jet jet;
  for (std::size_t c = 0; c < corners; ++c)
    for (std::size_t v = 0; v < from[c].size(); ++v) {
      std::array<Basis, 3> basis;
      std::size_t bits = v;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const bool derivative = component.hermite[axis] && (bits & 1);
        if (component.hermite[axis]) bits >>= 1;
        basis[axis] = basis_at(component.hermite[axis], (c >> axis) & 1, derivative, xi[static_cast<int>(axis)]);
      }
      jet.value += from[c][v] * basis[0].value * basis[1].value * basis[2].value;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t b = (axis + 1) % 3, d = (axis + 2) % 3;
        jet.slope[axis] += from[c][v] * basis[axis].slope * basis[b].value * basis[d].value;
      }
    }
  return jet;
}

Place place_of(const ElementKind& kind, const std::array<Jet, 3>& c) {
  Place place;
  if (!kind.prolate) {
    place.position = {c[0].value, c[1].value, c[2].value};
    for (std::size_t a = 0; a < 3; ++a) place.slope[a] = {c[0].slope[a], c[1].slope[a], c[2].slope[a]};
    return place;
  }
  const double f = kind.focus, ch = math::cosh(c[0].value), sh = math::sinh(c[0].value);
  const double cm = math::cos(c[1].value), sm = math::sin(c[1].value);
  const double ct = math::cos(c[2].value), st = math::sin(c[2].value);
  place.position = f * Vec3{ch * cm, sh * sm * ct, sh * sm * st};
  for (std::size_t a = 0; a < 3; ++a)
    place.slope[a] = (f * c[0].slope[a]) * Vec3{sh * cm, ch * sm * ct, ch * sm * st} +
                     (f * c[1].slope[a]) * Vec3{-ch * sm, sh * cm * ct, sh * cm * st} +
                     (f * c[2].slope[a]) * Vec3{0, -sh * sm * st, sh * sm * ct};
  return place;
}

/// Zero where the element is collapsed.
Vec3 fiber_of(const Place& place, double fiber_angle, double imbrication_angle) {
  const Vec3 along = normalized(place.slope[0]), normal = normalized(cross(along, place.slope[1]));
  const Vec3 fiber = math::cos(fiber_angle) * along + math::sin(fiber_angle) * cross(normal, along);
  return normal == Vec3{} ? Vec3{} : math::cos(imbrication_angle) * fiber + math::sin(imbrication_angle) * normal;
}

}  // namespace

Evaluator::Evaluator(const std::string& path, const NodeFile& nodes, const ElementFile& file, const ExElement& element)
    : kind(file.kinds[element.kind]) {
  const auto find = [&](const std::string& name) {
    const auto at = std::find_if(kind.components.begin(), kind.components.end(),
                                 [&](const ExComponent& c) { return c.name == name; });
    if (name.empty() || at == kind.components.end())
      fail_element(path, "an element lacks coordinates or an anatomical field of fibre angles");
    return &*at;
  };
  for (std::size_t a = 0; a < 3; ++a) {
    coordinate[a] = find(kind.coordinate[a]);
    position[a] = contributions(path, nodes, element, *coordinate[a]);
  }
  for (std::size_t a = 0; a < 2; ++a) {
    angle[a] = find(kind.angle[a]);
    turn[a] = contributions(path, nodes, element, *angle[a]);
  }
}

Place Evaluator::place(const Vec3& xi) const {
  std::array<Jet, 3> jets;
  for (std::size_t a = 0; a < 3; ++a) jets[a] = evaluate(*coordinate[a], position[a], xi);
  return place_of(kind, jets);
}

Vec3 Evaluator::fiber(const Vec3& xi) const {
  return fiber_of(place(xi), evaluate(*angle[0], turn[0], xi).value, evaluate(*angle[1], turn[1], xi).value);
}

}  // namespace heartgen::atlas::exnode
