// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/study/convergence.hpp"

#include "generator/parallel/threads.hpp"

namespace heartgen::study {
namespace {

void follow_one(const Field& image, const Domain& domain, const PixelLabels& reference, FollowedFlow& flow) {
  const auto note = [&](int iteration, const Field& phi) {
    flow.distance.x.push_back(iteration);
    flow.distance.y.push_back(static_cast<double>(differing_pixels(positive_side(phi, domain), reference, domain)));
  };
  flow.distance.name = flow.name;
  int next = 1;
  const auto watch = [&](int iteration, const Field& phi) {
    if (iteration < next) return true;
    note(iteration, phi);
    next = std::max(iteration + 1, iteration + iteration / 25);
    return true;
  };
  flow.result = chan_vese_flow(image, flow.start, domain, flow.settings, watch);
  note(flow.result.iterations, flow.result.phi);
}

}  // namespace

void follow(const Field& image, const Domain& domain, const PixelLabels& reference, std::vector<FollowedFlow>& flows) {
  const auto count = static_cast<std::int64_t>(flows.size());
  const std::int64_t lanes = std::min<std::int64_t>(parallel::thread_count(), count);
  // Flow n goes to lane n modulo lanes: neighbours in the list tend to cost the same.
  parallel::parallel_for(0, lanes, [&](std::int64_t begin, std::int64_t end) {
    for (auto lane = begin; lane < end; ++lane)
      for (auto n = lane; n < count; n += lanes)
        follow_one(image, domain, reference, flows[static_cast<std::size_t>(n)]);
  });
}

int settled_within(const Curve& distance, double pixels) {
  int settled = -1;
  for (std::size_t n = distance.x.size(); n-- > 0 && distance.y[n] <= pixels;)
    settled = static_cast<int>(distance.x[n]);
  return settled;
}

std::string settled_text(const Curve& distance, double pixels) {
  const int settled = settled_within(distance, pixels);
  return settled < 0 ? "not reached" : std::to_string(settled);
}

}  // namespace heartgen::study
