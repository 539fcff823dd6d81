// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Text for a paper that uses the model: how it was made and measured, whom to cite.
#pragma once
#include <string>

#include "validation/report/report_html.hpp"

namespace heartgen::report {

std::string methods_html(const ReportInput& input);

}  // namespace heartgen::report
