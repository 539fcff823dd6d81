// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What makes a phantom's heart unusual, as options.
#pragma once
#include <CLI/CLI.hpp>

#include "datasets/phantom/anatomy.hpp"

namespace heartgen::command_line {

void add_heart_options(CLI::App& command, phantom::HeartOverrides& heart);

/// The phantom's grey values: --hu and --no-contrast.
void add_grey_options(CLI::App& command, phantom::GreyValues& grey);

}  // namespace heartgen::command_line
