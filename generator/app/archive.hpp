// Stage results as bytes, for the cache. Native layout: a cache never leaves the machine (its key holds the program's
// own hash). Which members a struct has is said once, in `members`.
#pragma once
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include "generator/app/resolutions.hpp"
#include "generator/fibers/carry.hpp"
#include "generator/labels/given_labels.hpp"
#include "generator/labels/place_heart.hpp"
#include "generator/landmarks/landmarks.hpp"
#include "generator/segment/hierarchy.hpp"
#include "generator/segment/padding.hpp"
#include "model/certificate.hpp"
#include "model/tet_mesh.hpp"
#include "model/volume.hpp"

namespace heart::app {

template <class T>
auto members(Volume<T>& v) {
  return std::tie(v.grid, v.voxels);
}
inline auto members(Landmarks& l) { return std::tie(l.seeds_mm, l.valves, l.lv_apex_mm); }
inline auto members(landmarks::FoundLandmarks& f) {
  return std::tie(f.landmarks, f.confidence, f.warnings, f.volumes_ml, f.ventricles_cut_cm2, f.long_axis);
}
inline auto members(Rim& r) { return std::tie(r.name, r.tag, r.nodes); }
inline auto members(FiberField& f) { return std::tie(f.fiber, f.sheet, f.sheet_normal); }
inline auto members(TetMesh& m) {
  return std::tie(m.nodes_mm, m.cells, m.region, m.faces, m.surface, m.rims, m.node_fibers, m.cell_fibers,
                  m.fiber_source, m.rule_difference_deg, m.parent_node, m.parent_cell);
}
inline auto members(Resolutions& r) { return std::tie(r.meshes, r.farthest_mm); }
inline auto members(segment::SegmentationSide& s) {
  return std::tie(s.name, s.below, s.above, s.c_below, s.c_above, s.iterations);
}
inline auto members(segment::Padding& p) {
  return std::tie(p.value_hu, p.axis, p.width, p.is_column, p.is_slice, p.wall, p.lids);
}
inline auto members(Warning& w) { return std::tie(w.code, w.level, w.text); }
inline auto members(labels::GivenLabels& g) { return std::tie(g.labels, g.warnings); }
inline auto members(labels::TorsoPose& p) { return std::tie(p.torso_from_heart, p.scale, p.rms_mm, p.residual_mm); }
inline auto members(DepthSamples& s) { return std::tie(s.depth, s.helix_deg); }
inline auto members(fibers::AtlasFigures& f) {
  return std::tie(f.atlas.lv, f.atlas.rv, f.carried.lv, f.carried.rv, f.there.lv, f.there.rv, f.jump_p99_deg,
                  f.turn_p99_deg_per_mm, f.edge_p50_mm, f.atlas_turn_p99_deg_per_wall, f.carried_turn_p99_deg_per_wall,
                  f.atlas_junction_turn_p99_deg_per_mm);
}
inline auto members(fibers::FiberResult& f) {
  return std::tie(f.node, f.cell, f.source, f.atlas_distance_mm, f.wall_depth, f.min_jacobian, f.affine_rms_mm,
                  f.atlas_overlap, f.second_mean_deg, f.second_p95_deg, f.rule_difference_deg, f.figures, f.atlas_array,
                  f.warnings);
}

struct Writer {
  std::string bytes{};

  void raw(const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); }

  template <class T>
  void put(const T& value) {
    if constexpr (std::is_trivially_copyable_v<T>) {
      raw(&value, sizeof value);
    } else {
      // members() takes a mutable reference so that Reader can share it; nothing is changed here.
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
  template <class K, class T>
  void put(const std::map<K, T>& values) {
    put(values.size());
    for (const auto& [key, value] : values) {
      put(key);
      put(value);
    }
  }
};

/// Throws std::runtime_error at the end of the bytes.
struct Reader {
  const std::string& bytes;
  std::size_t position = 0;

  void raw(void* data, std::size_t size) {
    if (size > bytes.size() - position) throw std::runtime_error("cache entry is cut short");
    if (size > 0) std::memcpy(data, bytes.data() + position, size);
    position += size;
  }
  std::size_t count(std::size_t bytes_each) {
    std::size_t size = 0;
    get(size);
    if (size > (bytes.size() - position) / bytes_each) throw std::runtime_error("cache entry is cut short");
    return size;
  }

  template <class T>
  void get(T& value) {
    if constexpr (std::is_trivially_copyable_v<T>) {
      raw(&value, sizeof value);
    } else {
      std::apply([&](auto&... member) { (get(member), ...); }, members(value));
    }
  }
  void get(std::string& text) {
    text.resize(count(1));
    raw(text.data(), text.size());
  }
  template <class T>
  void get(std::vector<T>& values) {
    values.resize(count(std::is_trivially_copyable_v<T> ? sizeof(T) : 1));
    if constexpr (std::is_trivially_copyable_v<T>)
      raw(values.data(), values.size() * sizeof(T));
    else
      for (auto& value : values) get(value);
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
};

}  // namespace heart::app
