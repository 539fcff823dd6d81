// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What is being written and has not got its name yet: it goes when the program is stopped.
#pragma once
#include <filesystem>

namespace heartgen {

/// Called before the file or folder is made.
void note_unfinished(const std::filesystem::path& path);

/// Called before it takes its place, or is removed.
void forget_unfinished(const std::filesystem::path& path);

/// Removes all that is noted. Whoever calls one of these functions later waits for ever: the program is about to end,
/// and nothing may be made or moved any more.
void remove_unfinished();

/// Returns at once, but after remove_unfinished has begun: then never.
void wait_where_stopped();

}  // namespace heartgen
