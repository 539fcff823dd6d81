// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/anatomy_checks.hpp"

#include <algorithm>
#include <array>

#include "model/labels.hpp"

namespace heartgen::validation {
namespace {

struct Orifice {
  const char* surface;
  Region upstream, downstream;
};

constexpr std::array<Orifice, 4> orifices = {{{"mitral_orifice", Region::la_blood, Region::lv_blood},
                                              {"aortic_orifice", Region::lv_blood, Region::aorta},
                                              {"tricuspid_orifice", Region::ra_blood, Region::rv_blood},
                                              {"pulmonary_orifice", Region::rv_blood, Region::pulmonary_artery}}};

double area_cm2(const TetMesh& mesh, const std::string& surface) {
  const auto tag = surface_from_name(surface);
  double area_mm2 = 0;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (mesh.surface[f] != tag) continue;
    const auto at = [&](std::size_t i) { return mesh.nodes_mm[static_cast<std::size_t>(mesh.faces[f][i])]; };
    area_mm2 += norm(cross(at(1) - at(0), at(2) - at(0))) / 2;
  }
  return area_mm2 / 100;
}

const TetMesh* mesh_of_blood(const std::map<std::string, TetMesh>& meshes) {
  for (const char* name : {"chambers", "torso"})
    if (const auto found = meshes.find(name); found != meshes.end()) return &found->second;
  return nullptr;
}

}  // namespace

Report check_orifices(const std::map<std::string, TetMesh>& meshes, const LabelVolume& labels) {
  std::array<bool, 256> present{};
  for (const auto label : labels.voxels) present[label] = true;
  const auto holds = [&](Region region) { return present[static_cast<std::size_t>(tag(region))]; };
  const TetMesh* blood = mesh_of_blood(meshes);
  Report report;
  for (const auto& orifice : orifices) {
    const std::string scope = orifice.surface;
    const bool exists = holds(orifice.upstream) && holds(orifice.downstream);
    report.push_back({"anatomy", scope, "missing", exists ? 0.0 : 1.0, "count", {}, {}});
    if (exists && blood != nullptr)
      report.push_back({"anatomy", scope, "area", area_cm2(*blood, scope), "cm2", {}, {}});
  }
  return report;
}

}  // namespace heartgen::validation
