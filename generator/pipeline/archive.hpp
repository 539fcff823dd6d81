// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Stage results as bytes, for the cache. A cache never leaves the machine: its key holds the program's own hash.
#pragma once
#include <cstring>
#include <stdexcept>
#include <string>
#include <tuple>

#include "generator/anatomy/padding.hpp"
#include "generator/fibers/map_fibers.hpp"
#include "generator/labels/given_labels.hpp"
#include "generator/labels/place_heart.hpp"
#include "generator/landmarks/landmarks.hpp"
#include "generator/pde/hierarchy.hpp"
#include "generator/pipeline/resolutions.hpp"
#include "model/archive.hpp"
#include "model/certificate.hpp"

namespace heartgen {
inline auto members(Landmarks& l) { return std::tie(l.seeds_mm, l.valves, l.lv_apex_mm); }
inline auto members(Warning& w) { return std::tie(w.code, w.level, w.text); }
inline auto members(DepthSamples& s) { return std::tie(s.depth, s.helix_deg); }
}  // namespace heartgen

namespace heartgen::landmarks {
inline auto members(FoundLandmarks& f) {
  return std::tie(f.landmarks, f.confidence, f.warnings, f.volumes_ml, f.ventricles_cut_cm2, f.long_axis);
}
}  // namespace heartgen::landmarks

namespace heartgen::pde {
inline auto members(SegmentationSide& s) {
  return std::tie(s.name, s.below, s.above, s.c_below, s.c_above, s.iterations);
}
}  // namespace heartgen::pde

namespace heartgen::anatomy {
inline auto members(Padding& p) {
  return std::tie(p.value_hu, p.axis, p.width, p.is_column, p.is_slice, p.wall, p.lids);
}
}  // namespace heartgen::anatomy

namespace heartgen::labels {
inline auto members(GivenLabels& g) { return std::tie(g.labels, g.warnings); }
inline auto members(TorsoPose& p) { return std::tie(p.torso_from_heart, p.scale, p.rms_mm, p.residual_mm); }
}  // namespace heartgen::labels

namespace heartgen::fibers {
template <class T>
auto members(Both<T>& b) {
  return std::tie(b.lv, b.rv);
}
inline auto members(AtlasFigures& f) {
  return std::tie(f.atlas, f.carried, f.there, f.jump_p99_deg, f.turn_p99_deg_per_mm, f.edge_p50_mm,
                  f.atlas_turn_p99_deg_per_wall, f.carried_turn_p99_deg_per_wall, f.atlas_junction_turn_p99_deg_per_mm);
}
inline auto members(FiberResult& f) {
  return std::tie(f.node, f.cell, f.source, f.atlas_distance_mm, f.wall_depth, f.min_jacobian, f.affine_rms_mm,
                  f.atlas_overlap, f.second_mean_deg, f.second_p95_deg, f.rule_difference_deg, f.figures, f.atlas_array,
                  f.warnings);
}
}  // namespace heartgen::fibers

template <>
constexpr std::size_t heartgen::members_left_out<heartgen::fibers::FiberResult> = 1;  // times, for logs only

namespace heartgen::pipeline {
inline auto members(Resolutions& r) { return std::tie(r.meshes, r.farthest_mm); }

struct Writer : Packing<Writer> {
  std::string bytes;
  void raw(const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); }
};

/// Throws std::runtime_error at the end of the bytes.
struct Reader : Unpacking<Reader> {
  const std::string& bytes;
  std::size_t position = 0;

  explicit Reader(const std::string& bytes_) : bytes(bytes_) {}
  void require(std::size_t size) const {
    if (size > bytes.size() - position) throw std::runtime_error("cache entry is cut short");
  }
  void raw(void* data, std::size_t size) {
    require(size);
    if (size > 0) std::memcpy(data, bytes.data() + position, size);
    position += size;
  }
};

}  // namespace heartgen::pipeline
