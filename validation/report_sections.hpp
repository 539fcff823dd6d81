// The parts of the report that hold pictures; empty where their data is missing.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "validation/report_html.hpp"

namespace heart::validation {

/// A section in order, in pieces of HTML that do not depend on each other: they may be made at the same time.
using Pieces = std::vector<std::function<std::string()>>;

/// The texts of all pieces one after the other, made on all threads; the same bytes for any number of them.
std::string joined(const Pieces& pieces);

// The pieces refer to `input`.
Pieces viewer_section(const ReportInput& input);
Pieces slices_section(const ReportInput& input);
Pieces meshes_section(const ReportInput& input);
Pieces fibers_section(const ReportInput& input);

}  // namespace heart::validation
