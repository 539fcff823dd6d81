// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/report/report_html.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <regex>

#include "model/labels.hpp"
#include "support/synthetic_heart.hpp"
#include "validation/quantiles.hpp"
#include "validation/report/glossary.hpp"
#include "validation/report/html_text.hpp"
#include "validation/report/pictures.hpp"
#include "validation/report/report_tables.hpp"
#include "validation/report/slice_data.hpp"
#include "validation/report/surface_lines.hpp"
#include "validation/report/viewer_data.hpp"
#include "validation/value_grid.hpp"

namespace heartgen::report {
namespace {

struct Example {
  LabelVolume labels = heartgen::testing::synthetic_labels(5);
  CtVolume ct = heartgen::testing::synthetic_ct(labels);
  std::map<std::string, TetMesh> meshes;
  Certificate certificate;
  report::ReportInput input;

  Example() {
    meshes["myocardium"] = heartgen::testing::synthetic_myocardium(labels);
    certificate.rows.push_back({"mesh", "myocardium", "dihedral_min", 45, "deg", 5, {}});
    certificate.rows.push_back({"mesh", "myocardium/lv_myocardium", "cells", 1234567, "count", {}, {}});
    certificate.rows.push_back({"mesh", "<script>alert(1)</script>", "cells", 3, "count", {}, {}});
    input.name = "patient <7> & \"co\"";
    input.version = "1.2.3";
    input.ct = &ct;
    input.labels = &labels;
    input.meshes = &meshes;
    input.certificate = &certificate;
    input.atlas_name = "atlas & fibres";
    input.inputs = {{"ct: a<b.nii.gz", "00ff"}};
    input.tools = {{"ITK", "5.2"}};
  }
};

std::size_t count_of(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

TEST(ReportHtml, IsSelfContainedEscapedAndTheSameTwice) {
  const Example example;
  const std::string html = report::make_report(example.input);
  EXPECT_EQ(html, report::make_report(example.input));
  for (const char* remote : {"src=\"http", "href=\"http", "src=\"//", "url(http", "@import", "<link"})
    EXPECT_EQ(html.find(remote), std::string::npos) << remote;
  EXPECT_NE(html.find("patient &lt;7&gt; &amp; &quot;co&quot;"), std::string::npos);
  EXPECT_EQ(html.find("patient <7>"), std::string::npos);
  EXPECT_EQ(html.find("<script>alert"), std::string::npos);
  EXPECT_NE(html.find("ct: a&lt;b.nii.gz"), std::string::npos);
  for (const char* section : {"id=\"view\"", "id=\"image\"", "id=\"charts\"", "id=\"certificate\"", "id=\"methods\"",
                              "id=\"model-data\"", "id=\"image-data\""})
    EXPECT_EQ(count_of(html, section), 1u) << section;
}

/// Without pictures: what the certificate alone makes of the page.
struct Told : Example {
  Told() { input.meshes = nullptr, input.labels = nullptr, input.ct = nullptr; }
  std::string html() const { return report::make_report(input); }
};

void expect_all(const std::string& html, std::initializer_list<const char*> texts) {
  for (const char* text : texts) EXPECT_NE(html.find(text), std::string::npos) << text;
}

TEST(ReportHtml, TheVerdictFollowsTheCertificate) {
  Told example;
  Certificate& certificate = example.certificate;
  expect_all(example.html(), {"This model passes its certificate.", "Of 1 judged measures none fails and none warns"});
  certificate.rows[0].warn_below = 50;
  expect_all(example.html(),
             {"passes its certificate, with warnings", "0 fail and 1 warns", "What fails and what warns"});
  certificate.rows[0].value = 4;
  expect_all(example.html(), {"This model fails its certificate.", "1 fails and 0 warn", "class=\"fail\""});
  certificate.rows[0].value = 60;
  certificate.warnings = {{"landmarks.doubtful", WarningLevel::doubt, "The heart may be a spine."}};
  expect_all(example.html(),
             {"This model may be wrong as a whole.", "The heart may be a spine.", "landmarks.doubtful"});
  certificate = {};
  expect_all(example.html(), {"Nothing was judged."});
}

TEST(ReportHtml, OpensWithDoubtsThenWarningsThenUses) {
  Told example;
  example.certificate.warnings = {{"a.note", WarningLevel::note, "Good to know."},
                                  {"b.warning", WarningLevel::warning, "Check <this>."},
                                  {"c.doubt", WarningLevel::doubt, "Perhaps no heart."}};
  example.certificate.uses = {
      {"eikonal", Fitness::fit, true, {}, ""},
      {"blood_flow", Fitness::unfit, false, {"The aorta has no orifice."}, "mesh.meshes = [\"chambers\"]"}};
  const std::string html = example.html();
  expect_all(html, {"Fit for eikonal activation; unfit for blood flow.", "Check &lt;this&gt;.", "asked for",
                    "The aorta has no orifice.", "mesh.meshes = [&quot;chambers&quot;]"});
  const auto at = [&](const char* text) { return html.find(text); };
  EXPECT_LT(at("Fit for eikonal"), at("Perhaps no heart."));
  EXPECT_LT(at("Perhaps no heart."), at("Check &lt;this&gt;."));
  EXPECT_LT(at("Check &lt;this&gt;."), at("The aorta has no orifice."));
}

TEST(ReportHtml, SaysWhatIsSyntheticOrMissing) {
  Told example;
  EXPECT_EQ(example.html().find("not a patient"), std::string::npos);
  example.certificate.warnings = {{"image.synthetic", WarningLevel::note, "An analytic phantom."}};
  expect_all(example.html(),
             {"phantom: a synthetic image, not a patient", "no mesh of the myocardium", "no label map"});
}

TEST(ReportHtml, FlaggedRowsTellWhyAndLeadToTheirPlace) {
  Example example;
  ReportRow row{"mesh", "myocardium/lv_myocardium", "dihedral_min", 3, "deg", 30, {}};
  row.reason = "The mesher guarantees <30> degrees.";
  example.certificate.rows = {row, {"fibers", "atlas", "jacobian_min", -1, "1", 0, {}}};
  const std::string html = report::make_report(example.input);
  expect_all(html, {"data-show=\"lv_myocardium\" data-color=\"quality\"", "guarantees &lt;30&gt; degrees",
                    "data-term=\"dihedral_min\"", "id=\"term-dihedral_min\"", "id=\"term-jacobian_min\""});
  EXPECT_EQ(count_of(html, "data-show=\""), 1u) << "the view cannot show an atlas";
}

TEST(ReportHtml, FlaggedRowsOfOneMeasureShareItsBoundAndReason) {
  Told example;
  const auto row = [](const char* scope, const char* metric, double value, double at_least) {
    ReportRow made{"mesh", scope, metric, value, "1", at_least, {}, at_least + 2};
    made.reason = fmt::format("Reason of {}.", metric);
    return made;
  };
  example.certificate.rows = {row("w/a", "one", 4, 3), row("w/b", "two", 4, 3), row("w/c", "one", 4, 3),
                              row("w/d", "one", 1, 3), row("w/e", "one", 4, 3.5)};
  std::string html = example.html();
  html = html.substr(html.find("<ul class=\"flagged\">"));
  html = html.substr(0, html.find("</ul>"));
  EXPECT_EQ(count_of(html, "<li"), 4u) << "a failure, and another bound, stand alone";
  EXPECT_EQ(count_of(html, "Reason of one."), 3u);
  std::vector<std::size_t> places;
  for (const char* place : {"<b>w/d</b>", "<b>w/a</b>", "<b>w/c</b>", "<b>w/b</b>", "<b>w/e</b>"}) {
    EXPECT_EQ(count_of(html, place), 1u) << place;
    places.push_back(html.find(place));
  }
  EXPECT_TRUE(std::is_sorted(places.begin(), places.end())) << "failures first, then by measure";
}

TEST(ReportHtml, ManyFlaggedRowsAreFolded) {
  Told example;
  example.certificate.rows.assign(30, {"mesh", "myocardium", "dihedral_min", 3, "deg", 30, {}});
  expect_all(example.html(), {"24 more"});
}

TEST(ReportHtml, WorksFromABundleWithoutTheImage) {
  Example example;
  example.input.ct = nullptr, example.input.meshes = nullptr;
  expect_all(report::make_report(example.input), {"id=\"image\"", "not part of a bundle"});
}

TEST(ReportHtml, WorksWithNothingAtAll) {
  const std::string html = report::make_report({});
  EXPECT_NE(html.find("</html>"), std::string::npos);
}

TEST(ReportHtml, TheMethodsNameWhatWasUsed) {
  Example example;
  example.input.tools = {{"heartgen", "9.8.7"}};
  auto& sources = example.meshes["myocardium"].fiber_source;
  expect_all(report::make_report(example.input),
             {"made with heartgen 9.8.7", "carried from the atlas &quot;atlas &amp; fibres", "segmented in the CT",
              "Streeter 1969", "Rousseau 2009"});
  EXPECT_EQ(report::make_report(example.input).find("Piersanti"), std::string::npos);
  sources.assign(sources.size(), static_cast<std::uint8_t>(FiberSource::rule));
  const std::string by_rule = report::make_report(example.input);
  expect_all(by_rule, {"Piersanti 2021"});
  EXPECT_EQ(by_rule.find("carried from the atlas"), std::string::npos);
}

TEST(Glossary, ExplainsMetricsWithTheirStatistics) {
  EXPECT_NE(report::meaning_of("dihedral_min").find("two faces of a tetrahedron"), std::string::npos);
  EXPECT_NE(report::meaning_of("dihedral_min").find("smallest of all"), std::string::npos);
  EXPECT_NE(report::meaning_of("to_labels_p99_in_edges").find("units of the edges"), std::string::npos);
  EXPECT_NE(report::meaning_of("to_labels_p99_in_edges").find("99 %"), std::string::npos);
  EXPECT_NE(report::meaning_of("edge_found").find("image has an edge"), std::string::npos)
      << "not the edges of tetrahedra";
  EXPECT_EQ(report::meaning_of("nobody_knows"), "");
}

TEST(ReportTables, NumbersForPeople) {
  EXPECT_EQ(report::readable(0), "0");
  EXPECT_EQ(report::readable(1234567), "1\u202F234\u202F567");
  EXPECT_EQ(report::readable(-1234), "-1\u202F234");
  EXPECT_EQ(report::readable(0.123456), "0.1235");
  EXPECT_EQ(report::readable(12345.6), "12\u202F346");
  EXPECT_EQ(report::readable(std::nan("")), "not a number");
}

TEST(HtmlText, Base64AndEscapes) {
  EXPECT_EQ(report::base64("Man", 3), "TWFu");
  EXPECT_EQ(report::base64("Ma", 2), "TWE=");
  EXPECT_EQ(report::base64("M", 1), "TQ==");
  EXPECT_EQ(report::base64("", 0), "");
  EXPECT_EQ(report::escaped("<a href='x'>&\x01"), "&lt;a href=&#39;x&#39;&gt;&amp; ");
}

std::vector<validation::WallField> fields_of(const TetMesh& walls) {
  return validation::wall_fields(walls, report::helix_angle_per_node(walls));
}

TEST(ViewerData, KeepsWithinTheBudget) {
  const Example example;
  const auto faces = validation::faces_of_meshes(example.meshes);
  const auto fields = fields_of(example.meshes.at("myocardium"));
  report::ViewerSettings settings;
  const auto full = report::viewer_data(example.meshes, faces, fields, settings);
  settings.heart_triangles = 400;
  const auto small = report::viewer_data(example.meshes, faces, fields, settings);
  const auto triangles = [](const std::string& json) {
    std::size_t sum = 0;
    const std::regex walls("\"group\":\"muscle\"[^]*?\"triangles\":(\\d+)");
    for (std::sregex_iterator it(json.begin(), json.end(), walls), end; it != end; ++it) sum += std::stoul((*it)[1]);
    return sum;
  };
  EXPECT_GT(triangles(full.index_json), 1000u);
  EXPECT_LE(triangles(small.index_json), 400u);
  EXPECT_GT(triangles(small.index_json), 100u);
  EXPECT_TRUE(full.has_fibers);
  EXPECT_TRUE(report::viewer_data({}, {}, {}, settings).empty);
}

TEST(WallFields, ThicknessIsTheWalls) {
  const Example example;
  const TetMesh& walls = example.meshes.at("myocardium");
  const auto fields = fields_of(walls);
  const auto thickness =
      std::find_if(fields.begin(), fields.end(), [](const validation::WallField& f) { return f.id == "thickness"; });
  ASSERT_NE(thickness, fields.end());
  std::vector<double> left;
  for (std::size_t n = 0; n < walls.nodes_mm.size(); ++n) {
    const Vec3& p = walls.nodes_mm[n];
    const bool is_free_wall = p.x > 18 && std::abs(p.y) < 12 && p.z > -5 && p.z < 10;
    if (is_free_wall && std::isfinite(thickness->values[n])) left.push_back(thickness->values[n]);
  }
  ASSERT_GT(left.size(), 10u);
  EXPECT_NEAR(validation::quantile(left, 0.5), 10, 2.5) << "the ellipsoids are 10 mm apart, in voxels of 5 mm";
}

TEST(WallFields, BytesSpanTheScale) {
  const validation::WallField field{"x", "", "", -90, 90, {}, {}}, source{"s", "", "", 0, 2, {}, {"a", "b", "c"}};
  EXPECT_EQ(validation::byte_of(field, std::nan("")), 0);
  EXPECT_EQ(validation::byte_of(field, -90), 1);
  EXPECT_EQ(validation::byte_of(field, 0), 128);
  EXPECT_EQ(validation::byte_of(field, 500), 255);
  EXPECT_EQ(validation::byte_of(source, 2), 3);
}

/// A flat square of n × n cells of 1 mm, axes at an angle to x.
report::ViewPart square(std::uint32_t n, double angle_deg) {
  report::ViewPart part;
  const double a = angle_deg * 3.14159265358979 / 180;
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i) {
      part.points_mm.push_back({double(i), double(j), 0});
      // Axes have no sign.
      part.fibers.push_back(((i + j) % 2 ? -1.0 : 1.0) * Vec3{std::cos(a), std::sin(a), 0});
    }
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t v = j * (n + 1) + i;
      part.triangles.push_back({v, v + 1, v + n + 2});
      part.triangles.push_back({v, v + n + 2, v + n + 1});
    }
  return part;
}

TEST(SurfaceLines, FollowTheAxesToTheirLength) {
  const report::ViewPart part = square(20, 25);
  const auto lines = report::surface_lines(part, 3, 6);
  ASSERT_GT(lines.size(), 30u);
  double longest = 0;
  for (const report::SurfaceLine& line : lines) {
    ASSERT_EQ(line.points_mm.size(), line.nearest.size());
    const Vec3 way = line.points_mm.back() - line.points_mm.front();
    EXPECT_NEAR(std::abs(std::atan2(way.y, way.x)) * 180 / 3.14159265358979, way.x > 0 ? 25 : 155, 1e-6);
    longest = std::max(longest, norm(way));
  }
  EXPECT_NEAR(longest, 6, 1e-9);
}

TEST(SurfaceLines, NoneWhereAxesLeaveTheSurface) {
  report::ViewPart part = square(6, 0);
  for (Vec3& axis : part.fibers) axis = {0.1, 0, 1};
  EXPECT_TRUE(report::surface_lines(part, 2, 6).empty());
  part.fibers.clear();
  EXPECT_TRUE(report::surface_lines(part, 2, 6).empty());
}

TEST(ViewSurfaces, TheRimOfASquareIsItsFourSides) { EXPECT_EQ(report::rim_edges(square(5, 0)).size(), 20u); }

TEST(ValueGrid, JoinsNodesOfACubeAndFillsTwoCubesAround) {
  const std::vector<Vec3> nodes = {{0, 0, 0}, {0.5, 0.5, 0.5}, {9, 0, 0}};
  const validation::ValueGrid grid = validation::make_value_grid(nodes);
  const auto mean = validation::grid_values(grid, {10, 30, 50}, validation::Join::mean),
             largest = validation::grid_values(grid, {1, 3, 2}, validation::Join::largest);
  const auto at = static_cast<std::size_t>(grid.cube[0]);
  EXPECT_EQ(grid.cube[0], grid.cube[1]);
  EXPECT_DOUBLE_EQ(mean[at], 20);
  EXPECT_DOUBLE_EQ(largest[at], 3);
  EXPECT_DOUBLE_EQ(mean[at - 2], 20);
  EXPECT_TRUE(std::isfinite(mean[at + 2]));
}

std::vector<std::uint8_t> unpacked(const std::string& base64_text, std::size_t bytes) {
  std::vector<std::uint8_t> packed, data(bytes);
  std::uint32_t bits = 0;
  int count = 0;
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (const char c : base64_text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(digits.find(c));
    if ((count += 6) >= 8) packed.push_back(static_cast<std::uint8_t>(bits >> (count -= 8)));
  }
  uLongf size = bytes;
  EXPECT_EQ(uncompress(data.data(), &size, packed.data(), packed.size()), Z_OK);
  EXPECT_EQ(size, bytes);
  return data;
}

TEST(SliceData, HoldsTheHeartWithinItsLimit) {
  const Example example;
  const report::SliceData data = report::slice_data(&example.ct, example.labels, 4000);
  ASSERT_TRUE(data.has_ct);
  std::smatch found;
  ASSERT_TRUE(std::regex_search(data.index_json, found, std::regex("\"size\":\\[(\\d+),(\\d+),(\\d+)\\]")));
  const std::size_t nx = std::stoul(found[1]), voxels = nx * std::stoul(found[2]) * std::stoul(found[3]);
  EXPECT_LE(voxels, 4000u);
  EXPECT_GT(voxels, 500u);
  const std::size_t labels_at = (voxels + 3) / 4 * 4;
  auto bytes = unpacked(data.data_base64, labels_at + voxels);
  for (std::size_t v = 0; v < voxels; ++v)
    if (v % nx) bytes[v] = static_cast<std::uint8_t>(bytes[v] + bytes[v - 1]);
  double blood = 0, muscle = 0, bloods = 0, muscles = 0;
  for (std::size_t v = 0; v < voxels; ++v) {
    const auto region = static_cast<Region>(bytes[labels_at + v]);
    if (is_blood(region)) blood += bytes[v], bloods += 1;
    if (is_myocardium(region)) muscle += bytes[v], muscles += 1;
  }
  ASSERT_GT(bloods, 0);
  ASSERT_GT(muscles, 0);
  EXPECT_GT(blood / bloods, muscle / muscles + 20) << "300 HU against 100 HU";
}

TEST(SliceData, NothingWithoutLabels) {
  const Example example;
  EXPECT_TRUE(report::slice_data(nullptr, LabelVolume(example.labels.grid)).empty);
  EXPECT_FALSE(report::slice_data(nullptr, example.labels).has_ct);
}

}  // namespace
}  // namespace heartgen::report
