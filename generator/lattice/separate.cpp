#include "generator/lattice/separate.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "generator/parallel/threads.hpp"
#include "model/face_tree.hpp"
#include "model/sort_unique.hpp"

namespace heart::lattice {
namespace {

// Outer faces, seen from outside anticlockwise. Those in a side of the box have nothing beyond them.
std::vector<Face> outer_faces(const Complex& c) {
  constexpr std::array<std::array<std::size_t, 3>, 4> opposite{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};
  std::vector<Face> faces;
  for (const auto& cell : c.cells) {
    if (cell[0] < 0) continue;
    for (const auto& corners : opposite) {
      const Face face{cell[corners[0]], cell[corners[1]], cell[corners[2]]};
      const LabelBits shared = c.bits(face[0]) & c.bits(face[1]) & c.bits(face[2]);
      if ((shared & bit_of(0)) != 0 && (shared & side_bits) == 0 && cells_at_face(c, face[0], face[1], face[2])[1] < 0)
        faces.push_back(face);
    }
  }
  return faces;
}

// Whether some material lies less than an edge in front of the face: only there another sheet can come near.
bool is_before_material(const Complex& c, const Materials& materials, const Face& face) {
  const Vec3 a = c.at(face[0]), b = c.at(face[1]), d = c.at(face[2]);
  const Vec3 center = (a + b + d) / 3, normal = normalized(cross(b - a, d - a));
  const double edge = (norm(b - a) + norm(d - b) + norm(a - d)) / 3;
  constexpr std::array ways{0.2, 0.4, 0.6, 0.8};
  return std::any_of(ways.begin(), ways.end(),
                     [&](double way) { return materials.label_at(center + way * edge * normal) != 0; });
}

std::vector<Face> narrow_faces(const Complex& c, const Materials& materials) {
  const auto faces = outer_faces(c);
  std::vector<std::uint8_t> is_narrow(faces.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(faces.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto f = static_cast<std::size_t>(begin); f < static_cast<std::size_t>(end); ++f)
      is_narrow[f] = is_before_material(c, materials, faces[f]);
  });
  std::vector<Face> narrow;
  for (std::size_t f = 0; f < faces.size(); ++f)
    if (is_narrow[f] != 0) narrow.push_back(faces[f]);
  return narrow;
}

double volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) { return dot(b - a, cross(c - a, d - a)); }

bool goes_through(const Vec3& from, const Vec3& to, const Triangle& t) {
  const double at_from = volume(t[0], t[1], t[2], from), at_to = volume(t[0], t[1], t[2], to);
  if ((at_from > 0 && at_to > 0) || (at_from < 0 && at_to < 0)) return false;
  const double a = volume(from, to, t[0], t[1]), b = volume(from, to, t[1], t[2]), c = volume(from, to, t[2], t[0]);
  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

// Whether an edge of `a` that has no node of `b` goes through `b`.
bool pierces(const Complex& c, const Face& a, const Face& b) {
  const Triangle t{c.at(b[0]), c.at(b[1]), c.at(b[2])};
  const auto is_shared = [&](std::int32_t n) { return n == b[0] || n == b[1] || n == b[2]; };
  for (std::size_t i = 0; i < 3; ++i) {
    const auto from = a[i], to = a[(i + 1) % 3];
    if (!is_shared(from) && !is_shared(to) && goes_through(c.at(from), c.at(to), t)) return true;
  }
  return false;
}

using Pair = std::pair<std::int32_t, std::int32_t>;

std::vector<Pair> meeting_faces(const Complex& c, const std::vector<Face>& faces) {
  const auto tree = make_face_tree(c.nodes_mm, faces);
  std::vector<std::vector<std::int32_t>> partners(faces.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(faces.size()), [&](std::int64_t begin, std::int64_t end) {
    std::vector<std::int32_t> near;
    for (auto f = static_cast<std::size_t>(begin); f < static_cast<std::size_t>(end); ++f) {
      Vec3 low = c.at(faces[f][0]), high = low;
      for (const auto n : faces[f])
        for (int axis = 0; axis < 3; ++axis) {
          low[axis] = std::min(low[axis], c.at(n)[axis]);
          high[axis] = std::max(high[axis], c.at(n)[axis]);
        }
      near.clear();
      faces_in_box(tree, low, high, near);
      for (const auto other : near) {
        const auto& second = faces[static_cast<std::size_t>(other)];
        if (static_cast<std::size_t>(other) > f && (pierces(c, faces[f], second) || pierces(c, second, faces[f])))
          partners[f].push_back(other);
      }
      std::sort(partners[f].begin(), partners[f].end());
    }
  });
  std::vector<Pair> pairs;
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (const auto other : partners[f]) pairs.emplace_back(static_cast<std::int32_t>(f), other);
  return pairs;
}

// Nodes of the faces that meet others, each once, and the mean direction out of the mesh there.
std::vector<std::pair<std::int32_t, Vec3>> ways_out(const Complex& c, const std::vector<Face>& faces,
                                                    const std::vector<Pair>& pairs) {
  std::vector<std::int32_t> nodes;
  for (const auto& [one, other] : pairs)
    for (const auto f : {one, other})
      for (const auto n : faces[static_cast<std::size_t>(f)]) nodes.push_back(n);
  sort_unique(nodes);
  std::vector<std::pair<std::int32_t, Vec3>> ways;
  ways.reserve(nodes.size());
  for (const auto n : nodes) ways.emplace_back(n, Vec3{});
  for (const auto& face : faces) {
    const Vec3 normal = cross(c.at(face[1]) - c.at(face[0]), c.at(face[2]) - c.at(face[0]));
    for (const auto n : face) {
      const auto found = std::lower_bound(nodes.begin(), nodes.end(), n);
      if (found != nodes.end() && *found == n) ways[static_cast<std::size_t>(found - nodes.begin())].second += normal;
    }
  }
  return ways;
}

void draw_back(Complex& c, std::int32_t node, const Vec3& way_out, double least_quality) {
  constexpr double most_shift = 0.06;  // of the lattice's width
  constexpr int tries = 4;
  if (c.is_frozen(node) || (c.bits(node) & side_bits) != 0 || dot(way_out, way_out) == 0) return;
  const double length = most_shift * static_cast<double>(c.spacing_mm[static_cast<std::size_t>(node)]);
  shift_node(c, node, -length * normalized(way_out), tries, least_quality);
}

}  // namespace

std::int64_t separate_sheets(Complex& complex, const Materials& materials, double least_quality) {
  constexpr int most_rounds = 8;
  const auto faces = narrow_faces(complex, materials);
  for (int round = 0;; ++round) {
    const auto pairs = meeting_faces(complex, faces);
    if (pairs.empty() || round == most_rounds) return static_cast<std::int64_t>(pairs.size());
    for (const auto& [node, way] : ways_out(complex, faces, pairs)) draw_back(complex, node, way, least_quality);
  }
}

}  // namespace heart::lattice
