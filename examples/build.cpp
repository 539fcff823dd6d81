// SPDX-License-Identifier: GPL-3.0-or-later
// A whole build: build FOLDER writes a phantom into FOLDER.phantom and a bundle of it into FOLDER.
#include <heartgen/build.hpp>
#include <heartgen/phantom.hpp>

#include "images.hpp"

int main(int argc, char** argv) {
  using namespace heartgen;
  const parallel::Environment environment(&argc, &argv);
  const auto comm = parallel::world();
  const std::string folder = argc > 1 ? argv[1] : "bundle", data = folder + ".phantom";
  PhantomSettings phantom;
  phantom.size = {64, 64, 48};
  phantom.spacing_mm = {5.4, 5.4, 6.3};
  parallel::run_on_root(comm, [&] { write_phantom(data, phantom); });
  auto recipe = read_recipe(data + "/recipe.toml");
  recipe.mesh.meshes = {"myocardium"};
  recipe.mesh.heart_edge_mm = 6;
  recipe.fibers.grid_mm = 4;
  recipe.fibers.depth_grid_mm = 2.5;
  recipe.fibers.demons_iterations = {4, 2, 1};
  BuildOptions options;
  options.output = folder;
  options.replace = true;
  options.progress = false;
  options.on_stage = [](const StageEvent& stage) {
    if (stage.has_ended) std::printf("%3.0f %%  %s\n", 100 * stage.share, stage.name.c_str());
  };
  const auto result = build(recipe, options, comm);
  if (comm.is_root())
    std::printf("%s: content id %s, %zu rows in its certificate\n", folder.c_str(), result.content_id.c_str(),
                result.certificate.rows.size());
  return comm.is_root() && result.certificate.rows.empty() ? 1 : 0;
}
