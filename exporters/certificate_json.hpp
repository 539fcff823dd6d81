// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A certificate as JSON: validation/metrics.json of a bundle, and what `--json` prints.
#pragma once
#include <filesystem>
#include <string>

#include "model/certificate.hpp"

namespace heartgen::exporters {

/// Keys `passed`, `verdict`, `warnings`, `uses`, `rows`. Numbers that are not finite become null.
std::string certificate_json(const Certificate& certificate);

/// validation/metrics.json of a bundle. Throws UserError where it is malformed.
Certificate read_certificate(const std::filesystem::path& folder);

}  // namespace heartgen::exporters
