// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The PDE filters by name, for the command line: `heartgen filter NAME IN OUT [--param value]`.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "generator/parallel/comm.hpp"
#include "model/volume.hpp"

namespace heartgen::pde {

struct FilterParameter {
  std::string name;
  double default_value = 0;
  std::string help;  ///< meaning and unit
};

struct FilterInfo {
  std::string name;
  std::string help;      ///< one line, with the thesis section
  std::string equation;  ///< what it solves, with its number in the thesis
  std::vector<FilterParameter> parameters;
};

/// All filters in alphabetical order.
const std::vector<FilterInfo>& filters();
std::vector<std::string> filter_names();

/// Applies a filter to the root's image; the result is on the root, empty elsewhere. Parameters that are not given
/// have their defaults. Throws UserError (on every rank) for an unknown filter or parameter, naming the nearest known
/// one, for a value out of range, and for an image that is empty or not finite. @collective
Volume<float> apply_filter(const std::string& name, const Volume<float>& image_on_root,
                           const std::map<std::string, double>& parameters, const parallel::Comm& comm);

}  // namespace heartgen::pde
