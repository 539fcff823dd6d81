// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What a build tells of its stages to whoever asks.
#pragma once
#include <cstddef>
#include <string>

namespace heartgen::pipeline {

/// A stage of a build as it begins and as it ends.
struct StageEvent {
  std::string name;        ///< "read", "segment", "mesh" ...
  std::size_t number = 0;  ///< counted from 1
  std::size_t count = 0;   ///< stages of this build, as far as is known
  double share = 0;        ///< of the whole work that is done, 0 to 1; an estimate
  bool has_ended = false;  ///< false: it begins
};

}  // namespace heartgen::pipeline
