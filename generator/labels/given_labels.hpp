// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Labels from elsewhere: reading them with names and presets, and putting them on top of what our own stages make.
#pragma once
#include <string>
#include <vector>

#include "model/certificate.hpp"
#include "model/labels.hpp"
#include "model/recipe.hpp"
#include "model/volume.hpp"

namespace heartgen::labels {

struct GivenLabels {
  LabelVolume labels;             ///< region tags, 0 where nothing is given; no voxels at all without any input
  std::vector<Warning> warnings;  ///< what a reader of the model must know: where from, resampled, what was unused
};

/// Reads `input.labels`: an image with one value per structure (NIfTI, NRRD, MetaImage, 3D Slicer's .seg.nrrd with its
/// names), or a folder with one mask per structure, named like it. Every value or name is looked up in
/// `settings.regions`, `settings.ignore`, then by its name (of the file, or of `input.label_names`) and by its value in
/// the preset. Structures that overlap: blood goes before walls, these before what surrounds the heart.
/// On `grid` where one is given (nearest voxel, with a remark), else on the file's own.
/// Throws UserError for an unknown value or name (with the nearest known one), a region of `settings.regions` without
/// a voxel, files on different grids, labels that do not reach into `grid`, and what the readers refuse. Root only.
GivenLabels read_given_labels(const InputSettings& input, const LabelSettings& settings, const Grid* grid);

/// Whether the voxels of two grids are the same points, but for what formats that store 32-bit floats may differ by.
bool same_place(const Grid& a, const Grid& b);

/// Whether a voxel holds the region.
bool holds(const LabelVolume& labels, Region region);

/// The groups that our own stages must add, as far as `settings.complete` allows it.
struct MissingGroups {
  bool chambers = false;  ///< one of the four chambers has no voxel
  bool vessels = false;   ///< the four chambers are there, aorta or pulmonary artery is not
  bool walls = false;     ///< a chamber's wall has none
  bool body = false;      ///< the torso has none
  bool any() const { return chambers || vessels || walls || body; }
};
/// Throws UserError for an unknown group in `settings.complete`.
void check_settings(const LabelSettings& settings);

/// `settings` are checked.
MissingGroups missing_groups(const LabelVolume& given, const LabelSettings& settings);

enum class Group { chambers, walls, body };  ///< blood, great vessels and papillary muscles | walls | all the rest
Group group_of(Region region);

/// The part of a label map that belongs to a group.
LabelVolume only(const LabelVolume& labels, Group group);

/// A stage's own result with what is given of its group: regions that are given replace the stage's whole region, and
/// no voxel that is given as anything but torso keeps a label of ours. Both on one grid, or `given` without voxels.
LabelVolume with_given(LabelVolume own, const LabelVolume& given, Group group);

/// The whole label map with every voxel that is given, but torso, as it is given.
LabelVolume with_all_given(LabelVolume own, const LabelVolume& given);

/// `chambers` with the pockets that the given chambers and walls enclose and leave without a label: next to a ventricle
/// or its wall they are papillary muscle from `min_papillary_mm3` on, else part of the nearest chamber, or left to the
/// walls.
LabelVolume with_filled_pockets(LabelVolume chambers, const LabelVolume& given, double min_papillary_mm3);

/// Chambers with great vessels no farther from the chambers' blood than `reach_mm`: what the walls depend on.
LabelVolume near_heart(LabelVolume chambers, double reach_mm);

/// Walls without an image: what lies within the recipe's least thickness of a chamber (of which it is nearer than of
/// other blood) and touches it, beside the walls that are given.
LabelVolume min_walls(const LabelVolume& chambers, const LabelVolume& given, const EpicardiumSettings& settings);

}  // namespace heartgen::labels
