// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// `heartgen-lab accuracy --of PART`: one step of the image stages on phantoms, from what is known before it.
#pragma once
#include <vector>

#include "benchmarks/lab/accuracy_command.hpp"
#include "datasets/phantom/phantom.hpp"

namespace heartgen::lab {

/// One row per phantom: Dice, mean and greatest surface distance of what `command.of` makes:
/// - "walls": the four walls around the phantom's true chambers, and the share of the right ventricle's wall that is
///   called left;
/// - "carotid": the lumen in the phantom's own angiogram (0.5 mm voxels), by the default edge step and by snakes;
/// - "trachea": trachea and main bronchi, found without a seed.
/// Exit code 3 where a phantom is refused. Throws UserError for another part. @collective
int accuracy_of_part(const AccuracyCommand& command, const std::vector<phantom::PhantomSettings>& phantoms,
                     const parallel::Comm& comm);

}  // namespace heartgen::lab
