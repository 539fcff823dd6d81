// SPDX-License-Identifier: GPL-3.0-or-later
// Slices of the thorax with four tissues: angles, areas, names, and slices that are hard to mesh.
#include "generator/mesh/slice_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include "model/error.hpp"
#include "model/labels.hpp"

namespace {

using namespace heartgen;

/// One slice of square pixels, labelled by a function of the pixel.
LabelVolume slice_of(std::int64_t pixels, double spacing_mm,
                     const std::function<Region(std::int64_t, std::int64_t)>& region) {
  Grid grid;
  grid.size = {pixels, pixels, 1};
  grid.spacing_mm = {spacing_mm, spacing_mm, 2};
  LabelVolume labels(grid);
  for (std::int64_t j = 0; j < pixels; ++j)
    for (std::int64_t i = 0; i < pixels; ++i) labels(i, j, 0) = tag(region(i, j));
  return labels;
}

double radius(std::int64_t i, std::int64_t j, double x, double y) {
  return std::hypot(static_cast<double>(i) - x, static_cast<double>(j) - y);
}

/// A heart with a cavity and a vessel, two lungs, in a round body.
Region thorax(std::int64_t i, std::int64_t j) {
  if (radius(i, j, 30, 26) < 5) return Region::lv_blood;
  if (radius(i, j, 30, 26) < 9) return Region::lv_myocardium;
  if (radius(i, j, 36, 42) < 3) return Region::aorta;
  for (const double x : {15.0, 48.0})
    if (radius(i, j, x, 36) < 8) return Region::lung;
  return radius(i, j, 32, 32) < 29 ? Region::torso : Region::none;
}

double area_of(const TriMesh& mesh, const Face& t) {
  const auto& at = mesh.nodes_mm;
  const Vec3 a = at[static_cast<std::size_t>(t[0])];
  return 0.5 * cross(at[static_cast<std::size_t>(t[1])] - a, at[static_cast<std::size_t>(t[2])] - a).z;
}

std::map<std::string, double> areas_of(const TriMesh& mesh) {
  std::map<std::string, double> areas;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    areas[mesh.region_names.at(mesh.region[t])] += area_of(mesh, mesh.triangles[t]);
  return areas;
}

/// Area of the pixels of some regions.
double area_of(const LabelVolume& labels, std::initializer_list<Region> regions) {
  std::int64_t pixels = 0;
  for (const auto region : regions) pixels += std::count(labels.voxels.begin(), labels.voxels.end(), tag(region));
  return static_cast<double>(pixels) * labels.grid.spacing_mm.x * labels.grid.spacing_mm.y;
}

std::map<std::string, int> curves_of(const TriMesh& mesh) {
  std::map<std::string, int> curves;
  for (const auto curve : mesh.curve) ++curves[mesh.curve_names.at(curve)];
  return curves;
}

/// Positive triangles, at most two at an edge, and every edge listed that bounds the mesh or divides two tissues.
void expect_valid(const TriMesh& mesh) {
  std::map<std::pair<std::int32_t, std::int32_t>, std::vector<std::int32_t>> regions;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    EXPECT_GT(area_of(mesh, mesh.triangles[t]), 0) << t;
    for (std::size_t i = 0; i < 3; ++i)
      regions[std::minmax(mesh.triangles[t][i], mesh.triangles[t][(i + 1) % 3])].push_back(mesh.region[t]);
  }
  std::vector<std::pair<std::int32_t, std::int32_t>> listed, wanted;
  for (const auto& [a, b] : mesh.edges) listed.push_back(std::minmax(a, b));
  std::sort(listed.begin(), listed.end());
  for (const auto& [edge, sides] : regions) {
    EXPECT_LE(sides.size(), 2U);
    if (sides.size() == 1 || sides[0] != sides[1]) wanted.push_back(edge);
  }
  EXPECT_EQ(listed, wanted);
}

struct Meshed {
  TriMesh mesh;
  mesh::SliceReport report;
};

Meshed mesh_of(const LabelVolume& labels, double edge_mm = 1, double torso_edge_mm = 4) {
  mesh::SliceSettings settings;
  settings.edge_mm = edge_mm;
  settings.torso_edge_mm = torso_edge_mm;
  Meshed made;
  made.mesh = mesh::mesh_slice(labels, 0, settings, &made.report);
  expect_valid(made.mesh);
  EXPECT_EQ(made.report.outside_bounds, 0);
  EXPECT_GE(made.report.min_angle_deg, 28);
  EXPECT_LE(made.report.greatest_angle_deg, 120);
  return made;
}

TEST(SliceMesh, FourTissuesWithTheirNamesAreasAndCurves) {
  const auto labels = slice_of(64, 1.4, thorax);
  const auto made = mesh_of(labels);
  auto areas = areas_of(made.mesh);
  EXPECT_EQ(areas.size(), 4U);
  // Smoothing rounds the convex corners of stairs off.
  const auto expect_area = [&](const char* name, std::initializer_list<Region> regions) {
    EXPECT_NEAR(areas[name], area_of(labels, regions), 0.05 * area_of(labels, regions)) << name;
  };
  expect_area("heart_cavities", {Region::lv_blood, Region::aorta});
  expect_area("myocardium", {Region::lv_myocardium});
  expect_area("lungs", {Region::lung});
  expect_area("torso", {Region::torso});
  auto curves = curves_of(made.mesh);
  for (const auto* name : {"endocardium", "epicardium", "vessel_wall", "lung_surface", "skin"})
    EXPECT_GT(curves[name], 10) << name;
  EXPECT_EQ(curves.count("fov_cut"), 0U);
  for (const auto& [tag, name] : made.mesh.curve_names) EXPECT_FALSE(made.mesh.region_names.contains(tag)) << name;
  EXPECT_LE(made.report.distance_p99, 0.2);
}

TEST(SliceMesh, ABodyBeyondTheImageIsCutFlat) {
  const auto made = mesh_of(slice_of(40, 1.5, [](std::int64_t i, std::int64_t j) {
    if (i < 6) return Region::lung;
    return radius(i, j, 39, 20) < 7 ? Region::lv_myocardium : Region::torso;
  }));
  double area = 0;
  for (const auto& [name, part] : areas_of(made.mesh)) area += part;
  EXPECT_NEAR(area, 60.0 * 60.0, 1e-6);
  auto curves = curves_of(made.mesh);
  EXPECT_GT(curves["fov_cut"], 40);
  EXPECT_EQ(curves.count("skin"), 0U);
  for (const auto& [a, b] : made.mesh.edges)
    EXPECT_LE(norm(made.mesh.nodes_mm[static_cast<std::size_t>(a)] - made.mesh.nodes_mm[static_cast<std::size_t>(b)]),
              2 * 4.0);
}

TEST(SliceMesh, IslandsOfAPixelGoOrAreMeshed) {
  const auto labels = slice_of(48, 1.2, [](std::int64_t i, std::int64_t j) {
    const bool is_island = i % 9 == 4 && j % 7 == 3;
    if (radius(i, j, 24, 24) < 12) return is_island ? Region::lv_blood : Region::lv_myocardium;
    if (radius(i, j, 24, 24) < 22) return is_island ? Region::lung : Region::torso;
    return is_island ? Region::torso : Region::none;
  });
  const double heart = area_of(labels, {Region::lv_myocardium, Region::lv_blood});
  EXPECT_NEAR(areas_of(mesh_of(labels).mesh)["myocardium"], heart, 0.03 * heart);
}

TEST(SliceMesh, CurvesAPixelApartStayApart) {
  // A wall of one pixel around blood, and lungs a pixel from each other.
  const auto labels = slice_of(48, 1.2, [](std::int64_t i, std::int64_t j) {
    if (radius(i, j, 16, 16) < 8) return Region::lv_blood;
    if (radius(i, j, 16, 16) < 9) return Region::lv_myocardium;
    if (j > 28 && j < 44 && i > 4 && i < 44) return i == 24 ? Region::torso : Region::lung;
    return Region::torso;
  });
  const auto made = mesh_of(labels, 1.2);
  auto areas = areas_of(made.mesh);
  const double blood = area_of(labels, {Region::lv_blood}), wall = area_of(labels, {Region::lv_myocardium});
  EXPECT_NEAR(areas["heart_cavities"], blood, 0.05 * blood);
  EXPECT_NEAR(areas["myocardium"], wall, 0.15 * wall);
  EXPECT_LE(made.report.distance_p99, 0.3);
}

TEST(SliceMesh, OnePixelIsASmallMeshOrRefused) {
  const auto labels = slice_of(20, 1, [](auto i, auto j) { return i == 9 && j == 9 ? Region::lung : Region::none; });
  try {
    EXPECT_LE(areas_of(mesh_of(labels).mesh)["lungs"], 1.5);
  } catch (const UserError& error) {
    EXPECT_FALSE(error.remedy.empty());
  }
}

TEST(SliceMesh, TheSameSliceGivesTheSameBits) {
  const auto labels = slice_of(64, 1.4, thorax);
  const auto one = mesh_of(labels, 2).mesh, other = mesh_of(labels, 2).mesh;
  EXPECT_EQ(one.nodes_mm, other.nodes_mm);
  EXPECT_EQ(one.triangles, other.triangles);
}

TEST(SliceMesh, WhatCannotBeMeshedIsRefused) {
  const auto labels = slice_of(20, 1, [](std::int64_t, std::int64_t) { return Region::torso; });
  EXPECT_THROW(mesh::mesh_slice(labels, 1, {}), UserError);
  EXPECT_THROW(mesh::mesh_slice(labels, -1, {}), UserError);
  EXPECT_THROW(mesh::mesh_slice(slice_of(20, 1, [](auto, auto) { return Region::none; }), 0, {}), UserError);
  auto unknown = labels;
  unknown(3, 4, 0) = 99;
  EXPECT_THROW(mesh::mesh_slice(unknown, 0, {}), UserError);
  mesh::SliceSettings settings;
  settings.edge_mm = 0;
  EXPECT_THROW(mesh::mesh_slice(labels, 0, settings), UserError);
  settings.edge_mm = 1e-4;
  EXPECT_THROW(mesh::mesh_slice(slice_of(64, 1.4, thorax), 0, settings), UserError);
}

}  // namespace
