// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Elements of .exelem files as functions of their own coordinates: positions and fibres. Private to exnode.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "generator/atlas/exnode_text.hpp"
#include "model/vec.hpp"

namespace heartgen::atlas::exnode {

/// What each corner contributes: its values times scale factors, in the order value, d/ds of the first Hermite axis, of
/// the second, of both, and so on.
using Contributions = std::array<std::vector<double>, corners>;

/// Position and its derivatives by xi.
struct Place {
  Vec3 position;
  std::array<Vec3, 3> slope;
};

/// One element with the contributions of its coordinates and angles. Refers to the file, which must outlive it.
struct Evaluator {
  const ElementKind& kind;
  std::array<const ExComponent*, 3> coordinate{};
  std::array<Contributions, 3> position;
  std::array<const ExComponent*, 2> angle{};  ///< fibre and imbrication
  std::array<Contributions, 2> turn;

  /// Throws UserError where values are missing.
  Evaluator(const std::string& path, const NodeFile& nodes, const ElementFile& file, const ExElement& element);

  Place place(const Vec3& xi) const;
  /// Zero where the element is collapsed.
  Vec3 fiber(const Vec3& xi) const;
};

}  // namespace heartgen::atlas::exnode
