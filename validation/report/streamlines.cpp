// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/report/streamlines.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace heartgen::report {
namespace {

/// Cells by the cubes of a regular grid that their boxes touch.
struct CellBins {
  Vec3 low;
  double size_mm = 4;
  std::array<std::int64_t, 3> count{1, 1, 1};
  std::vector<std::size_t> start;
  std::vector<std::int32_t> cells;

  std::int64_t coordinate(double value, int axis) const {
    return std::clamp<std::int64_t>(static_cast<std::int64_t>(std::floor((value - low[axis]) / size_mm)), 0,
                                    count[static_cast<std::size_t>(axis)] - 1);
  }
  std::size_t bin(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return static_cast<std::size_t>((k * count[1] + j) * count[0] + i);
  }
};

template <class Visit>
void for_bins_of(const CellBins& bins, const TetMesh& mesh, const Cell& cell, Visit visit) {
  std::array<std::int64_t, 3> first{}, last{};
  for (int a = 0; a < 3; ++a) {
    double low = 1e300, high = -1e300;
    for (const auto n : cell) {
      low = std::min(low, mesh.nodes_mm[static_cast<std::size_t>(n)][a]);
      high = std::max(high, mesh.nodes_mm[static_cast<std::size_t>(n)][a]);
    }
    first[static_cast<std::size_t>(a)] = bins.coordinate(low, a);
    last[static_cast<std::size_t>(a)] = bins.coordinate(high, a);
  }
  for (auto k = first[2]; k <= last[2]; ++k)
    for (auto j = first[1]; j <= last[1]; ++j)
      for (auto i = first[0]; i <= last[0]; ++i) visit(bins.bin(i, j, k));
}

CellBins make_bins(const TetMesh& mesh) {
  CellBins bins;
  Vec3 high{-1e300, -1e300, -1e300};
  bins.low = {1e300, 1e300, 1e300};
  for (const Vec3& p : mesh.nodes_mm)
    for (int a = 0; a < 3; ++a) bins.low[a] = std::min(bins.low[a], p[a]), high[a] = std::max(high[a], p[a]);
  for (int a = 0; a < 3; ++a)
    bins.count[static_cast<std::size_t>(a)] =
        std::clamp<std::int64_t>(static_cast<std::int64_t>((high[a] - bins.low[a]) / bins.size_mm) + 1, 1, 256);
  bins.start.assign(static_cast<std::size_t>(bins.count[0] * bins.count[1] * bins.count[2]) + 1, 0);
  for (const Cell& cell : mesh.cells) for_bins_of(bins, mesh, cell, [&](std::size_t b) { ++bins.start[b + 1]; });
  for (std::size_t b = 1; b < bins.start.size(); ++b) bins.start[b] += bins.start[b - 1];
  bins.cells.resize(bins.start.back());
  auto next = bins.start;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for_bins_of(bins, mesh, mesh.cells[c],
                [&](std::size_t b) { bins.cells[next[b]++] = static_cast<std::int32_t>(c); });
  return bins;
}

/// Where a point lies: its cell and the weights of the four nodes; cell < 0 outside the mesh.
struct Place {
  std::int32_t cell = -1;
  std::array<double, 4> weight{};
};

bool try_cell(const TetMesh& mesh, std::int32_t c, const Vec3& p, Place& place) {
  const Cell& cell = mesh.cells[static_cast<std::size_t>(c)];
  std::array<Vec3, 4> d;
  for (std::size_t k = 0; k < 4; ++k) d[k] = mesh.nodes_mm[static_cast<std::size_t>(cell[k])] - p;
  const double w0 = dot(d[1], cross(d[2], d[3])), w1 = -dot(d[0], cross(d[2], d[3]));
  const double w2 = dot(d[0], cross(d[1], d[3])), w3 = -dot(d[0], cross(d[1], d[2]));
  const double sum = w0 + w1 + w2 + w3;
  constexpr double slack = -1e-9;
  if (sum <= 0 || std::min({w0, w1, w2, w3}) < slack * sum) return false;
  place = {c, {w0 / sum, w1 / sum, w2 / sum, w3 / sum}};
  return true;
}

Place locate(const CellBins& bins, const TetMesh& mesh, const Vec3& p, std::int32_t hint) {
  Place place;
  if (hint >= 0 && try_cell(mesh, hint, p, place)) return place;
  const auto b = bins.bin(bins.coordinate(p.x, 0), bins.coordinate(p.y, 1), bins.coordinate(p.z, 2));
  for (auto k = bins.start[b]; k < bins.start[b + 1]; ++k)
    if (try_cell(mesh, bins.cells[k], p, place)) return place;
  return place;
}

struct Tracer {
  const TetMesh& mesh;
  const CellBins& bins;
  const std::vector<double>& helix_deg;
  double step_mm;

  /// Unit fibre at p with the sign nearest to `heading`; zero outside the mesh or where there is no fibre.
  Vec3 axis_at(const Vec3& p, const Vec3& heading, Place& place) const {
    place = locate(bins, mesh, p, place.cell);
    if (place.cell < 0) return {};
    Vec3 sum;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto n = static_cast<std::size_t>(mesh.cells[static_cast<std::size_t>(place.cell)][k]);
      const Vec3& fiber = mesh.node_fibers.fiber[n];
      sum += (dot(fiber, heading) < 0 ? -place.weight[k] : place.weight[k]) * fiber;
    }
    return normalized(sum);
  }

  double helix_at(const Place& place) const {
    double value = 0, weight = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const double h = helix_deg[static_cast<std::size_t>(mesh.cells[static_cast<std::size_t>(place.cell)][k])];
      if (std::isfinite(h)) value += place.weight[k] * h, weight += place.weight[k];
    }
    return weight > 0 ? value / weight : std::numeric_limits<double>::quiet_NaN();
  }

  /// One way from p; stops where the mesh or the fibres end.
  void follow(Vec3 p, Vec3 heading, double length_mm, Streamline& line) const {
    Place place;
    for (int step = 0; step * step_mm < length_mm; ++step) {
      const Vec3 k1 = axis_at(p, heading, place);
      if (place.cell < 0 || dot(k1, k1) < 0.5) return;
      if (step > 0) {
        line.points_mm.push_back(p);
        line.helix_deg.push_back(helix_at(place));
      }
      const Vec3 k2 = axis_at(p + 0.5 * step_mm * k1, k1, place);
      const Vec3 k3 = axis_at(p + 0.5 * step_mm * k2, k1, place);
      const Vec3 k4 = axis_at(p + step_mm * k3, k1, place);
      const Vec3 mean = normalized(k1 + 2 * k2 + 2 * k3 + k4);
      if (dot(mean, mean) < 0.5) return;
      p += step_mm * mean;
      heading = mean;
    }
  }
};

}  // namespace

std::vector<std::int32_t> thinned_nodes(const TetMesh& mesh, const std::vector<std::uint8_t>& allowed,
                                        double spacing_mm) {
  std::vector<std::pair<std::array<std::int64_t, 3>, std::int32_t>> cubes;
  for (std::size_t n = 0; n < mesh.nodes_mm.size(); ++n) {
    if (!allowed[n]) continue;
    const Vec3& p = mesh.nodes_mm[n];
    const auto cube = [&](double v) { return static_cast<std::int64_t>(std::floor(v / spacing_mm)); };
    cubes.push_back({{cube(p.z), cube(p.y), cube(p.x)}, static_cast<std::int32_t>(n)});
  }
  std::sort(cubes.begin(), cubes.end());
  std::vector<std::int32_t> nodes;
  for (std::size_t i = 0; i < cubes.size(); ++i)
    if (i == 0 || cubes[i].first != cubes[i - 1].first) nodes.push_back(cubes[i].second);
  return nodes;
}

std::vector<Streamline> trace_fibers(const TetMesh& mesh, const std::vector<std::int32_t>& seeds,
                                     const std::vector<double>& helix_deg, const StreamlineSettings& settings) {
  const CellBins bins = make_bins(mesh);
  const Tracer tracer{mesh, bins, helix_deg, settings.step_mm};
  std::vector<Streamline> lines;
  for (const auto seed : seeds) {
    const Vec3& p = mesh.nodes_mm[static_cast<std::size_t>(seed)];
    const Vec3& fiber = mesh.node_fibers.fiber[static_cast<std::size_t>(seed)];
    if (dot(fiber, fiber) < 0.5) continue;
    Streamline back, line;
    line.seed = seed;
    tracer.follow(p, -fiber, settings.length_mm / 2, back);
    line.points_mm.assign(back.points_mm.rbegin(), back.points_mm.rend());
    line.helix_deg.assign(back.helix_deg.rbegin(), back.helix_deg.rend());
    line.points_mm.push_back(p);
    line.helix_deg.push_back(helix_deg[static_cast<std::size_t>(seed)]);
    tracer.follow(p, fiber, settings.length_mm / 2, line);
    if (line.points_mm.size() >= 3) lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace heartgen::report
