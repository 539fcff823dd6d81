// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Which piece of blood is which part of the heart. The room between the lungs is cut into some hundred pieces of
/// blood; all get their names at once, by the labelling of least cost (place, volume, shape, grey value, muscle, what
/// opens into what). How much dearer the next best name is tells how sure a name is; a mirrored heart is told by the
/// mirrored labelling that fits better.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "generator/naming/margins.hpp"
#include "model/volume.hpp"

namespace heartgen::naming {

enum class Verdict : std::uint8_t { found, doubtful, no_heart };

struct NamedBody {
  double ml = 0, hu = 0;  ///< 0 ml: not found. hu: mean
  Vec3 center_mm;         ///< LPS
  Margin margin;
};

struct Naming {
  Verdict verdict = Verdict::no_heart;
  std::vector<std::string> reasons;  ///< why not `found`, in words, the weightiest first
  std::array<NamedBody, name_count> bodies{};
  LabelVolume names;  ///< values of Name, on a grid of 2 mm along the LPS axes around the room; empty without contrast
  Mask others;        ///< pieces of other blood, on the same grid
  chest::Spine spine;
  Levels levels;
  int pieces = 0;
  Terms terms;                 ///< of the labelling's cost
  double mirrored_energy = 0;  ///< of the best labelling with left and right exchanged

  const NamedBody& operator[](Name name) const { return bodies[static_cast<std::size_t>(name)]; }
};

/// `ct` in Hounsfield units, of any spacing and orientation. The same bits for any number of threads. Throws UserError
/// where there are no lungs, or for an image that is too thin.
Naming name_blood(const CtVolume& ct);

}  // namespace heartgen::naming
