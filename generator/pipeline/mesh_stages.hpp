// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The stages from a label map to meshes with fibres.
#pragma once
#include "generator/pipeline/stages.hpp"

namespace heartgen::pipeline {

/// Meshes of the map, of trachea and carotid; fibres on the walls; the walls at further edge lengths.
Stages mesh_stages();

/// The atlas that is taken where none is given.
FiberAtlas standin_atlas();

TetMesh with_fibers(TetMesh myocardium, const fibers::FiberResult& result);

}  // namespace heartgen::pipeline
