// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What a number about patients is. All of them stand in model/tissue.hpp (how grey) and model/priors.hpp (how large),
/// once each: docs/numbers.md. Other constants say how the program looks (voxels, smoothing, tolerances), not what a
/// body is like.
#pragma once

namespace heartgen {

/// Where a value comes from.
enum class Basis {
  paper,      ///< a paper bears it out: a key of docs/references.bib and what it says. None was read before the choice
  data,       ///< set on images that the source names
  reasoning,  ///< follows from another number or a definition, which the source gives
  unrecorded  ///< chosen while the program grew; nobody wrote down on which images
};

/// The source of most: nobody wrote it down. Papers that were looked up later, and name these values' bounds, are
/// named.
inline constexpr const char* not_recorded =
    "Not recorded; chosen while the program was tried on phantoms and the CTs at hand (LIDC 0001, a cardiac CTA)";

/// Reads as its value: `depth_mm < priors::metal_rim_mm`. It is no constant expression, so that nothing can keep a copy
/// of it from before the program runs.
struct Number {
  const char* name;
  double value;
  const char* unit;  ///< "1": a share or a ratio
  double min, max;   ///< what adults have, or between which values the meaning holds
  const char* meaning;
  Basis basis;
  const char* source;

  operator double() const;
};

constexpr Number number(const char* name, double value, const char* unit, double min, double max, const char* meaning,
                        Basis basis = Basis::unrecorded, const char* source = not_recorded) {
  return {name, value, unit, min, max, meaning, basis, source};
}

/// Null in heartgen: numbers are what they are. `heartgen-lab sensitivity` reads them through this function, to see
/// which are read and to move one of them. Set before threads start.
inline double (*read_number_instead)(const Number&) = nullptr;

inline Number::operator double() const { return read_number_instead == nullptr ? value : read_number_instead(*this); }

}  // namespace heartgen
