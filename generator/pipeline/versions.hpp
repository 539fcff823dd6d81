// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Versions of this program and of the libraries that shape its results.
#pragma once
#include <map>
#include <string>

namespace heartgen::pipeline {

std::string program_version();
std::map<std::string, std::string> tool_versions();

}  // namespace heartgen::pipeline
