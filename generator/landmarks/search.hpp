// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The search as a whole, with everything it leaves behind (for tests and pictures).
#pragma once
#include <string>
#include <utility>

#include "generator/landmarks/landmarks.hpp"
#include "model/error.hpp"

namespace heartgen::landmarks {

/// Something was found that is no heart. What to check first depends on the image's header and field of view, which the
/// place that throws does not know: it says what it suspects itself.
struct NotAHeart : UserError {
  std::string suspicion;
  NotAHeart(std::string problem_, std::string suspicion_)
      : UserError(std::move(problem_), "landmarks", suspicion_), suspicion(std::move(suspicion_)) {}
};

struct SearchResult {
  FoundLandmarks found;
  LabelVolume chambers;  ///< the pools on the working grid, around the heart
};

/// As find_landmarks.
SearchResult search(const CtVolume& ct);

}  // namespace heartgen::landmarks
