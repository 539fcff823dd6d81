// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "benchmarks/study/global_minimum.hpp"
#include "benchmarks/study/phases.hpp"
#include "benchmarks/study/studies.hpp"
#include "benchmarks/study/test_images.hpp"

namespace heartgen::study {
namespace {

constexpr int zoom = 3;

std::vector<std::string> result_row(const std::string& name, double mu, const PhaseResult& result,
                                    const Misclassified& bad) {
  return {name,
          fmt::format("{:g}", mu),
          std::to_string(result.iterations),
          result.steady ? "yes" : "no",
          std::to_string(bad.wrong),
          std::to_string(bad.foreign)};
}

/// Two level sets against the hierarchy on the same image with the same weights.
void junctions(StudyResult& study, bool quick) {
  const FlatRegions scene = bricks(quick ? 60 : 100);
  study.pictures.push_back(
      {"bricks", "four regions that all touch each other", grey_picture(scene.image, 0, 255, zoom)});
  Table table{"bricks",
              "Misclassified pixels. \"Foreign\": of a class that the true image does not have within 3 pixels",
              {"method", "μ (λ = 1)", "iterations", "steady", "wrong", "foreign"},
              {}};
  Misclassified light_four, heavy_four, heavy_tree;
  for (const double mu : {1.0, 10000.0, 30000.0}) {
    PhaseSettings s;
    s.mu = mu;
    const PhaseResult four = four_phases(scene.image, s), tree = hierarchical_phases(scene.image, s, {mu, mu, mu});
    const Misclassified bad_four = compare_classes(four.classes, scene.truth),
                        bad_tree = compare_classes(tree.classes, scene.truth);
    table.rows.push_back(result_row("two level sets", mu, four, bad_four));
    table.rows.push_back(result_row("hierarchy", mu, tree, bad_tree));
    study.pictures.push_back({fmt::format("two-level-sets-{:g}", mu), fmt::format("two level sets, μ = {:g}", mu),
                              class_picture(four.classes, zoom)});
    study.pictures.push_back(
        {fmt::format("hierarchy-{:g}", mu), fmt::format("hierarchy, μ = {:g}", mu), class_picture(tree.classes, zoom)});
    (mu == 1 ? light_four : heavy_four) = bad_four;
    heavy_tree = bad_tree;
  }
  study.tables.push_back(table);
  study.claims.push_back({"Fig 5.14", "two level sets segment correctly where curvature does not dominate",
                          light_four.wrong == 0, fmt::format("{} wrong pixels at μ = 1", light_four.wrong)});
  study.claims.push_back(
      {"Fig 5.14", "where it does, pixels along superposed curves fall into a class that has no business there",
       heavy_four.foreign > 0,
       fmt::format("{} wrong, {} of them foreign, at μ = 30000", heavy_four.wrong, heavy_four.foreign)});
  study.claims.push_back({"Fig 5.15", "the hierarchy does not", heavy_tree.foreign == 0,
                          fmt::format("{} wrong, {} foreign, at μ = 30000", heavy_tree.wrong, heavy_tree.foreign)});
}

void layers(StudyResult& study, bool quick) {
  const FlatRegions egg = nested(quick ? 60 : 100);
  FlatRegions corner = bricks(quick ? 60 : 100);
  for (int j = 0; j < corner.truth.height; ++j)
    for (int i = 0; i < corner.truth.width; ++i) {
      // Three regions that meet in a point: the darkest touches the brightest.
      auto& region = corner.truth(i, j);
      region = i >= corner.truth.width / 2 ? 2 : region == 0 ? 0 : 1;
      corner.image(i, j) = 40 + 80 * region;
    }
  Table table{"layers",
              "Three phases as layers of one level set",
              {"image", "μ (λ = 1)", "iterations", "steady", "wrong", "foreign"},
              {}};
  Misclassified nested_light;
  for (const double mu : {1000.0, 30000.0}) {
    PhaseSettings s;
    s.mu = mu;
    const PhaseResult in = three_layers(egg.image, s), out = three_layers(corner.image, s);
    const Misclassified good = compare_classes(in.classes, egg.truth), bad = compare_classes(out.classes, corner.truth);
    table.rows.push_back(result_row("one inside the other", mu, in, good));
    table.rows.push_back(result_row("meeting in a point", mu, out, bad));
    study.pictures.push_back({fmt::format("layers-nested-{:g}", mu),
                              fmt::format("layers, one inside the other, μ = {:g}", mu),
                              class_picture(in.classes, zoom)});
    study.pictures.push_back({fmt::format("layers-corner-{:g}", mu),
                              fmt::format("layers that meet in a point, μ = {:g}", mu),
                              class_picture(out.classes, zoom)});
    if (mu == 1000) nested_light = good;
  }
  study.tables.push_back(table);
  study.claims.push_back({"4.4.2", "layers of one level set serve phases that lie one inside the other",
                          nested_light.wrong == 0, fmt::format("{} wrong pixels at μ = 1000", nested_light.wrong)});
}

/// L1 against L2 on the photographer (Fig 5.19), by the convex solver.
void norms(StudyResult& study, bool quick) {
  const Field image = photographer(quick ? 96 : 256);
  const Domain plane = whole_plane(image.width, image.height);
  struct Variant {
    const char *file, *name;
    Norm norm;
    double lambda;
  };
  Table table{"norms",
              "L1 against L2 fidelity, μ = 1",
              {"fidelity", "λ", "dark c", "bright c", "length (piecewise linear)", "iterations"},
              {}};
  std::vector<double> found;
  for (const auto& v :
       {Variant{"l2-strong", "L2", Norm::l2, 0.1}, {"l1", "L1", Norm::l1, 0.1}, {"l2-weak", "L2", Norm::l2, 0.0005}}) {
    GlobalSettings problem;
    problem.norm = v.norm, problem.mu = 1, problem.lambda = v.lambda;
    const GlobalMinimum result = global_minimum(image, plane, problem);
    found.push_back(contour_length(result.phi, Length::piecewise_linear));
    table.rows.push_back({v.name, fmt::format("{:g}", v.lambda),
                          fmt::format("{:.1f}", std::min(result.c.negative, result.c.positive)),
                          fmt::format("{:.1f}", std::max(result.c.negative, result.c.positive)),
                          fmt::format("{:.1f}", found.back()), std::to_string(result.iterations)});
    study.pictures.push_back({std::string("norm-") + v.file, fmt::format("{}, λ = {:g}", v.name, v.lambda),
                              class_picture(positive_side(result.phi, plane))});
  }
  study.tables.push_back(table);
  study.claims.push_back({"Fig 5.19", "with the same μ and λ the L1 contour is the smoother one", found[1] < found[0],
                          fmt::format("contour length {:.0f} (L1) and {:.0f} (L2)", found[1], found[0])});
}

}  // namespace

StudyResult study_phases(const StudySettings& settings) {
  StudyResult study{"phases",
                    "More than two phases, and L1 against L2 (4.4.2, 5.3, 5.4)",
                    "Two level sets are started from four grey classes, so the start is right and only the flow can "
                    "spoil it; the hierarchy uses the same scheme (method 3) and the same weights. Grey values 40, "
                    "100, 160, 220; Δt = 0.1.",
                    {},
                    {},
                    {},
                    {}};
  if (settings.progress) settings.progress("two level sets against the hierarchy");
  junctions(study, settings.quick);
  if (settings.progress) settings.progress("layers, norms");
  layers(study, settings.quick);
  norms(study, settings.quick);
  return study;
}

}  // namespace heartgen::study
