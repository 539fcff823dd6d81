// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// How much memory there is for this process.
#pragma once
#include <filesystem>
#include <string>

namespace heartgen {

/// What this process may take, in bytes: the least of the machine's memory, the limits of its cgroups (version 1 and 2,
/// its own and all above it), `ulimit -v` and `ulimit -d`, and set_memory_limit; 0: unknown. Of all processes of a
/// machine together only where they share a cgroup.
double memory_bytes();

/// The user's own limit; 0: none.
void set_memory_limit(double bytes);

/// "512M", "8G", "8GiB", "1.5 TB" or a plain number of bytes: letters stand for powers of 1024, with "B" alone behind
/// them for powers of 1000. Throws UserError naming `where` for anything else, and for less than 1 MiB.
double bytes_of_text(const std::string& text, const std::string& where);

/// "3.2 GiB", "512 MiB"
std::string text_of_bytes(double bytes);

/// The least limit that the cgroups of a process set, in bytes; infinity: none. `membership` is its /proc/self/cgroup,
/// `mounts` the folder where cgroups are mounted.
double cgroup_bytes(const std::filesystem::path& membership, const std::filesystem::path& mounts);

}  // namespace heartgen
