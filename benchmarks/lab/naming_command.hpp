// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// `heartgen-lab naming`: which piece of blood is which part of the heart, and how often that is right.
#pragma once
#include <string>
#include <vector>

namespace heartgen::lab {

struct NamingCommand {
  std::vector<std::string> cts;    ///< named and printed; empty: the table of phantoms
  std::string output;              ///< label map of the names to write, of the first CT
  std::vector<std::string> kinds;  ///< of the table, by the begin of their names; empty: all
  int cases = 3;                   ///< of each kind
  int seed = 1;
  bool tree = false;  ///< also what `landmarks` finds
};

int naming_command(const NamingCommand& command);

}  // namespace heartgen::lab
