// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/naming/problem.hpp"

#include <algorithm>
#include <cmath>

#include "generator/chest/working_image.hpp"
#include "generator/image/distance.hpp"
#include "generator/parallel/threads.hpp"
#include "model/mathematics.hpp"
#include "model/quantile.hpp"

namespace heartgen::naming {
namespace {

Whole in_units(double cost) { return std::llround(cost / cost_unit); }

double square(double x) { return x * x; }

/// Sums over voxels, depths and faces on the image's border.
void measure_voxels(const Scene& scene, const Pieces& pieces, const Volume<float>& depth, Problem& problem) {
  std::vector<double> room_depth(problem.pieces.size(), 0);
  const auto& size = scene.hu.grid.size;
  std::size_t v = 0;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i, ++v) {
        const auto label = pieces.label.voxels[v];
        if (label == 0) continue;
        const auto n = static_cast<std::size_t>(label - 1);
        Piece& piece = problem.pieces[n];
        const Index3 at{i, j, k};
        ++piece.voxels;
        piece.peak_mm = std::max(piece.peak_mm, static_cast<double>(depth.voxels[v]));
        room_depth[n] += static_cast<double>(scene.room_depth_mm.voxels[v]);
        for (std::size_t a = 0; a < 3; ++a) {
          piece.index_sum[a] += at[a];
          piece.square_sum[a] += at[a] * at[a];
          piece.border[2 * a] += at[a] == scene.view.begin[a];
          piece.border[2 * a + 1] += at[a] + 1 == scene.view.end[a];
        }
      }
  for (std::size_t n = 0; n < room_depth.size(); ++n)
    problem.pieces[n].room_depth_mm = room_depth[n] / static_cast<double>(problem.pieces[n].voxels);
}

void measure_grey(const Scene& scene, const Levels& levels, const Pieces& pieces, Problem& problem) {
  std::vector<std::vector<float>> hu(problem.pieces.size());
  for (std::size_t v = 0; v < pieces.label.voxels.size(); ++v)
    if (const auto label = pieces.label.voxels[v]; label > 0)
      hu[static_cast<std::size_t>(label - 1)].push_back(scene.smooth.voxels[v]);
  const double brightest = levels.blood_hu + grey_saturates * levels.contrast_hu();
  for (std::size_t n = 0; n < hu.size(); ++n)
    problem.pieces[n].hu = std::llround(std::min(static_cast<double>(upper_median(hu[n])), brightest));
}

/// Voxels of a shell outside the piece that are no blood, and those of them that are as grey as muscle.
void measure_shell(const Scene& scene, const Levels& levels, const Pieces& pieces, std::int32_t label, Piece& piece) {
  constexpr auto margin = static_cast<std::int64_t>(shell_to_mm / spacing_mm) + 1;
  const Box box = bounding_box(pieces.label, margin, [&](std::int32_t l) { return l == label; });
  const auto part = crop(pieces.label, box);
  const auto hu = crop(scene.smooth, box);
  const auto outside = image::distance_to(
      chest::mask_where(part.grid, [&](const Vec3&, std::size_t v) { return part.voxels[v] == label; }));
  for (std::size_t v = 0; v < part.voxels.size(); ++v) {
    const auto distance = static_cast<double>(outside.voxels[v]), grey = static_cast<double>(hu.voxels[v]);
    if (part.voxels[v] != 0 || distance <= shell_from_mm || distance >= shell_to_mm) continue;
    ++piece.shell;
    piece.muscle += grey > levels.muscle_hu - darker_muscle_hu &&
                    grey < levels.muscle_hu + brighter_muscle_share * levels.contrast_hu();
  }
}

/// What a border of names between two pieces costs: nothing at a neck or a step of grey.
double cut_cost(const Piece& a, const Piece& b, const image::Contact& contact, double contrast_hu) {
  const double ratio = contact.width_mm / std::min(a.peak_mm, b.peak_mm);
  const double step = static_cast<double>(a.hu - b.hu) / (grey_step * contrast_hu);
  return cut_per_cm2 * contact.area_mm2 / 100 * std::clamp((ratio - neck_ratio) / (1 - neck_ratio), 0.0, 1.0) *
         math::exp(-step * step);
}

void find_neighbours(const Pieces& pieces, const Volume<float>& depth, Problem& problem) {
  image::Basins basins{pieces.label, depth, static_cast<std::int32_t>(problem.pieces.size()), {}};
  image::measure_contacts(basins);
  for (const auto& [pair, contact] : basins.contacts) {
    const int a = pair.first - 1, b = pair.second - 1;
    Piece &one = problem.pieces[static_cast<std::size_t>(a)], &other = problem.pieces[static_cast<std::size_t>(b)];
    const Whole faces = std::llround(contact.area_mm2 / (spacing_mm * spacing_mm));
    const Whole cut = in_units(cut_cost(one, other, contact, problem.contrast_hu));
    one.neighbours.push_back({b, faces, cut});
    other.neighbours.push_back({a, faces, cut});
  }
}

/// What a piece costs under each name by itself.
void set_own_costs(Piece& piece) {
  const double ml = piece.ml();
  const auto set = [&](Name name, double cost) { piece.own_cost[static_cast<std::size_t>(name)] += in_units(cost); };
  if (piece.peak_mm > unnamed_peak_mm) {
    const double deep = std::clamp((piece.room_depth_mm - deep_from_mm) / (deep_to_mm - deep_from_mm), 0.0, 1.0);
    set(Name::other,
        std::min(unnamed_per_ml * ml, max_unnamed) * deep * (piece.level > shallow_level ? 1 : shallow_share));
  }
  const double at_rim = std::clamp((rim_mm - piece.room_depth_mm) / rim_softness_mm, 0.0, 1.0);
  const double in_spine = std::clamp((piece.from_spine_mm.y + on_spine_mm) / on_spine_softness_mm, 0.0, 3.0);
  for (int n = 1; n < name_count; ++n) {
    const auto name = static_cast<Name>(n);
    if (name == Name::descending_aorta) continue;
    if (name != Name::ivc) set(name, rim_cost * at_rim * std::min(ml, rim_ml) / 2);  // its way leaves the room
    set(name, 0.5 * square(in_spine) * std::min(ml / on_spine_ml, 1.0));
  }
  const double before = std::clamp((-piece.from_spine_mm.y - before_spine_mm) / before_spine_softness_mm, 0.0, 9.0);
  set(Name::descending_aorta, 0.5 * square(before) * std::min(ml / on_spine_ml, 1.0));
}

}  // namespace

Vec3 Piece::center_mm() const {
  const auto mean = [&](std::size_t a) {
    return spacing_mm * static_cast<double>(index_sum[a]) / static_cast<double>(voxels);
  };
  return {mean(0), mean(1), mean(2)};
}

Problem make_problem(const Scene& scene, const Levels& levels, const Pieces& pieces) {
  Problem problem;
  problem.contrast_hu = levels.contrast_hu();
  problem.pieces.resize(pieces.level.size() - 1);
  for (int a = 0; a < 3; ++a) {
    problem.view_from_mm[a] = spacing_mm * static_cast<double>(scene.view.begin[static_cast<std::size_t>(a)]);
    problem.view_to_mm[a] = spacing_mm * static_cast<double>(scene.view.end[static_cast<std::size_t>(a)] - 1);
  }
  const auto depth = chest::depth_of(
      chest::mask_where(scene.hu.grid, [&](const Vec3&, std::size_t v) { return pieces.label.voxels[v] > 0; }));
  measure_voxels(scene, pieces, depth, problem);
  measure_grey(scene, levels, pieces, problem);
  parallel::parallel_for(0, std::ssize(problem.pieces), [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t n = begin; n < end; ++n)
      measure_shell(scene, levels, pieces, static_cast<std::int32_t>(n + 1),
                    problem.pieces[static_cast<std::size_t>(n)]);
  });
  find_neighbours(pieces, depth, problem);
  for (std::size_t n = 0; n < problem.pieces.size(); ++n) {
    Piece& piece = problem.pieces[n];
    piece.level = pieces.level[n + 1];
    const Vec3 center = scene.hu.grid.origin_mm + piece.center_mm();
    piece.from_spine_mm = center - scene.spine.at(center.z);
    set_own_costs(piece);
  }
  return problem;
}

Problem mirrored(const Problem& problem) {
  Problem result = problem;
  for (auto& piece : result.pieces) {
    piece.index_sum[0] *= -1;
    std::swap(piece.border[0], piece.border[1]);
    piece.from_spine_mm.x *= -1;
  }
  result.view_from_mm.x = -problem.view_to_mm.x;
  result.view_to_mm.x = -problem.view_from_mm.x;
  return result;
}

}  // namespace heartgen::naming
