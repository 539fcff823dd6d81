// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What a .msh file says, in its own numbers: between its text and the mesh.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "model/unstructured_data.hpp"

namespace heartgen::mesh_files {

/// A model entity of version 4.1, whole or one partition's part.
struct MshEntity {
  std::vector<std::int32_t> groups;  ///< physical tags; negative: turned over
  int parent_dimension = -1;         ///< of the entity that it is a part of
  std::int32_t parent_tag = 0;
};

/// Elements of one kind with N nodes.
template <std::size_t N>
struct MshElements {
  std::vector<std::int64_t> id;
  std::vector<std::array<std::int64_t, N>> nodes;
  std::vector<std::int32_t> entity;
  std::vector<std::int32_t> group;  ///< in 2.2: 0 where the file gives none; in 4.1: 0, the entity knows
};

/// $NodeData or $ElementData.
struct MshView {
  bool is_on_nodes = true;
  std::string name;
  int step = 0, components = 1;
  std::vector<std::int64_t> id;
  std::vector<double> values;  ///< components per id
};

struct MshContent {
  GroupNames names;
  std::map<std::pair<int, std::int32_t>, MshEntity> entities;
  std::vector<std::int64_t> node_id;
  std::vector<Vec3> nodes;
  MshElements<4> tets;
  MshElements<3> triangles;
  OtherCells other;
  std::vector<MshView> views;
  std::map<std::string, std::size_t> other_sections;  ///< that hold more than comments, and how many of each
};

/// Throws UserError for another kind of file, other versions, and what is cut off or contradicts itself.
MshContent read_msh_content(const std::filesystem::path& path);

/// Numbers become places, groups become the arrays "region", views become arrays. Throws UserError.
UnstructuredData mesh_of(const MshContent& content, const std::filesystem::path& path);

}  // namespace heartgen::mesh_files
