// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// heartgen get: a released bundle, downloaded, checked and unpacked.
#pragma once
#include <string>

namespace heartgen::app {

struct GetCommand {
  std::string source;  ///< a file made by heartgen pack, or where it can be downloaded: https://...
  std::string folder;  ///< to make
  std::string sha256;  ///< of the file; empty: what stands in SOURCE.sha256, where there is one
  bool json = false;
};

/// Throws UserError where the file cannot be had, is not the one that its checksum names, or is no bundle; `folder` is
/// not made then. Not collective.
int get_command(const GetCommand& command);

}  // namespace heartgen::app
