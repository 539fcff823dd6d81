// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The text of .exnode and .exelem files as plain data, not yet evaluated. Private to exnode.
#pragma once
#include <array>
#include <map>
#include <string>
#include <vector>

namespace heartgen::atlas::exnode {

constexpr std::size_t corners = 8;

struct ExNode {
  std::size_t layout = 0;  ///< which layout its values have
  std::vector<double> values;
};

struct NodeFile {
  /// Where a component ("field/component") begins in a node's values.
  std::vector<std::map<std::string, std::size_t>> layouts;
  std::map<int, ExNode> nodes;
};

/// Throws UserError where the file cannot be read, naming file and line.
NodeFile read_nodes(const std::string& path);

/// How a component follows from the values at the corners.
struct ExComponent {
  std::string name;                                            ///< "field/component"
  std::array<bool, 3> hermite{};                               ///< along each axis; else linear
  bool decreasing = false;                                     ///< an angle that must fall along xi1
  std::array<std::vector<std::size_t>, corners> value, scale;  ///< 0-based places
  std::array<std::size_t, corners> node{};  ///< 0-based place in the element's list: fewer nodes where it is collapsed
};

struct ElementKind {
  bool prolate = false;
  double focus = 0;
  std::array<std::string, 3> coordinate, angle;  ///< names of components
  std::vector<ExComponent> components;
};

struct ExElement {
  std::size_t kind = 0;
  std::vector<int> nodes;
  std::vector<double> scale;
};

struct ElementFile {
  std::vector<ElementKind> kinds;
  std::vector<ExElement> elements;
};

/// The three-dimensional elements. Throws UserError as read_nodes does.
ElementFile read_elements(const std::string& path);

}  // namespace heartgen::atlas::exnode
