// What an atlas's own fibres are like, beside what was carried: for the certificate.
// Not collective; the same bits for any number of threads.
#pragma once
#include <vector>

#include "generator/fibers/hearts.hpp"
#include "model/depth_samples.hpp"

namespace heart::fibers {

struct AtlasFigures {
  Both<DepthSamples> atlas, carried;  ///< at most 20,000 places each, evenly chosen
  double turn_p99_deg_per_mm = 0;     ///< angle between the axes at an edge's ends by its length, 99th percentile over
                                      ///< the edges of the atlas's cells
};

/// `carried`: unit axes at the points of `walls`; only points at which `use` is not 0 and that one ventricle alone
/// decides are taken.
AtlasFigures atlas_figures(const Hearts& hearts, const atlas::FiberAtlas& atlas, const PointWalls& walls,
                           const std::vector<Vec3>& carried, const std::vector<std::uint8_t>& use);

}  // namespace heart::fibers
