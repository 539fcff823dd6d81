// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/heart_ends.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "generator/mesh/lattice_cells.hpp"
#include "generator/tetmesh/quality.hpp"
#include "generator/tetmesh/remesh_worst.hpp"
#include "model/crop.hpp"

namespace heartgen::mesh {
namespace {

struct Artery {
  Region region, ventricle;
};
constexpr std::array<Artery, 2> arteries{
    {{Region::aorta, Region::lv_blood}, {Region::pulmonary_artery, Region::rv_blood}}};

/// An artery on a grid around it, and its voxels beside its ventricle.
struct ArteryMasks {
  Mask lumen, start;
  Index3 begin{};  ///< of the part in the whole grid
};

ArteryMasks masks_of(const LabelVolume& labels, const Artery& artery) {
  const auto box = bounding_box(labels, 2, [&](std::uint8_t label) { return label == tag(artery.region); });
  if (box.empty()) return {};
  const auto part = crop(labels, box);
  ArteryMasks masks{Mask(part.grid), Mask(part.grid), box.begin};
  const auto& size = part.grid.size;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i) {
        if (part(i, j, k) != tag(artery.region)) continue;
        masks.lumen(i, j, k) = 1;
        for (const auto& [di, dj, dk] :
             std::array<Index3, 6>{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}})
          if (part.grid.contains(i + di, j + dj, k + dk) && part(i + di, j + dj, k + dk) == tag(artery.ventricle))
            masks.start(i, j, k) = 1;
      }
  return masks;
}

/// An end in the frame of a part of the grid that begins at `begin`, in the grid's own frame and in LPS.
HeartEnd placed_end(const Grid& grid, const Index3& begin, const VesselEnd& in_part) {
  HeartEnd end;
  end.own = in_part;
  for (int axis = 0; axis < 3; ++axis)
    end.own.center_mm[axis] += static_cast<double>(begin[static_cast<std::size_t>(axis)]) * grid.spacing_mm[axis];
  end.plane = end.own;
  end.plane.center_mm = grid.origin_mm + grid.direction * end.own.center_mm;
  end.plane.normal = grid.direction * end.own.normal;
  return end;
}

/// Whether the image ends within the plane's reach: the vessel goes on there.
bool is_at_border(const Grid& grid, const VesselEnd& end) {
  const Vec3 index = index_from_lps(grid, end.center_mm);
  for (int axis = 0; axis < 3; ++axis) {
    const double last = static_cast<double>(grid.size[static_cast<std::size_t>(axis)] - 1);
    if (std::min(index[axis], last - index[axis]) * grid.spacing_mm[axis] < end.reach_mm / 2) return true;
  }
  return false;
}

/// Both in one frame.
double beyond_mm(const VesselEnd& end, const Vec3& at_mm) { return dot(at_mm - end.center_mm, end.normal); }

/// Within the ball around a plane's centre where it cuts.
bool is_near(const VesselEnd& end, const Vec3& at_mm, double stub_mm) {
  return norm(at_mm - end.center_mm) <= end.reach_mm + stub_mm;
}

struct Cut {
  const MeshDomain* domain;
  const std::vector<HeartEnd>* ends;
  double stub_mm;
  int surroundings;  ///< what a vessel is beyond its stub

  // All points are in the grid's own frame.
  Vec3 index_of(const Vec3& p) const {
    const Vec3& s = domain->grid.spacing_mm;
    return {p.x / s.x, p.y / s.y, p.z / s.z};
  }
  /// The end behind whose plane a point lies; nullptr: none.
  const HeartEnd* end_before(const Vec3& p) const {
    for (const auto& end : *ends)
      if (beyond_mm(end.own, p) > 0 && is_near(end.own, p, stub_mm)) return &end;
    return nullptr;
  }
  /// On the plane, below a point beyond it.
  static Vec3 foot(const HeartEnd& end, const Vec3& p) { return p - beyond_mm(end.own, p) * end.own.normal; }
  bool is_vessel(const HeartEnd& end, const Vec3& p) const {
    return region_at(*domain, index_of(p)) == tag(end.vessel);
  }

  int label_at(const Vec3& p, int label) const {
    const auto* end = end_before(p);
    if (end == nullptr) return label;
    const bool has_room = label == tag(end->vessel) || (bulk_bits >> label & 1) != 0;  // other parts of the heart stay
    if (has_room && beyond_mm(end->own, p) < stub_mm && is_vessel(*end, foot(*end, p))) return artery_stub_label;
    return label == tag(end->vessel) ? surroundings : label;
  }

  const HeartEnd& end_of(const Vec3& p) const {
    return *std::min_element(ends->begin(), ends->end(), [&](const HeartEnd& a, const HeartEnd& b) {
      return norm(p - a.own.center_mm) - a.own.reach_mm < norm(p - b.own.center_mm) - b.own.reach_mm;
    });
  }

  /// The stub's side or its far end, whichever is nearer.
  tetmesh::Equation around_stub(const HeartEnd& end, const Vec3& p) const {
    const Vec3& along = end.own.normal;
    std::array<SurfaceEquation, 1> wall;
    mesh::equations_at(*domain, tetmesh::bit_of(tag(end.vessel)) | tetmesh::bit_of(0), index_of(foot(end, p)), wall);
    const Vec3 gradient = wall[0].gradient - dot(wall[0].gradient, along) * along;
    const double to_end = beyond_mm(end.own, p) - stub_mm;
    const bool is_end = std::abs(to_end) < std::abs(wall[0].value) / std::max(norm(gradient), 1e-12);
    return is_end ? tetmesh::Equation{to_end, along} : tetmesh::Equation{wall[0].value, gradient};
  }

  template <class Base>
  int equations_at(tetmesh::LabelBits labels, const Vec3& p, std::span<tetmesh::Equation> equations,
                   const Base& base) const {
    const auto stub = tetmesh::bit_of(artery_stub_label);
    if ((labels & stub) == 0) return base(labels, p, equations);
    const auto& end = end_of(p);
    const auto vessel = tetmesh::bit_of(tag(end.vessel));
    const auto rest = labels & ~stub;
    if (equations.empty() || rest == 0) return 0;
    if ((rest & (vessel | bulk_bits)) == 0) return base(rest | tetmesh::bit_of(surroundings), p, equations);
    if ((labels & vessel) != 0)
      equations[0] = {beyond_mm(end.own, p), end.own.normal};
    else
      equations[0] = around_stub(end, p);
    return 1 + (std::popcount(rest) > 1 ? base(rest, p, equations.subspan(1)) : 0);
  }
};

}  // namespace

std::vector<HeartEnd> find_heart_ends(const LabelVolume& labels) {
  std::vector<HeartEnd> all;
  for (const auto& artery : arteries) {
    const auto masks = masks_of(labels, artery);
    if (masks.lumen.voxels.empty()) continue;
    std::vector<HeartEnd> found;
    for (const auto& end : find_vessel_ends(masks.lumen, masks.start))
      if (const auto placed = placed_end(labels.grid, masks.begin, end); !is_at_border(labels.grid, placed.plane))
        found.push_back(placed);
    std::stable_sort(found.begin(), found.end(),
                     [](const HeartEnd& a, const HeartEnd& b) { return a.plane.center_mm.x > b.plane.center_mm.x; });
    const auto alone = *surface_from_name(region_name(tag(artery.region)) + "_end");
    for (std::size_t e = 0; e < found.size(); ++e) {
      found[e].vessel = artery.region;
      found[e].surface = found.size() == 1 ? alone : end_surface_tag(artery.region, static_cast<int>(e) + 1);
      all.push_back(found[e]);
    }
  }
  return all;
}

std::map<Region, double> cut_at_ends(LabelVolume& labels) {
  std::map<Region, double> cut_ml;
  const auto ends = find_heart_ends(labels);
  const bool has_torso =
      std::find(labels.voxels.begin(), labels.voxels.end(), tag(Region::torso)) != labels.voxels.end();
  const std::uint8_t surroundings = has_torso ? tag(Region::torso) : tag(Region::none);
  const auto& size = labels.grid.size;
  std::size_t v = 0;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i, ++v) {
        const auto vessel = static_cast<Region>(labels.voxels[v]);
        if (vessel != Region::aorta && vessel != Region::pulmonary_artery) continue;
        const Vec3& s = labels.grid.spacing_mm;
        const Vec3 at{s.x * static_cast<double>(i), s.y * static_cast<double>(j), s.z * static_cast<double>(k)};
        const bool is_beyond = std::any_of(ends.begin(), ends.end(), [&](const HeartEnd& end) {
          return end.vessel == vessel && beyond_mm(end.own, at) > 0 && is_near(end.own, at, 0);
        });
        if (!is_beyond) continue;
        labels.voxels[v] = surroundings;
        cut_ml[vessel] += labels.grid.voxel_volume_mm3() / 1000;
      }
  return cut_ml;
}

tetmesh::Materials with_ends(const MeshDomain& domain, tetmesh::Materials materials, const std::vector<HeartEnd>& ends,
                             double stub_mm) {
  if (ends.empty()) return materials;
  const bool has_torso = domain.share_of[tag(Region::torso)] >= 0;
  const Cut cut{&domain, &ends, stub_mm, has_torso ? tag(Region::torso) : 0};
  materials.label_at = [cut, base = std::move(materials.label_at)](const Vec3& p) { return cut.label_at(p, base(p)); };
  materials.equations_at = [cut, base = std::move(materials.equations_at)](tetmesh::LabelBits labels, const Vec3& p,
                                                                           std::span<tetmesh::Equation> equations) {
    return cut.equations_at(labels, p, equations, base);
  };
  return materials;
}

namespace {

/// How many nodes stay off their plane because a cell would fall below `min_quality`.
std::int64_t put_on_planes(tetmesh::Complex& c, const MeshDomain& domain, const std::vector<HeartEnd>& ends,
                           double min_quality) {
  constexpr double plane_tolerance_mm = 1e-6;
  const Vec3& s = domain.grid.spacing_mm;
  std::int64_t off = 0;
  c.frozen.assign(c.nodes_mm.size(), 0);
  for (std::size_t n = 0; n < c.nodes_mm.size(); ++n) {
    const auto node = static_cast<std::int32_t>(n);
    if ((c.bits(node) & tetmesh::bit_of(artery_stub_label)) == 0) continue;
    const Vec3 old = c.at(node), at = lps_from_index(domain.grid, {old.x / s.x, old.y / s.y, old.z / s.z});
    for (const auto& artery : arteries) {
      const auto* end = nearest_end(ends, artery.region, at);
      if ((c.bits(node) & tetmesh::bit_of(tag(artery.region))) == 0 || end == nullptr) continue;
      const double before = tetmesh::worst_quality(c, c.star(node));
      const double beyond = beyond_mm(end->own, old);
      const auto move_to = [&](const Vec3& p) {
        c.nodes_mm[n] = p;
        for (const auto t : c.star(node)) tetmesh::update_quality(c, t);
      };
      move_to(old - beyond * end->own.normal);
      const bool fits = tetmesh::worst_quality(c, c.star(node)) >= std::min(before, min_quality);
      c.frozen[n] = fits ? 1 : 0;
      if (!fits) move_to(old);
      off += !fits && std::abs(beyond) > plane_tolerance_mm ? 1 : 0;
    }
  }
  return off;
}

}  // namespace

void flatten_ends(tetmesh::Complex& complex, const tetmesh::Materials& materials, const MeshDomain& domain,
                  const std::vector<HeartEnd>& ends) {
  if (ends.empty()) return;
  constexpr double passing = 0.3;  // a quality that mending starts from
  constexpr int rounds = 3;        // what would flatten a cell has room after the others are mended
  tetmesh::RepairSettings repairing;
  repairing.may_relabel = false;  // it would take cells out of an end
  for (int round = 0; round < rounds; ++round) {
    const auto off = put_on_planes(complex, domain, ends, passing);
    tetmesh::repair(complex, materials, repairing);
    tetmesh::remesh_worst(complex, materials, repairing, kept_quality, tetmesh::OnFailure::go_on);
    if (off == 0) break;
  }
  put_on_planes(complex, domain, ends, kept_quality);
  complex.frozen.clear();
  tetmesh::compress(complex);
}

const HeartEnd* nearest_end(const std::vector<HeartEnd>& ends, Region vessel, const Vec3& lps_mm) {
  const HeartEnd* nearest = nullptr;
  double least = std::numeric_limits<double>::max();
  for (const auto& end : ends) {
    const double distance = norm(lps_mm - end.plane.center_mm);
    if (end.vessel != vessel || distance >= least) continue;
    least = distance;
    nearest = &end;
  }
  return nearest;
}

}  // namespace heartgen::mesh
