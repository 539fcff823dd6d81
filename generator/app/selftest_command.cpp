// SPDX-License-Identifier: GPL-3.0-or-later
// `heartgen selftest`: a small built-in case, and whether this machine computes it to the expected bits.
#include <fmt/format.h>
#include <stdlib.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <heartgen/phantom.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <vector>

#include "exporters/bundle.hpp"
#include "exporters/files.hpp"
#include "generator/app/commands.hpp"
#include "generator/pipeline/pipeline.hpp"
#include "model/error.hpp"
#include "model/recipe.hpp"
#include "model/text.hpp"
#include "model/unfinished.hpp"

namespace heartgen::app {
namespace {

namespace fs = std::filesystem;
using exporters::ManifestFile;
using Hashes = std::map<std::string, std::string>;  // of each path

constexpr int differs = 3;

// "content_id ID", then "path SHA-256" of every file, as `heartgen selftest --list` prints them.
constexpr const char* expected_list =
#include "selftest_expected.inc"
    ;

constexpr const char* coarse_settings = R"(
[mesh]
heart_edge_mm = 7
wall_layers = 1
blood_edge_mm = 10
torso_edge_mm = 40
trachea_edge_mm = 7
carotid_edge_mm = 4

[fibers]
grid_mm = 4
depth_grid_mm = 2.5
demons_iterations = [4, 2, 1]
)";

/// A new folder of this user's own, empty, and gone with this object.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string path = (fs::temp_directory_path() / "heartgen-selftest-XXXXXX").string();
    if (mkdtemp(path.data()) == nullptr)
      throw UserError("no folder can be made there", fs::temp_directory_path().string(),
                      "set TMPDIR to a folder that you may write to");
    path_ = path;
    note_unfinished(path_);  // a signal takes it away, too
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
    forget_unfinished(path_);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// In the order in which a build computes them: what differs first is nearest to the cause.
constexpr std::array computed_in_order{"images/", "meshes/", "surfaces/", "curves/", "validation/", ""};

Hashes listed(const std::string& text) {
  Hashes hashes;
  std::istringstream lines(text);
  for (std::string path, hash; lines >> path >> hash;) hashes[path] = hash;
  return hashes;
}

std::string list_of(const exporters::Manifest& manifest) {
  std::string text = "content_id " + manifest.content_id + "\n";
  for (const auto& file : manifest.files) text += file.path + " " + file.sha256 + "\n";
  return text;
}

/// Paths that differ or that only one list has, first computed first.
std::vector<std::string> differences(const Hashes& computed, const Hashes& expected) {
  std::vector<std::string> paths;
  for (const char* folder : computed_in_order)
    for (const Hashes* one : {&computed, &expected})
      for (const auto& [path, hash] : *one) {
        const Hashes& other = one == &computed ? expected : computed;
        const auto found = other.find(path);
        const bool differ = found == other.end() || found->second != hash;
        if (differ && path != "content_id" && path.rfind(folder, 0) == 0 && std::ranges::count(paths, path) == 0)
          paths.push_back(path);
      }
  return paths;
}

exporters::Manifest build_small_case(const fs::path& folder, const parallel::Comm& comm) {
  parallel::run_on_root(comm, [&] {
    phantom::PhantomSettings settings;
    settings.size = {64, 64, 48};
    settings.spacing_mm = {5.4, 5.4, 6.3};
    write_phantom(folder, settings);
    const fs::path recipe = folder / "recipe.toml";
    write_text(recipe, exporters::read_text(recipe) + coarse_settings);
  });
  pipeline::BuildOptions options;
  options.output = folder / "bundle";
  options.progress = false;
  pipeline::build(read_recipe((folder / "recipe.toml").string()), options, comm);
  return comm.is_root() ? exporters::read_manifest(options.output) : exporters::Manifest{};
}

int tell(const exporters::Manifest& manifest, const SelftestCommand& command) {
  const std::string list = list_of(manifest);
  if (command.list) return fmt::print("{}", list), 0;
  const Hashes expected = listed(expected_list);
  const auto paths = differences(listed(list), expected);
  const std::string id = expected.at("content_id");
  const bool same = manifest.content_id == id;
  if (command.json) {
    fmt::print("{}\n",
               nlohmann::ordered_json{
                   {"content_id", manifest.content_id}, {"expected", id}, {"same", same}, {"different", paths}}
                   .dump(1));
    return same ? 0 : differs;
  }
  fmt::print("content id  {}\nexpected    {}\n", manifest.content_id, id);
  if (same) return fmt::print("The same: this machine computes the built-in case to the expected bits.\n"), 0;
  fmt::print("{} of {} files differ; the first that is computed: {}\n", paths.size(), manifest.files.size(),
             paths.empty() ? "manifest.json" : paths.front());
  fmt::print("docs/reproducibility.md says what is promised, and what to look at.\n");
  return differs;
}

}  // namespace

int selftest_command(const SelftestCommand& command, const parallel::Comm& comm) {
  std::optional<ScratchFolder> scratch;
  std::string folder = parallel::run_on_root(comm, [&] { return scratch.emplace().path().string(); });
  parallel::broadcast(comm, folder);
  const auto manifest = build_small_case(folder, comm);
  return comm.is_root() ? tell(manifest, command) : 0;
}

}  // namespace heartgen::app
