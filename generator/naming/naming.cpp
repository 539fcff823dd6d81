// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/naming/naming.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "generator/chest/working_image.hpp"
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

/// A chamber is one body: pieces of its name that do not hang together with the most of it are something else, as far
/// away as they may lie (bone or liver at the image's border).
void drop_strays(const Problem& problem, std::vector<Name>& names) {
  for (const Name chamber : {Name::lv, Name::la, Name::rv, Name::ra}) {
    std::vector<std::vector<int>> bodies;
    std::vector<std::uint8_t> is_seen(names.size(), 0);
    for (std::size_t first = 0; first < names.size(); ++first) {
      if (names[first] != chamber || is_seen[first]) continue;
      auto& body = bodies.emplace_back(std::vector<int>{static_cast<int>(first)});
      is_seen[first] = 1;
      for (std::size_t next = 0; next < body.size(); ++next)
        for (const auto& neighbour : problem.pieces[static_cast<std::size_t>(body[next])].neighbours) {
          const auto n = static_cast<std::size_t>(neighbour.piece);
          if (names[n] != chamber || is_seen[n]) continue;
          is_seen[n] = 1;
          body.push_back(neighbour.piece);
        }
    }
    const auto voxels = [&](const std::vector<int>& body) {
      Whole sum = 0;
      for (const int piece : body) sum += problem.pieces[static_cast<std::size_t>(piece)].voxels;
      return sum;
    };
    const auto most = std::max_element(bodies.begin(), bodies.end(),
                                       [&](const auto& a, const auto& b) { return voxels(a) < voxels(b); });
    for (auto body = bodies.begin(); body != bodies.end(); ++body)
      if (body != most)
        for (const int piece : *body) names[static_cast<std::size_t>(piece)] = Name::other;
  }
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
  naming.spine = scene.spine;
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
  auto [solution, margins] = judge_margins(problem, std::move(names));
  drop_strays(problem, solution.names);
  const Labelling labelling(problem, solution.names);
  naming.names = names_of(pieces, solution.names);
  naming.others = chest::mask_where(naming.names.grid, [&](const Vec3&, std::size_t v) {
    return pieces.label.voxels[v] > 0 && naming.names.voxels[v] == 0;
  });
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
