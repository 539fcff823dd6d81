// SPDX-License-Identifier: AGPL-3.0-or-later
#include "generator/tetgen_helper/fill.hpp"

#define TETLIBRARY
#include <fmt/format.h>
#include <tetgen.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "generator/adapters/tetgen_exchange.hpp"
#include "model/volume.hpp"

namespace heartgen::tetgen_helper {
namespace {

using adapters::FillAnswer;
using adapters::FillTask;
using adapters::SurfaceComplex;

const std::array<std::pair<int, const char*>, 5> meanings{{{1, "out of memory"},
                                                           {3, "surfaces cross each other"},
                                                           {4, "a detail of the surfaces is too small"},
                                                           {5, "two faces lie too close to each other"},
                                                           {10, "the surfaces are not a complex"}}};

/// What TetGen's question about a cell needs: it is a bare function without a context.
const FillTask* asked = nullptr;

bool is_too_large(REAL* a, REAL* b, REAL* c, REAL* d, REAL* /*elen*/, REAL /*volume*/) {
  const Vec3 p{a[0], a[1], a[2]}, q{b[0], b[1], b[2]}, r{c[0], c[1], c[2]}, s{d[0], d[1], d[2]};
  const double volume = std::abs(dot(q - p, cross(r - p, s - p))) / 6;
  const auto& edges = asked->edges_mm;
  const double edge = sample_linear(edges, index_from_lps(edges.grid, 0.25 * (p + q + r + s)));
  return volume > asked->settings.volume_share * edge * edge * edge;
}

/// The arrays of the input belong to this struct, not to TetGen, which frees what its own struct names.
struct Input {
  std::vector<double> coordinates, regions;
  std::vector<int> corners, markers;
  std::vector<tetgenio::polygon> polygons;
  std::vector<tetgenio::facet> facets;
  tetgenio io;

  explicit Input(const SurfaceComplex& surfaces) {
    for (const auto& p : surfaces.nodes_mm) coordinates.insert(coordinates.end(), {p.x, p.y, p.z});
    for (const auto& seed : surfaces.seeds)
      regions.insert(regions.end(),
                     {seed.point_mm.x, seed.point_mm.y, seed.point_mm.z, static_cast<double>(seed.label), 0.0});
    for (const auto& face : surfaces.faces) corners.insert(corners.end(), face.begin(), face.end());
    const std::size_t count = surfaces.faces.size();
    polygons.resize(count);
    facets.resize(count);
    markers.assign(count, 1);
    for (std::size_t f = 0; f < count; ++f) {
      polygons[f] = {corners.data() + 3 * f, 3};
      facets[f] = {polygons.data() + f, 1, nullptr, 0};
    }
    io.firstnumber = 0;
    io.pointlist = coordinates.data();
    io.numberofpoints = static_cast<int>(surfaces.nodes_mm.size());
    io.regionlist = regions.data();
    io.numberofregions = static_cast<int>(surfaces.seeds.size());
    io.facetlist = facets.data();
    io.facetmarkerlist = markers.data();
    io.numberoffacets = static_cast<int>(count);
    io.tetunsuitable = &is_too_large;
  }
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;
  ~Input() { io.initialize(); }  // forgets the arrays: nothing is left to free
};

FillAnswer answer_of(const tetgenio& output) {
  FillAnswer answer;
  if (output.numberofcorners != 4 || output.numberoftetrahedronattributes < 1) return {"no labels", {}, {}, {}};
  for (int n = 0; n < output.numberofpoints; ++n) {
    const double* p = output.pointlist + 3 * n;
    answer.nodes_mm.push_back({p[0], p[1], p[2]});
  }
  for (int c = 0; c < output.numberoftetrahedra; ++c) {
    const int* n = output.tetrahedronlist + 4 * c;
    answer.cells.push_back({n[0], n[1], n[2], n[3]});
    const int attributes = output.numberoftetrahedronattributes;
    answer.label.push_back(
        static_cast<std::int32_t>(std::lround(output.tetrahedronattributelist[attributes * (c + 1) - 1])));
  }
  return answer;
}

std::string meaning_of(int error) {
  const auto known = std::find_if(meanings.begin(), meanings.end(), [&](const auto& m) { return m.first == error; });
  return known != meanings.end() ? known->second : fmt::format("internal error {}", error);
}

/// Throws std::runtime_error: TetGen itself believes what it is given.
void check(const FillTask& task) {
  const auto count = static_cast<std::int64_t>(task.surfaces.nodes_mm.size());
  const auto& grid = task.edges_mm.grid;
  for (const auto& face : task.surfaces.faces)
    for (const auto n : face)
      if (n < 0 || n >= count) throw std::runtime_error("names a node that it does not have");
  if (grid.voxel_count() < 1 || static_cast<std::int64_t>(task.edges_mm.voxels.size()) != grid.voxel_count())
    throw std::runtime_error("has no edge lengths");
}

}  // namespace

FillAnswer fill(const FillTask& task) {
  Input input(task.surfaces);
  asked = &task;
  // p: given surfaces, Y: their triangles stay, M: coplanar ones too, A: labels, q: quality, Q: quiet.
  auto switches = fmt::format("pYMAq{}/{}Q", task.settings.radius_edge_ratio, task.settings.min_angle_deg);
  tetgenbehavior behaviour;
  tetgenio output;
  if (!behaviour.parse_commandline(switches.data())) return {"refuses its settings", {}, {}, {}};
  try {
    tetrahedralize(&behaviour, &input.io, &output);
  } catch (const int error) {
    return {meaning_of(error), {}, {}, {}};
  }
  return answer_of(output);
}

int answer_task(std::FILE* input, std::FILE* output, std::FILE* printed) {
  try {
    const auto task = adapters::read_exchange<FillTask>(input);
    check(task);
    adapters::write_exchange(output, fill(task));
    return 0;
  } catch (const std::exception& error) {
    fmt::print(printed, "the task {}\n", error.what());
    return 2;
  }
}

}  // namespace heartgen::tetgen_helper
