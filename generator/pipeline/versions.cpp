// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/versions.hpp"

#include <heartgen/version.hpp>

namespace heartgen::pipeline {

std::string program_version() { return HEARTGEN_VERSION; }

std::map<std::string, std::string> tool_versions() {
  return {{"heartgen", HEARTGEN_VERSION},  {"ITK", HEARTGEN_ITK_VERSION},     {"VTK", HEARTGEN_VTK_VERSION},
          {"CGAL", HEARTGEN_CGAL_VERSION}, {"Ceres", HEARTGEN_CERES_VERSION}, {"HDF5", HEARTGEN_HDF5_VERSION}};
}

}  // namespace heartgen::pipeline
