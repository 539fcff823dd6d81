// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// `heartgen-lab study`: the thesis's analysis of the Chan-Vese model, repeated and measured.
#pragma once
#include <string>
#include <vector>

namespace heartgen::lab {

struct StudyCommand {
  std::vector<std::string> names;  ///< empty: all
  std::string output;              ///< folder; empty: print only
  bool quick = false, json = false;
};

/// Runs the studies, prints their tables and what became of each statement of the thesis, and writes tables, plots,
/// pictures and index.html. Returns 0 whether or not the statements hold: they are results. Throws UserError for an
/// unknown name.
int study_command(const StudyCommand& command);

/// The names with what they do, one a line.
std::string study_help();

}  // namespace heartgen::lab
