// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Images on disk: NIfTI, NRRD, MetaImage and DICOM series through ITK, as plain volumes.
/// Readers bring any axis order and direction to the canonical one: i, j, k run as close as possible to the
/// patient's left, back and head, so the same volume stored in any format or axis order gives the same voxels.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "model/volume.hpp"

namespace heartgen::adapters {

/// Reads a CT (Hounsfield units). `path` is an image file or a folder that holds exactly one DICOM series.
/// Throws UserError: missing or unreadable file, truncated data, not 3D, NaN, anisotropy beyond 10:1, missing
/// slices, several series, lengths that are not in mm, or a volume too large for this machine's memory.
CtVolume read_ct(const std::string& path, int phase = 0);

/// Reads an integer label map (0 to 255). Errors as read_ct.
LabelVolume read_labels(const std::string& path);

/// A structure of a label file: the voxels of `layer` that hold `value`.
struct LabelSegment {
  std::string name;
  std::int32_t value = 0;
  std::size_t layer = 0;
};

/// Labels as a file holds them. Most have one layer and no names.
struct LabelImage {
  std::vector<Volume<std::int32_t>> layers;  ///< on one grid; more than one where structures overlap
  std::vector<LabelSegment> segments;        ///< names, where the file holds some, in the file's order
};

/// Reads labels of any whole numbers; of a 3D Slicer segmentation (.seg.nrrd) also its names and overlapping layers
/// (slicer.readthedocs.io, "Segmentation labelmap file format"). Errors as read_ct, and values that are not whole.
LabelImage read_label_image(const std::string& path);

/// Reads any scalar image as float, 2D images as one slice (for `heartgen filter`).
Volume<float> read_image(const std::string& path);

/// An image of vectors or tensors.
struct ComponentImage {
  std::vector<Volume<float>> components;  ///< one volume each, on one grid, in the file's order
  Mat3 frame;  ///< of the components: frame * vector is along LPS (a NRRD's measurement frame)
};

/// Reads an image of any number of components per voxel. Errors as read_ct.
ComponentImage read_components(const std::string& path);

/// Commands call it before their long work. Throws UserError when write_volume knows no format for the ending, or
/// nothing can be written there; changes nothing.
void check_image_output(const std::string& path);

/// Writes .nii, .nii.gz, .nrrd, .mhd, .mha (compressed where the format can). Throws UserError on failure.
void write_volume(const std::string& path, const Volume<std::int16_t>& volume);
void write_volume(const std::string& path, const Volume<std::uint8_t>& volume);
void write_volume(const std::string& path, const Volume<float>& volume);

/// The same voxels with axes permuted and flipped so that the direction matrix is as near as can be to the identity.
/// Spacing, origin and direction are rounded to 1e-6 mm, 1e-3 mm and 1e-6: formats that store them as 32-bit floats
/// then agree with those that store text.
template <class T>
Volume<T> with_canonical_axes(const Volume<T>& volume);

}  // namespace heartgen::adapters
