// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The parts of the report that hold pictures; empty where their data is missing.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "validation/report/report_html.hpp"
#include "validation/wall_fields.hpp"

namespace heartgen::report {

/// A section in order, in pieces of HTML that do not depend on each other: they may be made at the same time.
using Pieces = std::vector<std::function<std::string()>>;

/// The texts of all pieces one after the other, made on all threads; the same bytes for any number of them.
std::string joined(const Pieces& pieces);

/// What several pieces need of the meshes.
struct Shared {
  const validation::FacesOfMeshes* given_faces = nullptr;
  validation::FacesOfMeshes own_faces;        ///< where none are given
  std::vector<validation::WallField> fields;  ///< of the myocardium; none without one

  const validation::FacesOfMeshes& all_faces() const { return given_faces ? *given_faces : own_faces; }
  const std::vector<double>* helix_deg() const;  ///< per node of the myocardium; null without fibres
};

/// Refers to `input`.
Shared shared_by_pieces(const ReportInput& input);

// The pieces refer to `input` and `shared`.
Pieces viewer_section(const ReportInput& input, const Shared& shared);
Pieces slices_section(const ReportInput& input, const Shared& shared);
Pieces charts_section(const ReportInput& input, const Shared& shared);

}  // namespace heartgen::report
