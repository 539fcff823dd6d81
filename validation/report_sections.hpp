// The parts of the report that hold pictures, each a piece of HTML; empty where their data is missing.
#pragma once
#include <string>

#include "validation/report_html.hpp"

namespace heart::validation {

std::string viewer_section(const ReportInput& input);
std::string slices_section(const ReportInput& input);
std::string meshes_section(const ReportInput& input);
std::string fibers_section(const ReportInput& input);

}  // namespace heart::validation
