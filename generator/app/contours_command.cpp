// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/app/contours_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "generator/adapters/itk_io.hpp"
#include "generator/pde/active_contours.hpp"
#include "generator/pde/edge_function.hpp"
#include "generator/pde/snake.hpp"
#include "generator/pde/subjective_surface.hpp"
#include "model/error.hpp"
#include "model/text.hpp"

namespace heartgen::app {
namespace {

using Json = nlohmann::ordered_json;

const std::vector<std::string> methods = {"geodesic", "geometric", "snake", "subjective"};

std::vector<Vec3> seeds_of(const ContoursCommand& command) {
  if (command.seeds.empty() || command.seeds.size() % 3 != 0)
    throw UserError("a seed has three coordinates", "contours --seed", "give x,y,z in LPS mm, for a 2D image z too");
  std::vector<Vec3> seeds;
  for (std::size_t i = 0; i < command.seeds.size(); i += 3)
    seeds.push_back({command.seeds[i], command.seeds[i + 1], command.seeds[i + 2]});
  return seeds;
}

/// What a run gives: the object, φ where there is one, and how it ended.
struct Outcome {
  Mask inside;
  Volume<float> surface;
  std::string end;
  int iterations = 0;
};

pde::EdgeSettings edges_of(const ContoursCommand& command, const Volume<float>& image, const parallel::Comm& comm) {
  pde::EdgeSettings edges{command.smoothing_mm, command.edge_per_mm};
  if (edges.edge_per_mm == 0)
    edges.edge_per_mm =
        parallel::run_on_root(comm, [&] { return pde::default_edge_per_mm(image, edges.smoothing_mm); });
  parallel::broadcast(comm, edges.edge_per_mm);
  return edges;
}

Outcome run_level_set(const ContoursCommand& command, const Volume<float>& image, const parallel::Comm& comm) {
  const bool geodesic = command.method == "geodesic";
  pde::ContourSettings settings;
  settings.model = geodesic ? pde::ContourModel::geodesic : pde::ContourModel::geometric;
  settings.curvature_mm = command.curvature_mm;
  settings.attraction_mm = command.attraction_mm < 0 ? command.curvature_mm : command.attraction_mm;
  settings.balloon = command.balloon;
  if (command.iterations >= 0) settings.max_iterations = command.iterations;
  const auto start =
      parallel::run_on_root(comm, [&] { return pde::balls(image.grid, seeds_of(command), command.start_radius_mm); });
  auto found = pde::evolve_contour(image, start, edges_of(command, image, comm), settings, comm);
  return {pde::inside_of(found.level_set), std::move(found.level_set), pde::name_of(found.end), found.iterations};
}

Outcome run_subjective(const ContoursCommand& command, const Volume<float>& image, const parallel::Comm& comm) {
  pde::SubjectiveSettings settings;
  if (command.iterations >= 0) settings.max_iterations = command.iterations;
  const auto seeds = seeds_of(command);
  auto found = pde::subjective_surface(image, seeds, edges_of(command, image, comm), settings, comm);
  Mask object = comm.is_root() ? pde::object_of(found, seeds, command.share) : Mask{};
  return {std::move(object), std::move(found.surface), found.steady ? "steady" : "out of iterations", found.iterations};
}

Outcome run_snake(const ContoursCommand& command, const Volume<float>& image) {
  const auto self = parallel::self();
  const auto h =
      parallel::gather(pde::edge_function(parallel::scatter(image, self), edges_of(command, image, self), self), self);
  const auto seeds = seeds_of(command);
  if (seeds.size() != 1) throw UserError("a snake starts around one seed", "contours --seed", "give one");
  const Vec3 index = index_from_lps(image.grid, seeds.front());
  pde::SnakeSettings settings;
  settings.tension_mm = command.tension_mm;
  settings.rigidity_mm3 = command.rigidity_mm3;
  if (command.attraction_mm >= 0) settings.attraction_mm = command.attraction_mm;
  settings.balloon = command.balloon;
  if (command.iterations >= 0) settings.max_iterations = command.iterations;
  const pde::Point2 center{index.x * image.grid.spacing_mm.x, index.y * image.grid.spacing_mm.y};
  const auto found = pde::evolve_snake(pde::circle(center, command.start_radius_mm, 64), h, settings);
  return {pde::inside_of(found.curve, image.grid), {}, pde::name_of(found.end), found.iterations};
}

void print_outcome(const ContoursCommand& command, const Outcome& outcome) {
  const auto voxels = std::ranges::count(outcome.inside.voxels, std::uint8_t{1});
  const auto& grid = outcome.inside.grid;
  const bool flat = grid.size[2] == 1;
  const double size =
      static_cast<double>(voxels) * (flat ? grid.spacing_mm.x * grid.spacing_mm.y : grid.voxel_volume_mm3());
  if (command.json)
    fmt::print("{}\n", Json{{"method", command.method},
                            {"end", outcome.end},
                            {"iterations", outcome.iterations},
                            {"voxels", voxels},
                            {flat ? "area_mm2" : "volume_mm3", size}}
                           .dump(1));
  else
    fmt::print("{}: {} after {} iterations, {} voxels inside ({:.1f} {})\n{}\n", command.method, outcome.end,
               outcome.iterations, voxels, size, flat ? "mm2" : "mm3", command.output);
}

void check_command(const ContoursCommand& command) {
  if (std::ranges::find(methods, command.method) == methods.end())
    throw UserError("unknown method \"" + command.method + "\"", "contours",
                    "did you mean \"" + nearest_name(command.method, methods) +
                        "\"? Known: " + fmt::format("{}", fmt::join(methods, ", ")));
  if (!(command.share > 0 && command.share < 1))
    throw UserError(fmt::format("a share of {:g}", command.share), "contours --share", "give one between 0 and 1");
  constexpr double max_balloon = 1000;  // times the speed by curvature of a radius of a millimetre
  if (!(std::abs(command.balloon) <= max_balloon))
    throw UserError(fmt::format("a speed of {:g}", command.balloon), "contours --balloon",
                    fmt::format("give one between -{0:g} and {0:g}", max_balloon));
}

}  // namespace

int contours_command(const ContoursCommand& command, const parallel::Comm& comm) {
  check_command(command);
  adapters::check_image_output(command.output);
  if (!command.surface.empty()) adapters::check_image_output(command.surface);
  const auto image = parallel::run_on_root(comm, [&] { return adapters::read_image(command.input); });
  Outcome outcome;
  if (command.method == "snake")
    outcome = parallel::run_on_root(comm, [&] { return run_snake(command, image); });
  else if (command.method == "subjective")
    outcome = run_subjective(command, image, comm);
  else
    outcome = run_level_set(command, image, comm);
  parallel::run_on_root(comm, [&] {
    adapters::write_volume(command.output, outcome.inside);
    if (!command.surface.empty() && !outcome.surface.voxels.empty())
      adapters::write_volume(command.surface, outcome.surface);
    print_outcome(command, outcome);
  });
  return 0;
}

}  // namespace heartgen::app
