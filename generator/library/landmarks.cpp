// SPDX-License-Identifier: GPL-3.0-or-later
#include <heartgen/landmarks.hpp>

#include "generator/anatomy/padding.hpp"

namespace heartgen {

FoundLandmarks find_landmarks(CtVolume ct) {
  anatomy::close_padding(ct, anatomy::find_padding(ct));
  return landmarks::find_landmarks(ct);
}

}  // namespace heartgen
