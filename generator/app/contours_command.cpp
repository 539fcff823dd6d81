#include "generator/app/contours_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "generator/adapters/itk_io.hpp"
#include "generator/contours/active_contours.hpp"
#include "generator/contours/broken_circle.hpp"
#include "generator/contours/edge_function.hpp"
#include "generator/contours/snake.hpp"
#include "generator/contours/subjective_surface.hpp"
#include "model/error.hpp"
#include "model/text.hpp"
#include "validation/pictures.hpp"

namespace heart::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

const std::vector<std::string> methods = {"broken-circle", "geodesic", "geometric", "snake", "subjective"};

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

contours::EdgeSettings edges_of(const ContoursCommand& command, const Volume<float>& image,
                                const parallel::Comm& comm) {
  contours::EdgeSettings edges{command.smoothing_mm, command.edge_per_mm};
  if (edges.edge_per_mm == 0)
    edges.edge_per_mm =
        parallel::run_on_root(comm, [&] { return contours::usual_edge_per_mm(image, edges.smoothing_mm); });
  parallel::broadcast(comm, edges.edge_per_mm);
  return edges;
}

Outcome run_level_set(const ContoursCommand& command, const Volume<float>& image, const parallel::Comm& comm) {
  const bool geodesic = command.method == "geodesic";
  contours::ContourSettings settings;
  settings.model = geodesic ? contours::ContourModel::geodesic : contours::ContourModel::geometric;
  settings.curvature_mm = command.curvature_mm;
  settings.attraction_mm = command.attraction_mm < 0 ? command.curvature_mm : command.attraction_mm;
  settings.balloon = command.balloon;
  if (command.iterations >= 0) settings.max_iterations = command.iterations;
  const auto start =
      parallel::run_on_root(comm, [&] { return contours::balls(image.grid, seeds_of(command), command.radius_mm); });
  auto found = contours::evolve_contour(image, start, edges_of(command, image, comm), settings, comm);
  return {contours::inside_of(found.level_set), std::move(found.level_set), contours::name_of(found.end),
          found.iterations};
}

Outcome run_subjective(const ContoursCommand& command, const Volume<float>& image, const parallel::Comm& comm) {
  contours::SubjectiveSettings settings;
  if (command.iterations >= 0) settings.max_iterations = command.iterations;
  const auto seeds = seeds_of(command);
  auto found = contours::subjective_surface(image, seeds, edges_of(command, image, comm), settings, comm);
  Mask object = comm.is_root() ? contours::object_of(found, seeds, command.share) : Mask{};
  return {std::move(object), std::move(found.surface), found.steady ? "steady" : "out of iterations", found.iterations};
}

Outcome run_snake(const ContoursCommand& command, const Volume<float>& image) {
  const auto self = parallel::self();
  const auto h = parallel::gather(
      contours::edge_function(parallel::scatter(image, self), edges_of(command, image, self), self), self);
  const auto seeds = seeds_of(command);
  if (seeds.size() != 1) throw UserError("a snake starts around one seed", "contours --seed", "give one");
  const Vec3 index = index_from_lps(image.grid, seeds.front());
  contours::SnakeSettings settings;
  settings.tension_mm = command.tension_mm;
  settings.rigidity_mm3 = command.rigidity_mm3;
  if (command.attraction_mm >= 0) settings.attraction_mm = command.attraction_mm;
  settings.balloon = command.balloon;
  if (command.iterations >= 0) settings.max_iterations = command.iterations;
  const contours::Point2 center{index.x * image.grid.spacing_mm.x, index.y * image.grid.spacing_mm.y};
  const auto found = contours::evolve_snake(contours::circle(center, command.radius_mm, 64), h, settings);
  return {contours::inside_of(found.curve, image.grid), {}, contours::name_of(found.end), found.iterations};
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

CtVolume scaled(const Volume<float>& image, double factor) {
  CtVolume result(image.grid);
  std::ranges::transform(image.voxels, result.voxels.begin(), [&](float v) {
    return static_cast<std::int16_t>(std::lround(std::clamp(factor * static_cast<double>(v), -1000.0, 3000.0)));
  });
  return result;
}

void write_png(const fs::path& file, const CtVolume& ground, const Mask& inside, validation::GreyWindow window) {
  validation::SliceOptions options;
  options.window = window;
  options.width_px = 400;
  options.legend = false;
  const auto png = validation::slice_picture(&ground, &inside, validation::SlicePlane::axial, 0, options);
  write_text(file, std::string(png.begin(), png.end()));
}

/// One picture per method over the broken circle, and φ of the subjective surface.
int broken_circle(const ContoursCommand& command) {
  if (command.folder.empty()) throw UserError("no folder for the pictures", "contours broken-circle", "give --output");
  const fs::path folder = command.folder;
  fs::create_directories(folder);
  contours::BrokenCircle circle;
  circle.noise = command.noise;
  const CtVolume image = scaled(contours::draw(circle), 1);
  Json table = Json::array();
  for (const auto& closing : contours::close_broken_circle(circle)) {
    write_png(folder / (closing.method + ".png"), image, closing.inside, {127, 255});
    if (!closing.surface.voxels.empty()) {
      const float top = *std::ranges::max_element(closing.surface.voxels);
      write_png(folder / (closing.method + "_phi.png"), scaled(closing.surface, 1000 / static_cast<double>(top)),
                closing.inside, {500, 1000});
    }
    table.push_back({{"method", closing.method},
                     {"closed", closing.closed},
                     {"end", closing.end},
                     {"inward_mm", std::round(100 * closing.inward_mm) / 100},
                     {"outward_mm", std::round(100 * closing.outward_mm) / 100},
                     {"iterations", closing.iterations},
                     {"why", closing.why}});
  }
  write_text(folder / "broken_circle.json", table.dump(1) + "\n");
  if (command.json) {
    fmt::print("{}\n", table.dump(1));
    return 0;
  }
  fmt::print("closed  inward outward mm  method                  end and reason\n");
  for (const auto& row : table)
    fmt::print("{:<7} {:>6.2f} {:>7.2f}     {:<23} {} after {} steps: {}\n", row["closed"].get<bool>() ? "yes" : "no",
               row["inward_mm"].get<double>(), row["outward_mm"].get<double>(), row["method"].get<std::string>(),
               row["end"].get<std::string>(), row["iterations"].get<int>(), row["why"].get<std::string>());
  fmt::print("pictures in {}\n", folder.string());
  return 0;
}

void check_command(const ContoursCommand& command) {
  if (std::ranges::find(methods, command.method) == methods.end())
    throw UserError("unknown method \"" + command.method + "\"", "contours",
                    "did you mean \"" + nearest_name(command.method, methods) +
                        "\"? Known: " + fmt::format("{}", fmt::join(methods, ", ")));
  if (command.method != "broken-circle" && (command.input.empty() || command.output.empty()))
    throw UserError("an image to read and a mask to write are needed", "contours " + command.method,
                    "heartgen contours " + command.method + " in.nii.gz inside.nii.gz --seed x,y,z");
  if (!(command.share > 0 && command.share < 1))
    throw UserError(fmt::format("a share of {:g}", command.share), "contours --share", "give one between 0 and 1");
  constexpr double most_balloon = 1000;  // times the speed by curvature of a radius of a millimetre
  if (!(std::abs(command.balloon) <= most_balloon))
    throw UserError(fmt::format("a speed of {:g}", command.balloon), "contours --balloon",
                    fmt::format("give one between -{0:g} and {0:g}", most_balloon));
}

}  // namespace

int contours_command(const ContoursCommand& command, const parallel::Comm& comm) {
  check_command(command);
  if (command.method == "broken-circle") return parallel::run_on_root(comm, [&] { return broken_circle(command); });
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

}  // namespace heart::app
