// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What makes a phantom's heart unusual, as options.
#pragma once
#include <CLI/CLI.hpp>

#include "datasets/phantom/anatomy.hpp"

namespace heartgen::command_line {

void add_heart_options(CLI::App& command, phantom::HeartOverrides& heart);

}  // namespace heartgen::command_line
