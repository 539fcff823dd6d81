// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The two ways of failing: the user's input (UserError, exit code 2) and our own defects (anything else, 1).
#pragma once
#include <exception>
#include <string>

namespace heartgen {

/// A mistake in the user's input: what is wrong, where (file, key, line), and what to do about it.
/// main prints the three in one line and exits with code 2.
struct UserError : std::exception {
  std::string problem;
  std::string where;
  std::string remedy;
  std::string message;

  UserError(std::string problem_, std::string where_, std::string remedy_)
      : problem(std::move(problem_)), where(std::move(where_)), remedy(std::move(remedy_)) {
    message = where.empty() ? problem : where + ": " + problem;
    if (!remedy.empty()) message += " (" + remedy + ")";
  }
  const char* what() const noexcept override { return message.c_str(); }
};

}  // namespace heartgen
