// Text for a paper that uses the model: how it was made and measured, whom to cite.
#pragma once
#include <string>

#include "validation/report_html.hpp"

namespace heart::validation {

std::string methods_html(const ReportInput& input);

}  // namespace heart::validation
