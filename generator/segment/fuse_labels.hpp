// One label map out of the stages' results.
#pragma once
#include "generator/segment/body.hpp"
#include "model/volume.hpp"

namespace heart::segment {

/// Precedence, highest first: chambers (blood, vessels, papillary) | walls | trachea | bone | lung | liver | torso (the
/// rest of the body). All on one grid; an empty `walls` or `trachea` (no voxels) is left out. Pieces of a heart region
/// (not of papillary muscle, which is many pieces) with less than 1 % of its volume are islands and take the nearest
/// other label. Root only.
LabelVolume fuse_labels(const LabelVolume& chambers, const LabelVolume& walls, const BodyResult& body,
                        const Mask& trachea);

}  // namespace heart::segment
