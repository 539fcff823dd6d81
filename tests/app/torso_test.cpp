// SPDX-License-Identifier: GPL-3.0-or-later
// The heart of one patient in the torso of another ([torso] of the recipe), as a user builds it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "exporters/bundle.hpp"
#include "exporters/certificate_json.hpp"
#include "generator/adapters/itk_io.hpp"
#include "model/labels.hpp"
#include "support/data.hpp"
#include "support/program.hpp"

namespace heartgen {
namespace {

namespace fs = std::filesystem;

/// Two phantoms' label maps; the heart is built from its own, without a CT.
class AnotherTorso : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder() = testing::scratch_folder("torso");
    for (const auto& [name, variant] : {std::pair{"patient", 0}, {"other", 3}})
      ASSERT_EQ(
          testing::heartgen(fmt::format("phantom {} --size 90,84,72 --spacing 2.6,2.6,2.6 --variant {}", name, variant),
                            folder().string())
              .exit_code,
          0);
    write_size_field();
    build("in_heart", "frame = \"heart\"");
  }

  /// Edges of 2 mm below the middle of the image, in its frame.
  static void write_size_field() {
    const auto labels = adapters::read_labels((folder() / "patient/truth/labels.nii.gz").string());
    Volume<float> edges_mm(labels.grid, 0);
    std::fill_n(edges_mm.voxels.begin(), edges_mm.voxels.size() / 2, 2.0F);
    adapters::write_volume((folder() / "edges.nii.gz").string(), edges_mm);
  }

  static void build(const std::string& name, const std::string& torso) {
    std::ofstream(folder() / (name + ".toml"))
        << "[input]\nlabels = \"patient/truth/labels.nii.gz\"\nsize_field = \"edges.nii.gz\"\n"
        << "[torso]\nlabels = \"other/truth/labels.nii.gz\"\n"
        << torso << "\n[mesh]\nmeshes = [\"myocardium\", \"torso\"]\n"
        << "heart_edge_mm = 3\nblood_edge_mm = 8\ntorso_edge_mm = 24\n"
        << "[fibers]\ngrid_mm = 3\ndepth_grid_mm = 3\ndemons_iterations = [5, 3, 1]\n";
    const auto run =
        testing::heartgen(fmt::format("build {0}.toml --output {0} --quiet --no-cache", name), folder().string());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
  }

  static fs::path& folder() {
    static fs::path path;
    return path;
  }
  static double value(const std::string& bundle, const std::string& metric) {
    for (const auto& row : exporters::read_certificate(folder() / bundle).rows)
      if (row.group == "pose" && row.metric == metric) return row.value;
    ADD_FAILURE() << metric;
    return -1;
  }
};

Vec3 through(const std::vector<double>& pose, const Vec3& p, double shift) {
  const auto row = [&](std::size_t r) {
    return pose[4 * r] * p.x + pose[4 * r + 1] * p.y + pose[4 * r + 2] * p.z + shift * pose[4 * r + 3];
  };
  return {row(0), row(1), row(2)};
}

TEST_F(AnotherTorso, HeartAndTorsoAreOneMeshAndThePoseIsKept) {
  const auto manifest = exporters::read_manifest(folder() / "in_heart");
  ASSERT_EQ(manifest.torso_from_heart.size(), 12U);
  EXPECT_NE(exporters::read_recipe_text(folder() / "in_heart")
                .find("torso_from_heart = [" + fmt::format("{}", manifest.torso_from_heart[0])),
            std::string::npos);
  EXPECT_LT(value("in_heart", "marks_rms"), 15) << "four chambers of two patients";
  EXPECT_NEAR(value("in_heart", "scale"), 1, 1e-9);
  const auto heart = exporters::read_mesh(folder() / "in_heart", "myocardium");
  const auto torso = exporters::read_mesh(folder() / "in_heart", "torso");
  ASSERT_EQ(heart.parent_node.size(), heart.nodes_mm.size());
  for (std::size_t n = 0; n < heart.nodes_mm.size(); ++n)
    ASSERT_EQ(heart.nodes_mm[n], torso.nodes_mm[static_cast<std::size_t>(heart.parent_node[n])]);
  std::size_t with_fibers = 0;
  for (const auto& fiber : torso.cell_fibers.fiber) with_fibers += fiber != Vec3{};
  EXPECT_EQ(with_fibers, heart.cells.size()) << "fibres where there is muscle, and nowhere else";
  for (std::size_t c = 0; c < heart.cells.size(); ++c)
    ASSERT_EQ(heart.cell_fibers.fiber[c], torso.cell_fibers.fiber[static_cast<std::size_t>(heart.parent_cell[c])]);
  for (std::size_t n = 0; n < heart.nodes_mm.size(); ++n)
    ASSERT_EQ(heart.node_fibers.sheet[n], torso.node_fibers.sheet[static_cast<std::size_t>(heart.parent_node[n])]);
  EXPECT_GT(manifest.meshes.at("torso").surfaces.at("fov_cut"), 20) << "the other's image ends in the body";
  EXPECT_GT(manifest.meshes.at("torso").regions.at("lung"), 100);
}

TEST_F(AnotherTorso, TheUsersSizeFieldIsInTheMeshAndInTheManifest) {
  const auto heart = exporters::read_mesh(folder() / "in_heart", "myocardium");
  const auto labels = adapters::read_labels((folder() / "patient/truth/labels.nii.gz").string());
  const auto middle = static_cast<double>(labels.grid.size[2]) / 2;
  constexpr double clear = 4;  // voxels: sizes change gradually
  std::array<double, 2> volume{}, count{};
  for (const auto& cell : heart.cells) {
    const auto at = [&](std::size_t i) { return heart.nodes_mm[static_cast<std::size_t>(cell[i])]; };
    const double k = index_from_lps(labels.grid, (at(0) + at(1) + at(2) + at(3)) / 4).z;
    if (std::abs(k - middle) < clear) continue;
    const std::size_t upper = k > middle;
    volume[upper] += dot(at(1) - at(0), cross(at(2) - at(0), at(3) - at(0))) / 6;
    ++count[upper];
  }
  EXPECT_GT(volume[1] / count[1], 1.8 * volume[0] / count[0]) << "edges of 3 mm above, of 2 mm below";
  const auto inputs = exporters::read_manifest(folder() / "in_heart").inputs;
  EXPECT_TRUE(
      std::any_of(inputs.begin(), inputs.end(), [](const auto& i) { return i.name == "size_field: edges.nii.gz"; }));
}

/// With the pose that the first bundle has recorded.
TEST_F(AnotherTorso, InTheTorsosFrameEverythingIsMoved) {
  const auto pose = exporters::read_manifest(folder() / "in_heart").torso_from_heart;
  build("in_torso", fmt::format("frame = \"torso\"\ntorso_from_heart = [{}]", fmt::join(pose, ", ")));
  EXPECT_EQ(exporters::read_manifest(folder() / "in_torso").torso_from_heart, pose);
  const auto here = exporters::read_mesh(folder() / "in_heart", "myocardium");
  const auto there = exporters::read_mesh(folder() / "in_torso", "myocardium");
  ASSERT_EQ(here.nodes_mm.size(), there.nodes_mm.size()) << "the same lattice, turned";
  double sum_deg = 0;
  for (std::size_t n = 0; n < here.nodes_mm.size(); ++n) {
    ASSERT_LT(norm(through(pose, here.nodes_mm[n], 1) - there.nodes_mm[n]), 1e-3);
    const double cosine = std::abs(dot(through(pose, here.node_fibers.fiber[n], 0), there.node_fibers.fiber[n]));
    sum_deg += std::acos(std::min(cosine, 1.0)) * 180 / std::numbers::pi;
  }
  EXPECT_LT(sum_deg / static_cast<double>(here.nodes_mm.size()), 8) << "grids along other axes carry the fibres";
  // The skin lies where the other patient's is: every node of the torso's outer surface is near the end of its body.
  const auto torso = exporters::read_mesh(folder() / "in_torso", "torso");
  const auto other = adapters::read_labels((folder() / "other/truth/labels.nii.gz").string());
  const auto skin = *surface_from_name("skin");
  std::size_t off = 0, count = 0;
  for (std::size_t f = 0; f < torso.faces.size(); ++f) {
    if (torso.surface[f] != skin) continue;
    const auto p = torso.nodes_mm[static_cast<std::size_t>(torso.faces[f][0])];
    const Vec3 index = index_from_lps(other.grid, p);
    bool inside = false, outside = false;
    for (int k = -2; k <= 2; ++k)
      for (int j = -2; j <= 2; ++j)
        for (int i = -2; i <= 2; ++i) {
          const auto x = std::lround(index.x) + i, y = std::lround(index.y) + j, z = std::lround(index.z) + k;
          const bool is_body = other.grid.contains(x, y, z) && other(x, y, z) != 0;
          (is_body ? inside : outside) = true;
        }
    ++count;
    off += !inside || !outside;
  }
  EXPECT_GT(count, 100U);
  EXPECT_LT(static_cast<double>(off), 0.02 * static_cast<double>(count));
}

/// A CT of which a box was measured, whose border cuts the lungs.
constexpr std::int64_t padding_voxels = 13;
CtVolume padded(CtVolume ct) {
  const auto nx = ct.grid.size[0], ny = ct.grid.size[1];
  for (std::size_t v = 0; v < ct.voxels.size(); ++v) {
    const auto i = static_cast<std::int64_t>(v) % nx, j = static_cast<std::int64_t>(v) / nx % ny;
    if (std::min(i, nx - 1 - i) < padding_voxels || std::min(j, ny - 1 - j) < padding_voxels) ct.voxels[v] = -2000;
  }
  return ct;
}

/// Its cut lungs are no air around a body, and the body's surface is not skin where the padding begins.
TEST_F(AnotherTorso, TheOtherPatientsCtMayBePadded) {
  const auto ct = adapters::read_ct((folder() / "other/ct.nii.gz").string());
  adapters::write_volume((folder() / "padded.nrrd").string(), padded(ct));
  std::ofstream(folder() / "padded.toml")
      << "[input]\nlabels = \"patient/truth/labels.nii.gz\"\n"
      << "[torso]\nct = \"padded.nrrd\"\nframe = \"torso\"\n[mesh]\nmeshes = [\"myocardium\", "
      << "\"torso\"]\nheart_edge_mm = 4\nblood_edge_mm = 8\ntorso_edge_mm = 24\n"
      << "[fibers]\ngrid_mm = 3\ndepth_grid_mm = 3\ndemons_iterations = [5, 3, 1]\n"
      << "[validation]\nuses = [\"finite_volumes\"]\n";  // such edges serve no other
  const auto run = testing::heartgen("build padded.toml --output padded --quiet --no-cache", folder().string());
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_NE(testing::text_of((folder() / "padded/validation/report.html").string()).find("CT: The CT holds -2000 HU"),
            std::string::npos);
  const auto manifest = exporters::read_manifest(folder() / "padded");
  EXPECT_GT(manifest.meshes.at("torso").regions.at("lung"), 100);

  const auto torso = exporters::read_mesh(folder() / "padded", "torso");
  const auto skin = *surface_from_name("skin"), cut = *surface_from_name("fov_cut");
  std::size_t beside = 0, cuts = 0;
  for (std::size_t f = 0; f < torso.faces.size(); ++f) {
    if (torso.surface[f] != skin && torso.surface[f] != cut) continue;
    const auto at = [&](std::size_t i) { return torso.nodes_mm[static_cast<std::size_t>(torso.faces[f][i])]; };
    const Vec3 index = index_from_lps(ct.grid, (at(0) + at(1) + at(2)) / 3);
    const double nx = static_cast<double>(ct.grid.size[0]), ny = static_cast<double>(ct.grid.size[1]);
    const double from_side = std::min(index.x, nx - 1 - index.x) - padding_voxels;
    const double from_front = std::min(index.y, ny - 1 - index.y) - padding_voxels;
    if (from_side > 1 || from_front < 8) continue;  // the two sides, away from where they meet front and back
    ++beside;
    cuts += torso.surface[f] == cut;
  }
  EXPECT_GT(beside, 50U);
  EXPECT_GT(static_cast<double>(cuts), 0.9 * static_cast<double>(beside));
}

TEST_F(AnotherTorso, APoseOutsideTheBodyIsRefused) {
  std::ofstream(folder() / "away.toml")
      << "[input]\nlabels = \"patient/truth/labels.nii.gz\"\n[torso]\nlabels = \"other/truth/labels.nii.gz\"\n"
      << "torso_from_heart = [1, 0, 0, 400, 0, 1, 0, 0, 0, 0, 1, 0]\n";
  const auto run = testing::heartgen("build away.toml --output away --quiet --no-cache", folder().string());
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.errors.find("outside the torso"), std::string::npos) << run.errors;
}

}  // namespace
}  // namespace heartgen
