// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What the VTK readers and writers share: errors. Plain header, VTK itself stays in the .cpp.
#pragma once
#include <filesystem>
#include <functional>
#include <string>

namespace heartgen::adapters {

/// Runs a VTK reader or writer. A false result, any error message of VTK (captured, never printed) or a lack of memory
/// becomes a UserError "path: action: message". VTK has one message window per process: calls are serialised.
void run_guarded(const std::filesystem::path& path, const std::string& action, const std::function<bool()>& run);

}  // namespace heartgen::adapters
