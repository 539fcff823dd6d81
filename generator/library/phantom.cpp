// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cstdlib>
#include <heartgen/phantom.hpp>

#include "exporters/files.hpp"
#include "generator/adapters/itk_io.hpp"
#include "generator/adapters/vtk_io.hpp"
#include "model/error.hpp"
#include "model/recipe.hpp"
#include "model/text.hpp"

namespace heartgen {
namespace {

namespace fs = std::filesystem;

adapters::UnstructuredData atlas_file(const TetMesh& atlas) {
  adapters::UnstructuredData data;
  data.points = atlas.nodes_mm;
  data.tets = atlas.cells;
  data.point_vectors["fibers"] = atlas.node_fibers.fiber;
  return data;
}

void write_truth(const fs::path& folder, const phantom::Phantom& phantom) {
  fs::create_directories(folder);
  adapters::write_volume((folder / "labels.nii.gz").string(), phantom.labels);
  adapters::write_volume((folder / "fiber_x.nrrd").string(), phantom.fibers.x);
  adapters::write_volume((folder / "fiber_y.nrrd").string(), phantom.fibers.y);
  adapters::write_volume((folder / "fiber_z.nrrd").string(), phantom.fibers.z);
}

/// The other patient's torso and the carotid: images, truth and landmarks of their own.
void write_companions(const fs::path& folder, const phantom::Phantom& phantom) {
  adapters::write_volume((folder / "torso_mr.nii.gz").string(), phantom.torso_mr);
  adapters::write_volume((folder / "truth" / "torso_mr_labels.nii.gz").string(), phantom.torso_mr_labels);
  write_text(folder / "torso_mr_landmarks.json", write_landmarks(phantom.torso_mr_landmarks));
  adapters::write_volume((folder / "carotid.nii.gz").string(), phantom.carotid);
  adapters::write_volume((folder / "truth" / "carotid_labels.nii.gz").string(), phantom.carotid_labels);
}

/// Seeds inside the CT's field of view, and the carotid's, which belongs to the angiogram.
Landmarks visible_landmarks(const phantom::Phantom& phantom) {
  Landmarks landmarks = phantom.landmarks;
  std::erase_if(landmarks.seeds_mm, [&](const auto& seed) { return !contains_point(phantom.ct.grid, seed.second); });
  landmarks.seeds_mm["carotid"] = phantom.carotid_seed_mm;
  return landmarks;
}

std::string recipe_text(int variant) {
  return fmt::format(
      "# Builds the phantom in this folder: heartgen build recipe.toml --output bundle\n"
      "name = \"phantom-{}\"\n"
      "version = \"1.0.0\"\n"
      "author = \"the heartgen developers\"\n"
      "synthetic_image = true\n\n"
      "[input]\n"
      "ct = \"ct.nii.gz\"\n"
      "atlas = \"atlas.vtk\"\n"
      "carotid = \"carotid.nii.gz\"\n"
      "landmarks = \"landmarks.json\"\n",
      variant);
}

/// Only what this command has written is written over: its recipe tells.
void require_own(const fs::path& folder) {
  const auto refuse = [](const fs::path& file) {
    throw UserError("exists, and is not as this command writes it", file.string(),
                    "name another folder, or move it away");
  };
  const fs::path recipe = folder / "recipe.toml";
  if (!fs::exists(recipe)) {
    for (const char* name : {"ct.nii.gz", "atlas.vtk", "landmarks.json", "carotid.nii.gz", "torso_mr.nii.gz",
                             "torso_mr_landmarks.json", "truth"})
      if (fs::exists(folder / name)) refuse(folder / name);
    return;
  }
  const auto text = exporters::read_text(recipe);
  const auto name = text.find("phantom-");
  const int variant = name == std::string::npos ? 0 : std::atoi(text.c_str() + name + std::string("phantom-").size());
  if (text != recipe_text(variant)) refuse(recipe);
}

}  // namespace

void write_phantom(const fs::path& folder, const phantom::PhantomSettings& settings) {
  check_output(folder / "recipe.toml");
  require_own(folder);
  const phantom::Phantom phantom = phantom::make_phantom(settings);
  write_truth(folder / "truth", phantom);
  write_companions(folder, phantom);
  write_text(folder / "landmarks.json", write_landmarks(visible_landmarks(phantom)));
  adapters::write_unstructured(folder / "atlas.vtk", atlas_file(phantom::make_standin_atlas()));
  write_text(folder / "recipe.toml", recipe_text(settings.variant));
  adapters::write_volume((folder / "ct.nii.gz").string(), phantom.ct);
}

}  // namespace heartgen
