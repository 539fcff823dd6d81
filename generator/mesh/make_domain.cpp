// SPDX-License-Identifier: GPL-3.0-or-later
// The making of a domain: smooth shares first, then what smoothing took is given back.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>

#include "generator/mesh/domain.hpp"
#include "generator/mesh/size_field.hpp"
#include "generator/parallel/gather.hpp"
#include "generator/parallel/threads.hpp"
#include "model/error.hpp"

namespace heartgen::mesh {
namespace {

// Less follows the stairs. With a kernel free of bias more of it brings the surfaces of subsampled shapes nearer to the
// true ones, up to here.
constexpr double min_smoothing_voxels = 1.3;

std::array<Box, label_count> boxes_of(const LabelVolume& labels) {
  std::array<Box, label_count> boxes;
  const auto& size = labels.grid.size;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j) {
      const auto* row = &labels.voxels[static_cast<std::size_t>(labels.grid.offset(0, j, k))];
      for (std::int64_t i = 0; i < size[0]; ++i) {
        if (row[i] >= label_count)
          throw UserError(fmt::format("label {} is not a known region", row[i]), "label map",
                          "labels are the region tags 0 to 17");
        if (i > 0 && row[i] == row[i - 1] && i <= boxes[row[i]].high[0]) continue;
        boxes[row[i]].add({i, j, k});
      }
    }
  return boxes;
}

Vec3 sigma_voxels(const Grid& grid, double smoothing_mm) {
  Vec3 sigma;
  for (int axis = 0; axis < 3; ++axis)
    sigma[axis] = std::max(smoothing_mm / grid.spacing_mm[axis], min_smoothing_voxels);
  return sigma;
}

// Only the heart, its vessels, trachea and carotid keep what smoothing takes: the torso's edges cannot follow details.
bool is_kept(std::uint8_t label) { return (bulk_bits >> label & 1U) == 0; }

/// The part of a voxel, in eighths, that has gone from its label to another one.
struct Loss {
  Index3 voxel;
  std::uint8_t from, to;
};

// The regions in the eighths that each voxel of a cube between voxel centres has of it; voxel c is at bit 0 of c along
// x, bit 1 along y, bit 2 along z.
std::array<std::uint8_t, 8> regions_in_cube(const MeshDomain& domain, const Index3& cube) {
  const auto& size = domain.grid.size;
  const auto is_inside = [&](std::size_t axis) { return cube[axis] >= 0 && cube[axis] + 1 < size[axis]; };
  std::array<std::uint8_t, 8> regions;
  if (is_inside(0) && is_inside(1) && is_inside(2)) {
    const auto label = domain.cubes[static_cast<std::size_t>(domain.grid.offset(cube[0], cube[1], cube[2]))];
    if (label == MeshDomain::mixed) return regions_of_eighths(domain, cube);
    regions.fill(label);
    return regions;
  }
  for (std::size_t c = 0; c < 8; ++c) {
    const auto middle = [&](std::size_t axis) {
      return static_cast<double>(cube[axis]) + ((c >> axis & 1U) != 0 ? 0.75 : 0.25);
    };
    regions[c] = region_at(domain, {middle(0), middle(1), middle(2)});
  }
  return regions;
}

// Whether a cube is one region, and all of its voxels have that label.
bool is_settled(const MeshDomain& domain, const LabelVolume& labels, const Index3& cube) {
  const auto& size = domain.grid.size;
  const auto [i, j, k] = cube;
  if (i < 0 || j < 0 || k < 0 || i + 1 >= size[0] || j + 1 >= size[1] || k + 1 >= size[2]) return false;
  const auto first = domain.grid.offset(i, j, k);
  const auto label = domain.cubes[static_cast<std::size_t>(first)];
  const auto is_label = [&](std::int64_t voxel) {
    const auto* row = labels.voxels.data() + voxel;
    return row[0] == label && row[1] == label;
  };
  const auto up = size[0] * size[1];
  return is_label(first) && is_label(first + size[0]) && is_label(first + up) && is_label(first + size[0] + up);
}

// Eighths of voxels in a box that are not their label's.
std::vector<Loss> losses_of(const MeshDomain& domain, const LabelVolume& labels, const Box& box) {
  const auto add_losses = [&](const Index3& cube, std::vector<Loss>& losses) {
    const auto regions = regions_in_cube(domain, cube);
    for (std::size_t c = 0; c < 8; ++c) {
      Index3 at = cube;
      for (std::size_t axis = 0; axis < 3; ++axis) at[axis] += static_cast<std::int64_t>(c >> axis & 1U);
      if (!box.contains(at)) continue;
      const auto own = labels(at[0], at[1], at[2]);
      if (regions[c] != own) losses.push_back({at, own, regions[c]});
    }
  };
  return parallel::gather<Loss>(box.low[2] - 1, box.high[2] + 1,
                                [&](std::int64_t begin, std::int64_t end, std::vector<Loss>& losses) {
                                  for (auto k = begin; k < end; ++k)
                                    for (auto j = box.low[1] - 1; j <= box.high[1]; ++j)
                                      for (auto i = box.low[0] - 1; i <= box.high[0]; ++i)
                                        if (!is_settled(domain, labels, {i, j, k})) add_losses({i, j, k}, losses);
                                });
}

// Where a region has less room than its voxels, seen over a few voxels, its share is raised, and lowered where it has
// more. Of all labels together what is added is 0, as shares are.
void keep_volumes(MeshDomain& domain, const LabelVolume& labels, const Box& box, const Vec3& sigma) {
  constexpr int rounds = 2;
  constexpr double wide = 1.5;           // how far volumes are seen together, in widths of the smoothing
  constexpr float rise = 1.293F * 1.5F;  // a sheet added on a plane's face moves the plane by its thickness
  constexpr float eighth = 0.125F;
  const auto kernels = gaussian_kernels(wide * sigma);
  auto everywhere = no_spans(labels.grid.size);
  everywhere.add(box);
  std::vector<float> scratch;
  for (int round = 0; round < rounds; ++round) {
    const auto losses = losses_of(domain, labels, box);
    for (auto& field : domain.shares) {
      if (!is_kept(field.label)) continue;
      Volume<float> lack(field.share.grid, 0.0F);
      for (const auto& loss : losses) {
        if (loss.from != field.label && loss.to != field.label) continue;
        const Index3 at{loss.voxel[0] - field.first[0], loss.voxel[1] - field.first[1], loss.voxel[2] - field.first[2]};
        if (lack.grid.contains(at[0], at[1], at[2]))
          lack(at[0], at[1], at[2]) += loss.from == field.label ? eighth : -eighth;
      }
      smooth(lack, kernels, scratch);
      for (std::size_t v = 0; v < lack.voxels.size(); ++v) field.share.voxels[v] += rise * lack.voxels[v];
    }
    update_regions(domain, labels, everywhere);
  }
}

// A voxel alone, or at the tip of a row of voxels, is noise.
bool is_held(const LabelVolume& labels, const Index3& at) {
  const auto own = labels(at[0], at[1], at[2]);
  int same = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const std::int64_t way : {-1, 1}) {
      Index3 next = at;
      next[axis] += way;
      same += labels.grid.contains(next[0], next[1], next[2]) && labels(next[0], next[1], next[2]) == own;
    }
  return same >= 2;
}

std::vector<Index3> lost_voxels(const MeshDomain& domain, const LabelVolume& labels, const Spans& spans) {
  const auto find = [&](std::int64_t begin, std::int64_t end, std::vector<Index3>& lost) {
    for (auto k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < domain.grid.size[1]; ++j) {
        const auto span = spans.row(j, k);
        for (auto i = span.first; i <= span.last; ++i) {
          const auto voxel = static_cast<std::size_t>(domain.grid.offset(i, j, k));
          const auto wanted = labels.voxels[voxel], there = domain.voxels[voxel];
          if (there != wanted && (is_kept(wanted) || is_kept(there)) && is_held(labels, {i, j, k}))
            lost.push_back({i, j, k});
        }
      }
  };
  return parallel::gather<Index3>(0, domain.grid.size[2], find);
}

// Where kernels around some voxels reach.
Spans spans_around(const Index3& size, const std::vector<Index3>& voxels, const Index3& reach) {
  auto spans = no_spans(size);
  for (const auto& at : voxels)
    spans.add({{at[0] - reach[0], at[1] - reach[1], at[2] - reach[2]},
               {at[0] + reach[0], at[1] + reach[1], at[2] + reach[2]}});
  return spans;
}

// Raises a share where its label has lost voxels, and lowers it where it has taken them.
void give_back(FractionField& field, const LabelVolume& labels, const std::vector<Index3>& lost,
               const Kernels& kernels) {
  std::vector<float> lack;
  lack.reserve(lost.size());
  for (const auto& at : lost)
    lack.push_back((labels(at[0], at[1], at[2]) == field.label ? 1.0F : 0.0F) - share_at(field, at));
  for (std::size_t i = 0; i < lost.size(); ++i)
    if (lack[i] != 0) add_kernel(field, lost[i], lack[i], kernels);
}

// Strands and sheets that smoothing would break: where the domain has another region than the voxel, the shares there
// are brought back by as much as they lack.
void keep_voxels(MeshDomain& domain, const LabelVolume& labels, const Box& box, const Kernels& kernels) {
  constexpr int max_rounds = 6;
  auto changed = no_spans(labels.grid.size);
  changed.add(box);
  for (int round = 0; round < max_rounds; ++round) {
    const auto lost = lost_voxels(domain, labels, changed);
    if (lost.empty()) return;
    parallel::parallel_for(0, static_cast<std::int64_t>(domain.shares.size()),
                           [&](std::int64_t begin, std::int64_t end) {
                             for (auto f = static_cast<std::size_t>(begin); f < static_cast<std::size_t>(end); ++f)
                               if (is_kept(domain.shares[f].label)) give_back(domain.shares[f], labels, lost, kernels);
                           });
    changed = spans_around(labels.grid.size, lost, reach_of(kernels));
    update_regions(domain, labels, changed);
  }
}

Box box_of_kept(const MeshDomain& domain) {
  Box box;
  for (const auto& field : domain.shares) {
    if (!is_kept(field.label)) continue;
    const auto& [f, s] = std::pair{field.first, field.share.grid.size};
    box.add(f);
    box.add({f[0] + s[0] - 1, f[1] + s[1] - 1, f[2] + s[2] - 1});
  }
  return box;
}

}  // namespace

MeshDomain make_domain(const LabelVolume& labels, double smoothing_mm, double body_smoothing_mm) {
  const auto boxes = boxes_of(labels);
  if (std::all_of(boxes.begin() + 1, boxes.end(), [](const Box& box) { return box.empty(); }))
    throw UserError("the label map has no labelled voxel", "label map", "nothing can be meshed");
  const Vec3 sigma = sigma_voxels(labels.grid, smoothing_mm);
  const auto fine = sharp_kernels(sigma);
  const auto coarse = sharp_kernels(sigma_voxels(labels.grid, std::max(smoothing_mm, body_smoothing_mm)));
  MeshDomain domain;
  domain.grid = labels.grid;
  domain.share_of.fill(-1);
  std::vector<float> scratch;
  for (std::size_t label = 0; label < label_count; ++label) {
    if (boxes[label].empty()) continue;
    domain.share_of[label] = static_cast<std::int8_t>(domain.shares.size());
    domain.shares.push_back(share_field(labels, static_cast<std::uint8_t>(label), boxes[label],
                                        is_kept(static_cast<std::uint8_t>(label)) ? fine : coarse, scratch));
  }
  const auto& size = labels.grid.size;
  auto whole = no_spans(size);
  whole.add({{0, 0, 0}, {size[0] - 1, size[1] - 1, size[2] - 1}});
  update_regions(domain, labels, whole);
  const Box box = box_of_kept(domain);
  if (!box.empty()) {
    keep_voxels(domain, labels, box, fine);
    keep_volumes(domain, labels, box, sigma);
    keep_voxels(domain, labels, box, fine);
  }
  return domain;
}

MeshDomain make_domain(const LabelVolume& labels, const MeshSettings& settings) {
  const double body_edge_mm = finest_body_edge_mm(settings);
  return make_domain(labels, settings.smoothing_mm, settings.smoothing_mm * body_edge_mm / settings.heart_edge_mm);
}

}  // namespace heartgen::mesh
