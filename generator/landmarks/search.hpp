// Private to this folder: the search as a whole, with everything it leaves behind (for tests and pictures).
#pragma once
#include "generator/landmarks/landmarks.hpp"

namespace heart::landmarks {

struct SearchResult {
  FoundLandmarks found;
  LabelVolume chambers;  ///< the pools on the working grid, around the heart
};

/// As find_landmarks.
SearchResult search(const CtVolume& ct);

}  // namespace heart::landmarks
