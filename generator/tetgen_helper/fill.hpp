// SPDX-License-Identifier: AGPL-3.0-or-later
/// @file
/// TetGen's work on a FillTask. What is linked with this is under the AGPL, as TetGen is; heartgen is not.
#pragma once
#include <cstdio>

#include "generator/adapters/tetgen_mesher.hpp"

namespace heartgen::tetgen_helper {

/// The cells, or the problem. TetGen prints on standard output; when it gives up it may end the process.
adapters::FillAnswer fill(const adapters::FillTask& task);

/// Reads a task and writes its answer. Returns the exit code of the program: 2, with one line on `printed`, for what is
/// no task.
int answer_task(std::FILE* input, std::FILE* output, std::FILE* printed);

}  // namespace heartgen::tetgen_helper
