// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Images in two and three dimensions, and their files: NIfTI, NRRD, MetaImage and folders with one DICOM series.
///
/// A `Volume<T>` holds a grid and its voxels, i fastest; a picture is a volume of one slice. Lengths are mm in the
/// frame LPS: x to the patient's left, y to the back, z to the head. Readers bring any order and direction of axes to
/// the one nearest to that frame. Nothing here is collective: call it on one rank. Everything throws UserError.
#pragma once
#include "generator/adapters/itk_io.hpp"
#include "model/error.hpp"
#include "model/volume.hpp"

namespace heartgen {

using adapters::check_image_output;
using adapters::ComponentImage;
using adapters::read_components;
using adapters::read_ct;
using adapters::read_image;
using adapters::read_labels;
using adapters::write_volume;

}  // namespace heartgen
