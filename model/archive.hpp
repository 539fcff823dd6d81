// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Plain data as bytes in this machine's own layout: for the cache, and on the way from one process to another.
/// Which members a struct has is said once, by `members` in the struct's namespace; a member that it forgets does not
/// compile.
#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "model/tet_mesh.hpp"
#include "model/unstructured_data.hpp"
#include "model/volume.hpp"

namespace heartgen {

template <class T>
auto members(Volume<T>& v) {
  return std::tie(v.grid, v.voxels);
}
inline auto members(Rim& r) { return std::tie(r.name, r.tag, r.nodes); }
inline auto members(FiberField& f) { return std::tie(f.fiber, f.sheet, f.sheet_normal); }
inline auto members(UserRegion& r) { return std::tie(r.name, r.tag, r.fraction); }
inline auto members(Cavity& c) { return std::tie(c.name, c.region, c.faces, c.surface); }
inline auto members(TetMesh& m) {
  return std::tie(m.nodes_mm, m.cells, m.region, m.faces, m.surface, m.rims, m.node_fibers, m.cell_fibers,
                  m.fiber_source, m.rule_difference_deg, m.user_regions, m.user_region, m.cavities, m.parent_node,
                  m.parent_cell);
}
/// As a file of VTK holds it: without names of groups.
inline auto members(UnstructuredData& m) {
  return std::tie(m.points, m.tets, m.point_scalars, m.cell_scalars, m.point_vectors, m.cell_vectors, m.point_tensors,
                  m.cell_tensors, m.faces, m.face_scalars, m.face_vectors, m.face_tensors, m.integers, m.remarks);
}

/// Members that `members` leaves out on purpose.
template <class T>
constexpr std::size_t members_left_out = 0;
template <>
constexpr std::size_t members_left_out<UnstructuredData> = 1;  // names of groups
template <>
constexpr std::size_t members_left_out<TetMesh> = 1;  // names: meshes from elsewhere are not archived

/// Converts to any member of an aggregate; never called.
struct AnyMember {
  template <class T>
  operator T() const;
};

/// Members of an aggregate: as many as its braces take.
template <class T, class... Members>
constexpr std::size_t member_count() {
  if constexpr (requires { T{Members{}..., AnyMember{}}; })
    return member_count<T, Members..., AnyMember>();
  else
    return sizeof...(Members);
}

template <class T>
constexpr bool all_members_are_told() {
  if constexpr (std::is_aggregate_v<T>)
    return std::tuple_size_v<decltype(members(std::declval<T&>()))> + members_left_out<T> == member_count<T>();
  return true;
}

/// Base of what takes bytes: `Sink` has raw(const void*, std::size_t).
template <class Sink>
struct Packing {
  template <class T>
  void put(const T& value) {
    if constexpr (std::is_trivially_copyable_v<T>) {
      raw(&value, sizeof value);
    } else {
      static_assert(all_members_are_told<T>(), "members() of this struct forgets one");
      // members() takes a mutable reference so that Unpacking can share it; nothing is changed here.
      std::apply([&](const auto&... member) { (put(member), ...); }, members(const_cast<T&>(value)));
    }
  }
  void put(const std::string& text) {
    put(text.size());
    raw(text.data(), text.size());
  }
  template <class T>
  void put(const std::vector<T>& values) {
    put(values.size());
    if constexpr (std::is_trivially_copyable_v<T>)
      raw(values.data(), values.size() * sizeof(T));
    else
      for (const auto& value : values) put(value);
  }
  template <class T>
  void put(const std::set<T>& values) {
    put(values.size());
    for (const auto& value : values) put(value);
  }
  template <class K, class T>
  void put(const std::map<K, T>& values) {
    put(values.size());
    for (const auto& [key, value] : values) {
      put(key);
      put(value);
    }
  }

 private:
  void raw(const void* data, std::size_t size) { static_cast<Sink&>(*this).raw(data, size); }
};

/// Base of what gives bytes back: `Source` has raw(void*, std::size_t) and require(std::size_t), which both throw where
/// fewer bytes can follow.
template <class Source>
struct Unpacking {
  template <class T>
  void get(T& value) {
    if constexpr (std::is_trivially_copyable_v<T>) {
      source().raw(&value, sizeof value);
    } else {
      static_assert(all_members_are_told<T>(), "members() of this struct forgets one");
      std::apply([&](auto&... member) { (get(member), ...); }, members(value));
    }
  }
  void get(std::string& text) {
    text.resize(count(1));
    source().raw(text.data(), text.size());
  }
  template <class T>
  void get(std::vector<T>& values) {
    values.resize(count(std::is_trivially_copyable_v<T> ? sizeof(T) : 1));
    if constexpr (std::is_trivially_copyable_v<T>)
      source().raw(values.data(), values.size() * sizeof(T));
    else
      for (auto& value : values) get(value);
  }
  template <class T>
  void get(std::set<T>& values) {
    values.clear();
    for (std::size_t left = count(1); left > 0; --left) {
      T value;
      get(value);
      values.insert(std::move(value));
    }
  }
  template <class K, class T>
  void get(std::map<K, T>& values) {
    values.clear();
    for (std::size_t left = count(1); left > 0; --left) {
      K key;
      get(key);
      get(values[key]);
    }
  }

 private:
  Source& source() { return static_cast<Source&>(*this); }
  std::size_t count(std::size_t bytes_each) {
    std::size_t size = 0;
    get(size);
    source().require(size > SIZE_MAX / bytes_each ? SIZE_MAX : size * bytes_each);
    return size;
  }
};

}  // namespace heartgen
