// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Hearts to name: phantoms of many kinds, drawn at random, some of them no hearts, or not whole.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "datasets/phantom/phantom.hpp"
#include "model/volume.hpp"

namespace heartgen::lab {

struct NamingCase {
  std::string kind, name;
  CtVolume ct;
  phantom::HeartModel model;              ///< what is where
  std::vector<std::string> reason_words;  ///< empty: a heart that must be found; else one of them is in the right
                                          ///< reason to refuse it ("": any reason will do)
};

/// One kind of case, the n-th of which is drawn from a seed.
struct CaseKind {
  std::string name;
  std::function<NamingCase(std::uint64_t seed, int n)> draw;
};

const std::vector<CaseKind>& naming_kinds();

}  // namespace heartgen::lab
