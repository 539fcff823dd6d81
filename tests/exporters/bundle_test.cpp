// SPDX-License-Identifier: GPL-3.0-or-later
#include "exporters/bundle.hpp"

#include <archive.h>
#include <archive_entry.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "exporters/certificate_json.hpp"
#include "exporters/cut.hpp"
#include "exporters/files.hpp"
#include "exporters/manifest.hpp"
#include "generator/adapters/vtk_io.hpp"
#include "model/error.hpp"
#include "support/comma_locale.hpp"
#include "support/data.hpp"
#include "support/files.hpp"
#include "support/two_region_mesh.hpp"

namespace heartgen::exporters {
namespace {

namespace fs = std::filesystem;
using testing::bytes_of;
using testing::error_of;
using testing::scratch_folder;
using testing::two_region_mesh;
using testing::write_bytes;

Bundle sample_bundle() {
  Bundle bundle;
  bundle.name = "sample";
  bundle.version = "1.0.0";
  bundle.license = "CC-BY-4.0";
  bundle.author = "Ada Lovelace; \"B: C\"";
  bundle.date_published = "2024-02-29";
  bundle.recipe = "name = \"sample\"\n";
  bundle.atlas = "built-in stand-in atlas";
  Grid grid;
  grid.size = {7, 6, 5};
  grid.spacing_mm = {0.7, 0.7, 1.25};
  grid.origin_mm = {-12.5, 3, 40};
  bundle.labels = LabelVolume(grid);
  for (std::size_t v = 0; v < bundle.labels.voxels.size(); ++v)
    bundle.labels.voxels[v] = static_cast<std::uint8_t>(v % 3);
  bundle.meshes["myocardium"] = two_region_mesh(2);
  bundle.meshes["trachea"] = two_region_mesh(1, Region::trachea);
  bundle.certificate.rows = {{"mesh", "myocardium", "dihedral_min", 31.25, "deg", 5.0, std::nullopt},
                             {"fibers", "myocardium", "jump", 1.0 / 3, "deg", std::nullopt, 0.25}};
  bundle.report_html = "<html></html>";
  bundle.attribution = "Patient 7 of the Example Archive, CC BY 3.0";
  bundle.inputs = {{"ct: patient.nii.gz", std::string(64, 'a'), 1234}};
  bundle.tools = {{"VTK", "9.1.0"}};
  bundle.logs["build.log"] = "took 3 s";
  return bundle;
}

TEST(Bundle, ReadsBackWhatWasWritten) {
  const auto folder = scratch_folder("bundle_read") / "out";
  const Bundle bundle = sample_bundle();
  const std::string id = write_bundle(bundle, folder);
  const Manifest manifest = read_manifest(folder);
  EXPECT_EQ(manifest.content_id, id);
  EXPECT_EQ(manifest.name, "sample");
  EXPECT_EQ(manifest.unit, "mm");
  EXPECT_EQ(manifest.frame, "LPS");
  EXPECT_EQ(manifest.inputs, bundle.inputs);
  EXPECT_EQ(manifest.tools, bundle.tools);
  EXPECT_EQ(manifest.attribution, bundle.attribution);
  for (const char* file : {"LICENSE", "README.md", "ro-crate-metadata.json"})
    EXPECT_NE(bytes_of(folder / file).find(bundle.attribution), std::string::npos) << file;
  EXPECT_EQ(manifest.regions.at("lv_myocardium"), 1);
  EXPECT_EQ(manifest.surfaces.at("lv_endocardium"), *surface_from_name("lv_endocardium"));
  EXPECT_EQ(manifest.rims.at("lv_endocardium_rim"), 1000 + *surface_from_name("lv_endocardium"));
  const auto& entry = manifest.meshes.at("myocardium");
  const auto& mesh = bundle.meshes.at("myocardium");
  EXPECT_EQ(entry.nodes, static_cast<std::int64_t>(mesh.nodes_mm.size()));
  EXPECT_EQ(entry.cells, 96);
  EXPECT_EQ(entry.regions.at("lv_blood"), 48);
  std::int64_t labelled = 0;
  for (const auto& [name, faces] : entry.surfaces) labelled += faces;
  EXPECT_EQ(labelled, static_cast<std::int64_t>(mesh.faces.size()));
  const TetMesh back = read_mesh(folder, "myocardium");
  EXPECT_EQ(back.cells, mesh.cells);
  EXPECT_EQ(back.faces, mesh.faces);
  EXPECT_EQ(back.rims.size(), mesh.rims.size());
  EXPECT_EQ(back.node_fibers.sheet_normal, mesh.node_fibers.sheet_normal);
  EXPECT_EQ(read_labels(folder).voxels, bundle.labels.voxels);
  EXPECT_EQ(read_recipe_text(folder), bundle.recipe);
  EXPECT_TRUE(verify_bundle(folder).empty());
}

/// Surfaces had tags from 1 once, as regions have.
TEST(Bundle, SurfacesOfOlderBundlesGetTheTagsOfToday) {
  const auto folder = scratch_folder("bundle_old_tags") / "out";
  const Bundle bundle = sample_bundle();
  write_bundle(bundle, folder);
  TetMesh old = bundle.meshes.at("myocardium");
  for (auto& tag : old.surface) tag -= 100;
  for (auto& rim : old.rims) rim.tag -= 100;
  Manifest manifest = read_manifest(folder);
  for (auto& [name, tag] : manifest.surfaces) tag -= 100;
  for (auto& [name, tag] : manifest.rims) tag -= 100;
  adapters::write_vtp(folder / manifest.meshes.at("myocardium").surface_file, old);
  write_bytes(folder / "manifest.json", manifest_text(manifest));
  const TetMesh back = read_mesh(folder, "myocardium");
  EXPECT_EQ(back.surface, bundle.meshes.at("myocardium").surface);
  ASSERT_EQ(back.rims.size(), old.rims.size());
  for (std::size_t r = 0; r < back.rims.size(); ++r)
    EXPECT_EQ(back.rims[r].tag, bundle.meshes.at("myocardium").rims[r].tag);
}

TEST(Bundle, TheTorsoOfOlderBundlesGetsTheFibresOfItsWalls) {
  const auto folder = scratch_folder("bundle_old_torso") / "out";
  Bundle bundle = sample_bundle();
  TetMesh torso = two_region_mesh(2, Region::torso);
  bundle.meshes["myocardium"] = only_regions(torso, {tag(Region::lv_myocardium)});
  torso.cell_fibers = torso.node_fibers = {};
  torso.fiber_source.clear();
  bundle.meshes["torso"] = torso;
  write_bundle(bundle, folder);
  const TetMesh walls = read_mesh(folder, "myocardium"), back = read_mesh(folder, "torso");
  ASSERT_EQ(back.cell_fibers.fiber.size(), back.cells.size());
  for (std::size_t c = 0; c < walls.cells.size(); ++c)
    ASSERT_EQ(back.cell_fibers.fiber[static_cast<std::size_t>(walls.parent_cell[c])], walls.cell_fibers.fiber[c]);
  for (std::size_t c = 0; c < back.cells.size(); ++c)
    ASSERT_EQ(back.cell_fibers.fiber[c] != Vec3{}, back.region[c] == tag(Region::lv_myocardium));
}

TEST(Bundle, HasTheLayoutOfTheSpecification) {
  const auto folder = scratch_folder("bundle_layout") / "out";
  write_bundle(sample_bundle(), folder);
  for (const char* path :
       {"README.md", "LICENSE", "CITATION.cff", "manifest.json", "ro-crate-metadata.json", "recipe.toml",
        "images/labels.nii.gz", "meshes/myocardium.vtu", "surfaces/myocardium.vtp", "curves/myocardium.vtp",
        "validation/metrics.json", "validation/report.html", "logs/build.log"})
    EXPECT_TRUE(fs::is_regular_file(folder / path)) << path;
}

TEST(Bundle, MetricsComeBack) {
  const auto folder = scratch_folder("bundle_metrics") / "out";
  Bundle bundle = sample_bundle();
  bundle.certificate.rows.push_back(
      {"fit", "epicardium", "distance", std::numeric_limits<double>::quiet_NaN(), "mm", {}, {}});
  bundle.certificate.rows[0].warn_below = 35;
  bundle.certificate.rows[0].reason = "The mesher promises 30 degrees.";
  write_bundle(bundle, folder);
  const Report report = read_certificate(folder).rows;
  ASSERT_EQ(report.size(), 3U);
  EXPECT_EQ(report[1].value, 1.0 / 3);
  EXPECT_EQ(report[1].at_most, 0.25);
  EXPECT_FALSE(report[1].passed());
  EXPECT_TRUE(report[0].passed());
  EXPECT_TRUE(std::isnan(report[2].value));
  EXPECT_EQ(report[0].verdict(), Verdict::warned);
  EXPECT_EQ(report[0].reason, "The mesher promises 30 degrees.");
  EXPECT_EQ(report[2].verdict(), Verdict::told);
}

TEST(Bundle, WarningsAndUsesTravelInMetricsManifestAndReadme) {
  const auto folder = scratch_folder("bundle_trust") / "out";
  Bundle bundle = sample_bundle();
  bundle.certificate.warnings = {{"landmarks.doubtful", WarningLevel::doubt, "This may be no heart."}};
  bundle.certificate.uses = {
      {"mechanics", Fitness::unfit, true, {"The wall is in two parts."}, "Repair the label map."}};
  write_bundle(bundle, folder);
  const auto metrics = read_certificate(folder);
  const auto manifest = read_manifest(folder);
  EXPECT_EQ(metrics.warnings, bundle.certificate.warnings);
  EXPECT_EQ(metrics.uses, bundle.certificate.uses);
  EXPECT_EQ(manifest.warnings, bundle.certificate.warnings);
  EXPECT_EQ(manifest.uses, bundle.certificate.uses);
  const std::string readme = read_text(folder / "README.md");
  for (const char* words : {"This may be no heart.", "The wall is in two parts.", "Repair the label map."})
    EXPECT_NE(readme.find(words), std::string::npos) << words;
}

TEST(Bundle, SameContentWhateverFolderLocaleLogsAndTools) {
  const auto folder = scratch_folder("bundle_same");
  Bundle bundle = sample_bundle();
  const auto first = write_bundle(bundle, folder / "a");
  bundle.logs["build.log"] = "took 99 s";
  bundle.tools["VTK"] = "another";
  {
    const testing::CommaLocale comma;
    EXPECT_EQ(first, write_bundle(bundle, folder / "deeper" / "b"));
    EXPECT_TRUE(verify_bundle(folder / "deeper" / "b").empty());
  }
  for (const auto& file : read_manifest(folder / "a").files)
    EXPECT_EQ(bytes_of(folder / "a" / file.path), bytes_of(folder / "deeper" / "b" / file.path)) << file.path;
  bundle.meshes["myocardium"].nodes_mm[0].x += 1e-13;
  EXPECT_NE(first, write_bundle(bundle, folder / "c"));
}

TEST(Bundle, NothingCoveredNamesTheMachine) {
  const auto folder = scratch_folder("bundle_machine") / "out";
  write_bundle(sample_bundle(), folder);
  for (const auto& file : read_manifest(folder).files)
    EXPECT_EQ(bytes_of(folder / file.path).find(folder.string()), std::string::npos) << file.path;
  const std::string labels = bytes_of(folder / "images" / "labels.nii.gz");
  EXPECT_EQ(labels.substr(3, 5), std::string(5, '\0')) << "gzip flags and time stamp";
}

TEST(Bundle, ReplacesOnlyBundlesAndOnlyWhenAllowed) {
  const auto folder = scratch_folder("bundle_replace");
  Bundle bundle = sample_bundle();
  write_bundle(bundle, folder / "out");
  EXPECT_NE(error_of([&] { write_bundle(bundle, folder / "out"); }), "");
  bundle.version = "2.0.0";
  write_bundle(bundle, folder / "out", Existing::replace);
  EXPECT_EQ(read_manifest(folder / "out").version, "2.0.0");
  fs::create_directory(folder / "photos");
  write_bytes(folder / "photos" / "cat.jpg", "meow");
  EXPECT_NE(error_of([&] { write_bundle(bundle, folder / "photos", Existing::replace); }), "");
  EXPECT_EQ(bytes_of(folder / "photos" / "cat.jpg"), "meow");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 2) << "no partial or old folder is left";
}

TEST(Bundle, AFailedWriteLeavesTheOldBundle) {
  const auto folder = scratch_folder("bundle_failed");
  Bundle bundle = sample_bundle();
  write_bundle(bundle, folder / "out");
  bundle.meshes["../escape"] = two_region_mesh(1);
  EXPECT_NE(error_of([&] { write_bundle(bundle, folder / "out", Existing::replace); }), "");
  EXPECT_TRUE(verify_bundle(folder / "out").empty());
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1);
}

TEST(Bundle, WhatAKilledRunLeftIsCleared) {
  const auto folder = scratch_folder("bundle_killed");
  fs::create_directories(folder / ".out.partial" / "meshes");
  write_bytes(folder / ".out.partial" / "meshes" / "half.vtu", "<VTKFile");
  write_bundle(sample_bundle(), folder / "out");
  EXPECT_TRUE(verify_bundle(folder / "out").empty());
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1);
}

/// Every {"@id": ...} that stands for another entity.
void collect_references(const nlohmann::json& json, std::set<std::string>& ids) {
  if (json.is_object() && json.size() == 1 && json.contains("@id")) ids.insert(json.at("@id").get<std::string>());
  if (json.is_structured())
    for (const auto& child : json) collect_references(child, ids);
}

TEST(Bundle, RoCrateIsClosedAndListsTheFiles) {
  const auto folder = scratch_folder("bundle_crate") / "out";
  write_bundle(sample_bundle(), folder);
  const auto crate = nlohmann::json::parse(bytes_of(folder / "ro-crate-metadata.json"));
  EXPECT_EQ(crate.at("@context"), "https://w3id.org/ro/crate/1.1/context");
  std::set<std::string> defined, referenced;
  std::map<std::string, nlohmann::json> entities;
  for (const auto& entity : crate.at("@graph")) {
    EXPECT_TRUE(entity.contains("@type"));
    EXPECT_TRUE(defined.insert(entity.at("@id")).second) << entity.at("@id");
    entities[entity.at("@id")] = entity;
    collect_references(entity, referenced);
  }
  for (const auto& id : referenced)
    EXPECT_TRUE(defined.count(id) || id == "https://w3id.org/ro/crate/1.1") << id << " is not in the graph";
  const auto& root = entities.at("./");
  for (const char* key : {"name", "description", "license", "hasPart"}) EXPECT_TRUE(root.contains(key)) << key;
  EXPECT_EQ(root.at("datePublished"), "2024-02-29");
  EXPECT_EQ(entities.at("ro-crate-metadata.json").at("about").at("@id"), "./");
  for (const auto& file : read_manifest(folder).files) EXPECT_TRUE(defined.count(file.path)) << file.path;
}

TEST(Bundle, WithoutADateNoneIsInvented) {
  const auto folder = scratch_folder("bundle_undated") / "out";
  Bundle bundle = sample_bundle();
  bundle.date_published.clear();
  write_bundle(bundle, folder);
  EXPECT_EQ(bytes_of(folder / "ro-crate-metadata.json").find("datePublished"), std::string::npos);
  EXPECT_EQ(bytes_of(folder / "CITATION.cff").find("date-released"), std::string::npos);
}

TEST(Bundle, CitationHasWhatTheFormatAsks) {
  const auto folder = scratch_folder("bundle_citation") / "out";
  write_bundle(sample_bundle(), folder);
  const std::string text = bytes_of(folder / "CITATION.cff");
  for (const char* line : {"cff-version: 1.2.0\n", "message: ", "title: \"sample\"\n", "  - name: \"Ada Lovelace\"\n",
                           "  - name: \"\\\"B: C\\\"\"\n", "license: CC-BY-4.0\n", "date-released: 2024-02-29\n"})
    EXPECT_NE(text.find(line), std::string::npos) << line;
}

TEST(Bundle, UnknownMeshNamesTheKnownOnes) {
  const auto folder = scratch_folder("bundle_unknown") / "out";
  write_bundle(sample_bundle(), folder);
  EXPECT_NE(error_of([&] { read_mesh(folder, "atria"); }).find("myocardium, trachea"), std::string::npos);
  EXPECT_NE(error_of([&] { read_manifest(folder / "meshes"); }).find("manifest.json"), std::string::npos);
}

// --------------------------------------------------------------------------------------------------- verify

/// Damages a fresh bundle and returns verify's lines "file: what".
std::string problems_after(const std::string& name, const std::function<void(const fs::path&)>& damage) {
  const auto folder = scratch_folder("verify_" + name) / "out";
  write_bundle(sample_bundle(), folder);
  damage(folder);
  std::string text;
  for (const auto& problem : verify_bundle(folder)) text += problem.file + ": " + problem.what + "\n";
  return text;
}

/// Rewrites a value of the manifest and seals it again, as an attacker would.
void reseal(const fs::path& folder, const std::function<void(nlohmann::json&)>& change) {
  auto json = nlohmann::json::parse(bytes_of(folder / "manifest.json"));
  change(json);
  json.erase("manifest_sha256");
  json["manifest_sha256"] = sha256_of_text(json.dump(2));
  write_bytes(folder / "manifest.json", json.dump(2) + "\n");
}

TEST(Verify, EveryFlippedFileIsNamed) {
  const auto pristine = scratch_folder("verify_flip") / "out";
  write_bundle(sample_bundle(), pristine);
  for (const auto& file : read_manifest(pristine).files) {
    const std::string whole = bytes_of(pristine / file.path);
    std::string broken = whole;
    broken[broken.size() / 2] = static_cast<char>(broken[broken.size() / 2] ^ 1);
    write_bytes(pristine / file.path, broken);
    const auto problems = verify_bundle(pristine);
    ASSERT_EQ(problems.size(), 1U) << file.path;
    EXPECT_EQ(problems[0].file, file.path);
    write_bytes(pristine / file.path, whole);
  }
  EXPECT_TRUE(verify_bundle(pristine).empty());
}

TEST(Verify, AnyFlippedByteOfTheManifest) {
  const auto folder = scratch_folder("verify_manifest") / "out";
  write_bundle(sample_bundle(), folder);
  const std::string whole = bytes_of(folder / "manifest.json");
  for (std::size_t at = 0; at < whole.size(); at += 41) {
    std::string broken = whole;
    broken[at] = static_cast<char>(broken[at] ^ 1);
    write_bytes(folder / "manifest.json", broken);
    const auto problems = verify_bundle(folder);
    ASSERT_FALSE(problems.empty()) << at;
    EXPECT_EQ(problems[0].file, "manifest.json");
  }
  write_bytes(folder / "manifest.json", "{}");
  EXPECT_EQ(verify_bundle(folder).at(0).file, "manifest.json");
  fs::remove(folder / "manifest.json");
  EXPECT_EQ(verify_bundle(folder).at(0).file, "manifest.json");
}

TEST(Verify, MissingExtraAndGrownFiles) {
  EXPECT_EQ(problems_after("missing", [](const fs::path& f) { fs::remove(f / "meshes/trachea.vtu"); }),
            "meshes/trachea.vtu: missing\n");
  EXPECT_EQ(problems_after("extra", [](const fs::path& f) { write_bytes(f / "meshes/x.vtu", "x"); }),
            "meshes/x.vtu: is not in the manifest\n");
  EXPECT_EQ(
      problems_after("grown", [](const fs::path& f) { write_bytes(f / "LICENSE", bytes_of(f / "LICENSE") + " "); }),
      "LICENSE: size differs\n");
  EXPECT_EQ(problems_after("logs", [](const fs::path& f) { write_bytes(f / "logs/more.log", "x"); }), "");
  EXPECT_EQ(problems_after("no_log", [](const fs::path& f) { write_bytes(f / "logs/mesh.vtu", "x"); }),
            "logs/mesh.vtu: is not in the manifest\n");
  EXPECT_EQ(problems_after("in_log",
                           [](const fs::path& f) {
                             write_bytes(f / "logs/more.log",
                                         "\x7f"
                                         "ELF");
                           }),
            "logs/more.log: is no log: it holds more than plain text\n");
}

TEST(Verify, LinksAreRefused) {
  EXPECT_EQ(problems_after("link",
                           [](const fs::path& f) {
                             fs::rename(f / "LICENSE", f.parent_path() / "LICENSE");
                             fs::create_symlink("../LICENSE", f / "LICENSE");
                           }),
            "LICENSE: is a link\n");
  EXPECT_NE(problems_after("link_folder",
                           [](const fs::path& f) {
                             fs::rename(f / "meshes", f.parent_path() / "meshes");
                             fs::create_directory_symlink("../meshes", f / "meshes");
                           })
                .find("meshes/myocardium.vtu: is a link"),
            std::string::npos);
  EXPECT_EQ(problems_after("link_extra", [](const fs::path& f) { fs::create_symlink("/etc", f / "etc"); }),
            "etc: is a link\n");
}

TEST(Verify, PathsThatLeaveTheFolder) {
  for (const char* path : {"../secret", "/etc/passwd", "meshes/../../x", "meshes\\x", ""}) {
    const auto text = problems_after(
        "leave", [&](const fs::path& f) { reseal(f, [&](nlohmann::json& json) { json["files"][0]["path"] = path; }); });
    EXPECT_NE(text.find(std::string(path) + ": the path leaves the bundle"), std::string::npos) << text;
  }
}

// What a resealed manifest says of the model is part of the id: unit, frame, tags, names, counts, which file is which.
TEST(Verify, ContentIdCoversTheModel) {
  const std::vector<std::function<void(nlohmann::json&)>> changes{
      [](auto& json) { json["unit"] = "m"; },
      [](auto& json) { json["frame"] = "RAS"; },
      [](auto& json) { json["name"] = "other"; },
      [](auto& json) { json["regions"]["lv_myocardium"] = 2; },
      [](auto& json) { json["surfaces"].begin().value() = 199; },
      [](auto& json) { json["rims"]["new_rim"] = 200; },
      [](auto& json) { json["meshes"]["trachea"]["cells"] = 1; },
      [](auto& json) { json["meshes"]["trachea"]["file"] = "meshes/myocardium.vtu"; },
      [](auto& json) { json["files"][0]["sha256"] = std::string(64, '0'); },
  };
  for (std::size_t i = 0; i < changes.size(); ++i)
    EXPECT_NE(problems_after("model", [&](const fs::path& f) { reseal(f, changes[i]); })
                  .find("content_id is not that of the model"),
              std::string::npos)
        << i;
  for (const char* key : {"inputs", "tools"})  // where it came from is not the model
    EXPECT_EQ(problems_after("origin", [&](const fs::path& f) { reseal(f, [&](auto& json) { json[key].clear(); }); }),
              "");
}

TEST(Verify, BundlesOfTheFirstSchemaKeepTheirId) {
  const auto folder = scratch_folder("verify_first") / "out";
  write_bundle(sample_bundle(), folder);
  Manifest manifest = read_manifest(folder);
  manifest.schema = first_bundle_schema;
  manifest.content_id = content_id(manifest);
  const auto id = manifest.content_id;
  write_bytes(folder / "manifest.json", manifest_text(manifest));
  EXPECT_TRUE(verify_bundle(folder).empty());
  manifest.unit = "m";  // the files alone were covered: what else it says is known
  EXPECT_EQ(content_id(manifest), id);
  std::swap(manifest.regions.at("lv_myocardium"), manifest.regions.at("trachea"));
  write_bytes(folder / "manifest.json", manifest_text(manifest));
  std::string text;
  for (const auto& problem : verify_bundle(folder)) text += problem.what + "\n";
  EXPECT_EQ(text.find("its unit is not mm\nregion 'lv_myocardium' has tag "), 0U) << text;
}

TEST(Verify, ResealedManifestStillNeedsTheContentId) {
  const auto text = problems_after("id", [](const fs::path& f) {
    reseal(f, [](nlohmann::json& json) { json["content_id"] = std::string(64, '0'); });
  });
  EXPECT_EQ(text, "manifest.json: content_id is not that of the model and its files\n");
  EXPECT_NE(problems_after("unlisted",
                           [](const fs::path& f) {
                             reseal(f, [](nlohmann::json& json) { json["meshes"]["trachea"]["file"] = "x.vtu"; });
                           }),
            "");
  EXPECT_NE(problems_after("twice",
                           [](const fs::path& f) {
                             reseal(f, [](nlohmann::json& json) { json["files"].push_back(json["files"][0]); });
                           })
                .find("is listed twice"),
            std::string::npos);
}

// ---------------------------------------------------------------------------------------------- pack, unpack

TEST(Pack, SameBytesAndRoundTrip) {
  const auto folder = scratch_folder("pack");
  const auto id = write_bundle(sample_bundle(), folder / "a");
  write_bundle(sample_bundle(), folder / "b");
  pack_bundle(folder / "a", folder / "a.tar.zst");
  pack_bundle(folder / "b", folder / "b.tar.zst");
  EXPECT_EQ(bytes_of(folder / "a.tar.zst"), bytes_of(folder / "b.tar.zst"));
  unpack_bundle(folder / "a.tar.zst", folder / "c");
  EXPECT_TRUE(verify_bundle(folder / "c").empty());
  EXPECT_EQ(read_manifest(folder / "c").content_id, id);
  EXPECT_NE(error_of([&] { unpack_bundle(folder / "a.tar.zst", folder / "c"); }).find("exists"), std::string::npos);
}

TEST(Pack, RefusesADamagedBundle) {
  const auto folder = scratch_folder("pack_damaged");
  write_bundle(sample_bundle(), folder / "a");
  write_bytes(folder / "a" / "recipe.toml", "other");
  EXPECT_NE(error_of([&] { pack_bundle(folder / "a", folder / "a.tar.zst"); }).find("recipe.toml"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder / "a.tar.zst"));
}

TEST(Pack, RefusesNamesOfOtherFormats) {
  const auto folder = scratch_folder("pack_names");
  write_bundle(sample_bundle(), folder / "a");
  for (const auto* name : {"a.zip", "a.tar.gz", "a.tar", "a"})
    EXPECT_NE(error_of([&] { pack_bundle(folder / "a", folder / "packed" / name); }).find(".tar.zst"),
              std::string::npos);
  EXPECT_FALSE(fs::exists(folder / "packed"));
  pack_bundle(folder / "a", folder / "a.tzst");
  EXPECT_TRUE(fs::exists(folder / "a.tzst"));
}

TEST(Unpack, RefusesTruncatedArchives) {
  const auto folder = scratch_folder("unpack_truncated");
  write_bundle(sample_bundle(), folder / "a");
  pack_bundle(folder / "a", folder / "a.tar.zst");
  const std::string whole = bytes_of(folder / "a.tar.zst");
  for (const double share : {0.0, 0.2, 0.6, 0.99}) {
    write_bytes(folder / "b.tar.zst",
                whole.substr(0, static_cast<std::size_t>(share * static_cast<double>(whole.size()))));
    EXPECT_NE(error_of([&] { unpack_bundle(folder / "b.tar.zst", folder / "b"); }), "") << share;
    EXPECT_FALSE(fs::exists(folder / "b"));
  }
}

/// An archive with one entry of the given name and type.
void write_hostile(const fs::path& path, const std::string& name, unsigned int type) {
  archive* writer = archive_write_new();
  archive_write_add_filter_zstd(writer);
  archive_write_set_format_pax_restricted(writer);
  archive_write_open_filename(writer, path.c_str());
  archive_entry* entry = archive_entry_new();
  archive_entry_set_pathname(entry, name.c_str());
  archive_entry_set_filetype(entry, type);
  if (type == AE_IFLNK) archive_entry_set_symlink(entry, "/etc/passwd");
  archive_entry_set_perm(entry, 0644);
  archive_entry_set_size(entry, type == AE_IFREG ? 4 : 0);
  archive_write_header(writer, entry);
  if (type == AE_IFREG) archive_write_data(writer, "evil", 4);
  archive_entry_free(entry);
  archive_write_close(writer);
  archive_write_free(writer);
}

TEST(Unpack, RefusesEntriesThatLeaveTheFolder) {
  const auto folder = scratch_folder("unpack_hostile");
  for (const char* name : {"../x", "top/../../x", "/x", "x"}) {
    write_hostile(folder / "h.tar.zst", name, AE_IFREG);
    const auto message = error_of([&] { unpack_bundle(folder / "h.tar.zst", folder / "in" / "out"); });
    EXPECT_NE(message.find(std::string("'") + name + "'"), std::string::npos) << message;
    EXPECT_FALSE(fs::exists(folder / "in" / "out"));
    EXPECT_FALSE(fs::exists(folder / "x"));
    EXPECT_FALSE(fs::exists(folder / "in" / "x"));
  }
  write_hostile(folder / "h.tar.zst", "top/link", AE_IFLNK);
  EXPECT_NE(error_of([&] { unpack_bundle(folder / "h.tar.zst", folder / "out"); }).find("top/link"), std::string::npos);
}

/// Name and bytes of an archive's entry; `says` is its length in the header where that is another.
struct PackedFile {
  std::string name, bytes;
  std::int64_t says = -1;
};

void write_packed(const fs::path& path, const std::vector<PackedFile>& files) {
  archive* writer = archive_write_new();
  archive_write_add_filter_zstd(writer);
  archive_write_set_format_pax_restricted(writer);
  archive_write_open_filename(writer, path.c_str());
  for (const auto& file : files) {
    archive_entry* entry = archive_entry_new();
    archive_entry_set_pathname(entry, ("top/" + file.name).c_str());
    archive_entry_set_filetype(entry, AE_IFREG);
    archive_entry_set_perm(entry, 0644);
    archive_entry_set_size(entry, file.says < 0 ? static_cast<std::int64_t>(file.bytes.size()) : file.says);
    archive_write_header(writer, entry);
    archive_write_data(writer, file.bytes.data(), file.bytes.size());
    archive_entry_free(entry);
  }
  archive_write_close(writer);
  archive_write_free(writer);
}

TEST(Unpack, WritesOnlyWhatItsManifestListsAndThatFirst) {
  const auto folder = scratch_folder("unpack_listed");
  write_bundle(sample_bundle(), folder / "a");
  const PackedFile manifest{"manifest.json", bytes_of(folder / "a" / "manifest.json")};
  const PackedFile recipe{"recipe.toml", bytes_of(folder / "a" / "recipe.toml")};
  const auto refused = [&](const std::vector<PackedFile>& files) {
    write_packed(folder / "h.tar.zst", files);
    const auto message = error_of([&] { unpack_bundle(folder / "h.tar.zst", folder / "out"); });
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 2) << "the bundle and the archive: " << message;
    return message;
  };
  EXPECT_NE(refused({recipe, manifest}).find("does not begin with manifest.json"), std::string::npos);
  EXPECT_NE(refused({}).find("does not begin with manifest.json"), std::string::npos);
  EXPECT_NE(refused({manifest, recipe, {"bomb.vtu", std::string(1 << 20, '0')}}).find("'bomb.vtu' is not as"),
            std::string::npos);
  EXPECT_NE(refused({manifest, {recipe.name, recipe.bytes + "more"}}).find("'recipe.toml' is not as"),
            std::string::npos);
  EXPECT_NE(refused({manifest, recipe, recipe}).find("is there twice"), std::string::npos);
  EXPECT_NE(refused({manifest, manifest}).find("is there twice"), std::string::npos);
  EXPECT_NE(refused({manifest, recipe}).find("does not verify"), std::string::npos);
  EXPECT_NE(refused({{"manifest.json", "{}"}}).find("malformed manifest"), std::string::npos);
  EXPECT_NE(refused({{"manifest.json", std::string((1 << 26) + 1, ' ')}}).find("longer"), std::string::npos);
}

TEST(Unpack, HasLimits) {
  const auto folder = scratch_folder("unpack_limits");
  write_bundle(sample_bundle(), folder / "a");
  Manifest manifest = read_manifest(folder / "a");
  const auto refused = [&] {
    write_packed(folder / "h.tar.zst", {{"manifest.json", manifest_text(manifest)}});
    return error_of([&] { unpack_bundle(folder / "h.tar.zst", folder / "out"); });
  };
  manifest.files[0].bytes = std::int64_t{1} << 60;
  EXPECT_NE(refused().find("are free"), std::string::npos) << refused();
  manifest.files.assign(100'001, {"x", std::string(64, '0'), 0});
  EXPECT_NE(refused().find("lists 100001 files"), std::string::npos) << refused();
}

TEST(Unpack, IsOneRunsAlone) {
  const auto folder = scratch_folder("unpack_two");
  write_bundle(sample_bundle(), folder / "a");
  pack_bundle(folder / "a", folder / "a.tar.zst");
  const auto other = reserve_place(folder / "out", Existing::refuse);
  testing::write_bytes(other.partial / "of the other", "x");
  EXPECT_NE(error_of([&] { unpack_bundle(folder / "a.tar.zst", folder / "out"); }).find("another run"),
            std::string::npos);
  EXPECT_TRUE(fs::exists(other.partial / "of the other"));
}

/// As write_bundle, with another mesh name in the manifest, as an attacker would.
TEST(Manifest, RefusesNamesThatLeaveTheFolderOrSteerATerminal) {
  const auto folder = scratch_folder("manifest_names");
  const auto said = [&](const std::function<void(nlohmann::json&)>& change) {
    fs::remove_all(folder / "out");
    write_bundle(sample_bundle(), folder / "out");
    reseal(folder / "out", change);
    return error_of([&] { read_manifest(folder / "out"); });
  };
  EXPECT_EQ(said([](nlohmann::json&) {}), "");
  for (const char* name : {"../../../escaped", "/tmp/escaped", "a/b", "..", ".", ""})
    EXPECT_NE(said([&](nlohmann::json& json) {
                json["meshes"][name] = json["meshes"]["trachea"];
              }).find("cannot be a mesh's name"),
              std::string::npos)
        << name;
  EXPECT_NE(said([](nlohmann::json& json) { json["regions"]["\x1b[31m"] = 1; }).find("control"), std::string::npos);
  EXPECT_NE(said([](nlohmann::json& json) { json["author"] = "\x1b]0;title\a"; }).find("control"), std::string::npos);
  EXPECT_NE(said([](nlohmann::json& json) {
              json["warnings"] = {{{"code", "c"}, {"level", "note"}, {"text", "\x7f"}}};
            }),
            "");
}

TEST(Bundle, NoControlCharactersReachItsTexts) {
  const auto folder = scratch_folder("bundle_control") / "out";
  Bundle bundle = sample_bundle();
  bundle.author = bundle.atlas = bundle.license = "\x1b[31mred";
  bundle.inputs[0].name = "ct: \x1b.nii.gz";
  bundle.certificate.warnings = {{"c", WarningLevel::note, "segment \x1b[2J was left out"}};
  write_bundle(bundle, folder);
  EXPECT_TRUE(verify_bundle(folder).empty());
  for (const char* name : {"README.md", "LICENSE", "CITATION.cff", "ro-crate-metadata.json", "manifest.json"})
    EXPECT_EQ(bytes_of(folder / name).find('\x1b'), std::string::npos) << name;
  EXPECT_NE(bytes_of(folder / "README.md").find("?[31mred"), std::string::npos);
}

TEST(Sha256, KnownDigest) {
  EXPECT_EQ(sha256_of_text("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

}  // namespace
}  // namespace heartgen::exporters
