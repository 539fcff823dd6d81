// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/functional.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <heartgen/build.hpp>
#include <heartgen/bundle.hpp>
#include <heartgen/checks.hpp>
#include <heartgen/phantom.hpp>
#include <set>

#include "arrays.hpp"
#include "module.hpp"

namespace heartgen::python {
namespace {

namespace fs = std::filesystem;
using Unlocked = py::call_guard<py::gil_scoped_release>;

/// Settings by section, as in a recipe; name, version, license, author and date_published stand outside of sections.
void change_recipe(Recipe& recipe, const py::dict& given) {
  const std::pair<const char*, std::string*> texts[]{{"name", &recipe.name},
                                                     {"version", &recipe.version},
                                                     {"license", &recipe.license},
                                                     {"author", &recipe.author},
                                                     {"date_published", &recipe.date_published}};
  for (const auto& [name, text] : texts)
    if (given.contains(name)) *text = py::cast<std::string>(given[name]);
  std::set<std::string> known{"name", "version", "license", "author", "date_published"};
  const auto section = [&](const char* name, auto& settings) {
    known.insert(name);
    if (given.contains(name)) set_members(settings, py::cast<py::dict>(given[name]), std::string("recipe, ") + name);
  };
  section("input", recipe.input);
  section("labels", recipe.labels);
  section("denoise", recipe.denoise);
  section("chambers", recipe.chambers);
  section("epicardium", recipe.epicardium);
  section("torso", recipe.torso);
  section("mesh", recipe.mesh);
  section("fibers", recipe.fibers);
  section("validation", recipe.validation);
  for (const auto& [key, value] : given)
    if (const auto name = py::cast<std::string>(key); !known.contains(name))
      throw UserError("has no section \"" + name + "\"", "settings",
                      "give name, version, license, author, date_published or a section of a recipe");
}

py::tuple build_bundle(const std::string& recipe_file, const py::dict& settings, const fs::path& output,
                       const fs::path& cache, bool replace, bool accept_doubtful, const py::object& progress) {
  Recipe recipe = recipe_file.empty() ? default_recipe() : read_recipe(recipe_file);
  change_recipe(recipe, settings);
  BuildOptions options;
  options.output = output;
  options.cache_folder = cache;
  options.replace = replace;
  options.progress = false;
  options.tells_warnings = false;
  options.accept_doubtful = accept_doubtful;
  options.on_stage = [&](const StageEvent& stage) {
    const py::gil_scoped_acquire acquire;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();  // Ctrl-C ends a build at its next stage
    if (!progress.is_none()) progress(stage.name, stage.share, stage.has_ended);
  };
  const auto result = unlocked([&] { return build(recipe, options, parallel::self()); });
  return py::make_tuple(result.content_id, bundle::certificate_json(result.certificate));
}

py::list problems_of(const fs::path& folder) {
  py::list problems;
  for (const auto& problem : unlocked([&] { return bundle::verify_bundle(folder); }))
    problems.append(py::make_tuple(problem.file, problem.what));
  return problems;
}

void write_phantom_files(const fs::path& folder, const Index3& size, const std::array<double, 3>& spacing, int variant,
                         double noise_hu) {
  PhantomSettings settings;
  settings.size = size;
  settings.spacing_mm = {spacing[0], spacing[1], spacing[2]};
  settings.variant = variant;
  settings.noise_hu = noise_hu;
  write_phantom(folder, settings);
}

}  // namespace

void add_bundles(py::module_& m) {
  m.def("build", &build_bundle);
  m.def("verify", &problems_of);
  m.def("require_bundle", [](const fs::path& folder) { bundle::read_manifest(folder); });
  m.def(
      "bundle_mesh",
      [](const fs::path& folder, const std::string& name) {
        return std::make_shared<TetMesh>(bundle::read_mesh(folder, name));
      },
      Unlocked());
  m.def("bundle_labels",
        [](const fs::path& folder) { return image_of(unlocked([&] { return bundle::read_labels(folder); })); });
  m.def("certificate",
        [](const fs::path& folder) { return bundle::certificate_json(bundle::read_certificate(folder)); });
  m.def(
      "validate", [](const fs::path& folder) { return bundle::certificate_json(validate_bundle(folder)); }, Unlocked());
  m.def(
      "pack", [](const fs::path& folder, const fs::path& archive) { bundle::pack_bundle(folder, archive); },
      Unlocked());
  m.def(
      "unpack", [](const fs::path& archive, const fs::path& folder) { bundle::unpack_bundle(archive, folder); },
      Unlocked());
  m.def("write_phantom", &write_phantom_files, Unlocked());
}

}  // namespace heartgen::python
