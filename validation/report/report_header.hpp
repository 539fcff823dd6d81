// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What the report opens with: the verdict, what it is fit for, what speaks against it, a few figures.
#pragma once
#include <string>

#include "validation/report/report_html.hpp"

namespace heartgen::report {

std::string header_html(const ReportInput& input);

/// "Fit for X and Y; unfit for Z." Empty where no use was judged.
std::string uses_sentence(const std::vector<UseVerdict>& uses);

}  // namespace heartgen::report
