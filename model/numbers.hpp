// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// All numbers about patients, for who lists or moves them.
#pragma once
#include <span>
#include <string_view>

#include "model/number.hpp"

namespace heartgen {

/// Those of model/tissue.hpp, then those of model/priors.hpp, in the order of the files.
std::span<const Number* const> patient_numbers();

std::string_view basis_name(Basis basis);

}  // namespace heartgen
