// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Every reader of files from elsewhere, fed with bytes.
#pragma once
#include <string>
#include <vector>

namespace heartgen::fuzz {

/// Kinds of files, as the folders of corpus/ are called.
std::vector<std::string> kinds();

/// Gives `bytes` to the readers of a kind, as a file in `folder`. A UserError is a right answer; anything else that is
/// thrown goes on.
void feed(const std::string& kind, const std::string& bytes, const std::string& folder);

/// Little memory, so that a count that is believed is noticed.
void limit_memory();

}  // namespace heartgen::fuzz
