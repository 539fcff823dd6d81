// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Flows followed towards a known segmentation: the curves of Figs 5.6, 5.9 and 5.13.
#pragma once
#include <string>
#include <vector>

#include "benchmarks/study/study.hpp"
#include "benchmarks/study/two_phase.hpp"

namespace heartgen::study {

struct FollowedFlow {
  std::string name;
  Field start;
  FlowSettings settings;
  FlowResult result{};
  Curve distance{};  ///< pixels that differ from the reference (5.22), at iterations about 4 % apart
};

/// Runs all flows, in as many threads as there are; each is serial, so the results do not depend on the threads.
void follow(const Field& image, const Domain& domain, const PixelLabels& reference, std::vector<FollowedFlow>& flows);

/// The first iteration from which on no more than `pixels` differ; -1 when the curve ends above.
int settled_within(const Curve& distance, double pixels);
std::string settled_text(const Curve& distance, double pixels);

}  // namespace heartgen::study
