// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/naming/naming.hpp"

#include <fmt/format.h>

#include "generator/naming/verdict.hpp"

namespace heartgen::naming {
namespace {

/// The search for the mirrored heart needs no better than its energy.
constexpr Effort mirror_effort{12, 1, 3, 100, 200};

LabelVolume names_of(const Pieces& pieces, const std::vector<Name>& names) {
  LabelVolume volume(pieces.label.grid);
  for (std::size_t v = 0; v < volume.voxels.size(); ++v)
    if (const auto label = pieces.label.voxels[v]; label > 0)
      volume.voxels[v] = static_cast<std::uint8_t>(names[static_cast<std::size_t>(label - 1)]);
  return volume;
}

double mirrored_energy(const Problem& problem) {
  const Problem exchanged = mirrored(problem);
  const auto names = solve(exchanged, mirror_effort);
  return names.empty() ? 1e9 : Labelling(exchanged, names).energy();
}

}  // namespace

Naming name_blood(const CtVolume& ct) {
  const Scene scene = make_scene(ct);
  Naming naming;
  naming.levels = find_levels(scene.smooth, scene.room);
  if (!naming.levels.has_contrast()) {
    naming.reasons = {
        fmt::format("the blood in the heart is not brighter than its muscle: only {:.0f} ml deep between "
                    "the lungs are above {:.0f} HU",
                    naming.levels.deep_ml, enhanced_hu)};
    return naming;
  }
  const Pieces pieces = cut_into_pieces(scene, naming.levels, find_walls(scene, naming.levels));
  const Problem problem = make_problem(scene, naming.levels, pieces);
  naming.pieces = static_cast<int>(problem.pieces.size());
  auto names = solve(problem);
  if (names.empty()) {
    naming.reasons = {"no blood deep between the lungs has a shell of muscle around it, as the left ventricle has"};
    return naming;
  }
  const auto [solution, margins] = judge_margins(problem, std::move(names));
  const Labelling labelling(problem, solution.names);
  naming.names = names_of(pieces, solution.names);
  naming.terms = labelling.terms();
  naming.mirrored_energy = mirrored_energy(problem);
  for (int n = 0; n < name_count; ++n) {
    const auto name = static_cast<Name>(n);
    if (labelling.ml(name) > 0)
      naming.bodies[static_cast<std::size_t>(n)] = {labelling.ml(name), labelling.hu(name),
                                                    scene.hu.grid.origin_mm + labelling.center_mm(name),
                                                    margins[static_cast<std::size_t>(n)]};
  }
  judge(labelling, naming);
  return naming;
}

}  // namespace heartgen::naming
