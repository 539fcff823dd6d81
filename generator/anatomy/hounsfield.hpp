// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A CT's grey values, and whether they can be Hounsfield units at all: air -1000, fat -100, water 0.
#pragma once
#include <string>

#include "model/volume.hpp"

namespace heartgen::anatomy {

/// The grey values as numbers to compute with.
Volume<float> as_float(const CtVolume& ct);

/// Throws UserError where hardly a voxel is darker than water, as in images stored with an offset (often 1024) whose
/// rescale was lost, in MR images, in windowed pictures and in label maps. A CT of a chest with contrast, however
/// cropped, shows fat or lung; images with nothing above 200 are not judged but for those whose least is 0. `where`
/// names the image.
void require_hounsfield(const CtVolume& ct, const std::string& where = "CT");

}  // namespace heartgen::anatomy
