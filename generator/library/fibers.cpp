// SPDX-License-Identifier: GPL-3.0-or-later
#include <heartgen/fibers.hpp>
#include <utility>

#include "generator/fibers/map_fibers.hpp"
#include "generator/pipeline/pipeline.hpp"

namespace heartgen {

FiberAtlas standin_atlas() { return pipeline::standin_atlas(); }

MappedFibers map_fibers(TetMesh myocardium, const LabelVolume& labels, const Landmarks& landmarks,
                        const FiberAtlas& atlas, const FiberSettings& settings) {
  fibers::check_settings(settings);
  auto result = fibers::map_fibers(myocardium, labels, landmarks, atlas, settings);
  myocardium.node_fibers = std::move(result.node);
  myocardium.cell_fibers = std::move(result.cell);
  myocardium.fiber_source = std::move(result.source);
  myocardium.rule_difference_deg = std::move(result.rule_difference_deg);
  return {std::move(myocardium), result.atlas_overlap, result.min_jacobian, std::move(result.warnings)};
}

}  // namespace heartgen
