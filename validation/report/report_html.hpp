// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The report of a bundle as one HTML file that needs nothing else: pictures, charts, a 3D view to turn and cut, and
/// every row of the certificate. The same input gives the same bytes: no times, no paths, no network.
#pragma once
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "model/certificate.hpp"
#include "model/tet_mesh.hpp"
#include "model/volume.hpp"
#include "validation/fiber_checks.hpp"
#include "validation/mesh_topology.hpp"

namespace heartgen::report {

struct ReportInput {
  std::string name;
  std::string version;
  const CtVolume* ct = nullptr;                            ///< null when re-made from a bundle
  const LabelVolume* labels = nullptr;                     ///< null: no slices
  const std::map<std::string, TetMesh>* meshes = nullptr;  ///< "myocardium", "torso", ...; null: none
  const validation::FacesOfMeshes* faces = nullptr;        ///< of these meshes; null: found here
  const Certificate* certificate = nullptr;                ///< null: nothing was judged

  validation::HelixProfile atlas_lv, atlas_rv;  ///< of the atlas itself; empty: not known
  std::string atlas_name;
  std::vector<std::pair<std::string, std::string>> inputs;  ///< file name, SHA-256
  std::vector<std::pair<std::string, std::string>> tools;   ///< library, version
};

/// UTF-8 text of the HTML file.
std::string make_report(const ReportInput& input);

}  // namespace heartgen::report
