// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/lab/broken_circle_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "benchmarks/lab/broken_circle.hpp"
#include "model/error.hpp"
#include "model/text.hpp"
#include "validation/report/pictures.hpp"

namespace heartgen::lab {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

CtVolume scaled(const Volume<float>& image, double factor) {
  CtVolume result(image.grid);
  std::ranges::transform(image.voxels, result.voxels.begin(), [&](float v) {
    return static_cast<std::int16_t>(std::lround(std::clamp(factor * static_cast<double>(v), -1000.0, 3000.0)));
  });
  return result;
}

void write_png(const fs::path& file, const CtVolume& ground, const Mask& inside, report::GreyWindow window) {
  report::SliceOptions options;
  options.window = window;
  options.width_px = 400;
  options.legend = false;
  const auto png = report::slice_picture(&ground, &inside, report::SlicePlane::axial, 0, options);
  write_text(file, std::string(png.begin(), png.end()));
}

}  // namespace

int broken_circle_command(const BrokenCircleCommand& command) {
  if (command.folder.empty()) throw UserError("no folder for the pictures", "broken-circle", "give --output");
  const fs::path folder = command.folder;
  fs::create_directories(folder);
  BrokenCircle circle;
  circle.noise = command.noise;
  const CtVolume image = scaled(draw(circle), 1);
  Json table = Json::array();
  for (const auto& closing : close_broken_circle(circle)) {
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

}  // namespace heartgen::lab
