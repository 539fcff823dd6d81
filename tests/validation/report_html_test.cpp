#include "validation/report_html.hpp"

#include <gtest/gtest.h>

#include <regex>

#include "model/labels.hpp"
#include "synthetic_heart.hpp"
#include "validation/html_text.hpp"
#include "validation/report_tables.hpp"
#include "validation/viewer_data.hpp"

namespace heart::validation {
namespace {

struct Example {
  LabelVolume labels = heart::testing::synthetic_labels(5);
  CtVolume ct = heart::testing::synthetic_ct(labels);
  std::map<std::string, TetMesh> meshes;
  Certificate certificate;
  ReportInput input;

  Example() {
    meshes["myocardium"] = heart::testing::synthetic_myocardium(labels);
    certificate.rows.push_back({"mesh", "myocardium", "dihedral_min", 45, "deg", 5, {}});
    certificate.rows.push_back({"mesh", "myocardium/lv_myocardium", "cells", 1234567, "count", {}, {}});
    certificate.rows.push_back({"mesh", "<script>alert(1)</script>", "cells", 3, "count", {}, {}});
    input.name = "patient <7> & \"co\"";
    input.version = "1.2.3";
    input.picture_width_px = 120;
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
  const std::string html = make_report(example.input);
  EXPECT_EQ(html, make_report(example.input));
  for (const char* remote : {"src=\"http", "href=\"http", "src=\"//", "url(http", "@import", "<link"})
    EXPECT_EQ(html.find(remote), std::string::npos) << remote;
  EXPECT_NE(html.find("patient &lt;7&gt; &amp; &quot;co&quot;"), std::string::npos);
  EXPECT_EQ(html.find("patient <7>"), std::string::npos);
  EXPECT_EQ(html.find("<script>alert"), std::string::npos);
  EXPECT_NE(html.find("ct: a&lt;b.nii.gz"), std::string::npos);
  EXPECT_EQ(count_of(html, "data:image/png;base64,"), count_of(html, "<img"));
  EXPECT_GE(count_of(html, "<img"), 7u + 4u + 2u);  // slices, mesh, fibres
  for (const char* section : {"id=\"view\"", "id=\"image\"", "id=\"meshes\"", "id=\"fibres\"", "id=\"certificate\""})
    EXPECT_EQ(count_of(html, section), 1u) << section;
}

TEST(ReportHtml, TheVerdictFollowsTheRows) {
  Example example;
  example.input.meshes = nullptr, example.input.labels = nullptr, example.input.ct = nullptr;
  EXPECT_NE(make_report(example.input).find("All 1 checks passed"), std::string::npos);
  example.certificate.rows[0].value = 4;
  const std::string failed = make_report(example.input);
  EXPECT_NE(failed.find("1 of 1 checks failed"), std::string::npos);
  EXPECT_NE(failed.find("class=\"fail\""), std::string::npos);
  example.certificate.rows.clear();
  EXPECT_NE(make_report(example.input).find("Nothing was judged"), std::string::npos);
}

TEST(ReportHtml, SaysWhatIsSyntheticOrMissing) {
  Example example;
  example.input.meshes = nullptr;
  example.certificate.warnings = {{"image.fov", WarningLevel::warning, "The field of view cuts <both> arms."}};
  const std::string html = make_report(example.input);
  for (const char* note : {"cuts &lt;both&gt; arms", "no mesh of the myocardium"})
    EXPECT_NE(html.find(note), std::string::npos) << note;
}

TEST(ReportHtml, WorksFromABundleWithoutTheImage) {
  Example example;
  example.input.ct = nullptr, example.input.meshes = nullptr;
  const std::string html = make_report(example.input);
  EXPECT_NE(html.find("id=\"image\""), std::string::npos);
  EXPECT_NE(html.find("not part of a bundle"), std::string::npos);
}

TEST(ReportHtml, WorksWithNothingAtAll) {
  const std::string html = make_report({});
  EXPECT_NE(html.find("</html>"), std::string::npos);
}

TEST(ReportTables, NumbersForPeople) {
  EXPECT_EQ(readable(0), "0");
  EXPECT_EQ(readable(1234567), "1\u202F234\u202F567");
  EXPECT_EQ(readable(-1234), "-1\u202F234");
  EXPECT_EQ(readable(0.123456), "0.1235");
  EXPECT_EQ(readable(12345.6), "12\u202F346");
  EXPECT_EQ(readable(std::nan("")), "not a number");
}

TEST(HtmlText, Base64AndEscapes) {
  EXPECT_EQ(base64("Man", 3), "TWFu");
  EXPECT_EQ(base64("Ma", 2), "TWE=");
  EXPECT_EQ(base64("M", 1), "TQ==");
  EXPECT_EQ(base64("", 0), "");
  EXPECT_EQ(escaped("<a href='x'>&\x01"), "&lt;a href=&#39;x&#39;&gt;&amp; ");
}

TEST(ViewerData, KeepsWithinTheBudget) {
  const Example example;
  ViewerSettings settings;
  const auto full = viewer_data(example.meshes, settings);
  settings.heart_triangles = 400;
  const auto small = viewer_data(example.meshes, settings);
  const auto triangles = [](const std::string& json) {
    std::size_t sum = 0;
    const std::regex number("\"triangles\":(\\d+)");
    for (std::sregex_iterator it(json.begin(), json.end(), number), end; it != end; ++it) sum += std::stoul((*it)[1]);
    return sum;
  };
  EXPECT_GT(triangles(full.index_json), 1000u);
  EXPECT_LE(triangles(small.index_json), 400u);
  EXPECT_GT(triangles(small.index_json), 100u);
  EXPECT_TRUE(full.has_fibers);
  EXPECT_TRUE(viewer_data({}, settings).empty);
}

}  // namespace
}  // namespace heart::validation
