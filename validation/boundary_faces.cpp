#include "validation/boundary_faces.hpp"

#include <algorithm>
#include <array>

namespace heart::validation {
namespace {

// Faces of a positive cell, outward by the right hand.
constexpr std::array<std::array<int, 3>, 4> cell_faces = {{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

struct Half {
  std::int32_t middle, high;  ///< the face's larger two node ids, ascending
  std::int32_t cell;
  std::int8_t corner;  ///< index into cell_faces
};

Face face_of(const Cell& cell, int corner) {
  const auto& f = cell_faces[static_cast<std::size_t>(corner)];
  return {cell[static_cast<std::size_t>(f[0])], cell[static_cast<std::size_t>(f[1])],
          cell[static_cast<std::size_t>(f[2])]};
}

/// All faces of all cells, bucketed by their smallest node: halves[start[n]] .. halves[start[n + 1]].
void bucket_faces(const TetMesh& mesh, std::vector<std::size_t>& start, std::vector<Half>& halves) {
  start.assign(mesh.nodes_mm.size() + 1, 0);
  for (const Cell& cell : mesh.cells)
    for (int k = 0; k < 4; ++k) {
      const Face f = face_of(cell, k);
      ++start[static_cast<std::size_t>(std::min({f[0], f[1], f[2]})) + 1];
    }
  for (std::size_t n = 1; n < start.size(); ++n) start[n] += start[n - 1];
  halves.resize(mesh.cells.size() * 4);
  auto next = start;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (int k = 0; k < 4; ++k) {
      Face f = face_of(mesh.cells[c], k);
      std::sort(f.begin(), f.end());
      halves[next[static_cast<std::size_t>(f[0])]++] = {f[1], f[2], static_cast<std::int32_t>(c),
                                                        static_cast<std::int8_t>(k)};
    }
}

}  // namespace

BoundaryFaces boundary_faces(const TetMesh& mesh, const std::vector<std::uint8_t>& chosen, bool per_region) {
  std::vector<std::size_t> start;
  std::vector<Half> halves;
  bucket_faces(mesh, start, halves);
  BoundaryFaces result;
  const auto add = [&](const Half& half, std::int32_t other) {
    result.faces.push_back(face_of(mesh.cells[static_cast<std::size_t>(half.cell)], half.corner));
    result.cell.push_back(half.cell);
    result.other.push_back(other);
  };
  const auto differs = [&](const Half& a, const Half& b) {
    const auto ca = static_cast<std::size_t>(a.cell), cb = static_cast<std::size_t>(b.cell);
    return !chosen[cb] || (per_region && mesh.region[ca] != mesh.region[cb]);
  };
  for (std::size_t n = 0; n + 1 < start.size(); ++n) {
    const auto first = halves.begin() + static_cast<std::ptrdiff_t>(start[n]);
    const auto last = halves.begin() + static_cast<std::ptrdiff_t>(start[n + 1]);
    std::sort(first, last, [](const Half& a, const Half& b) {
      return a.middle != b.middle ? a.middle < b.middle : a.high != b.high ? a.high < b.high : a.cell < b.cell;
    });
    for (auto a = first; a != last;) {
      const auto b = a + 1;
      const bool paired = b != last && a->middle == b->middle && a->high == b->high;
      if (paired) {
        if (chosen[static_cast<std::size_t>(a->cell)] && differs(*a, *b)) add(*a, b->cell);
        if (chosen[static_cast<std::size_t>(b->cell)] && differs(*b, *a)) add(*b, a->cell);
      } else if (chosen[static_cast<std::size_t>(a->cell)]) {
        add(*a, -1);
      }
      a += paired ? 2 : 1;
    }
  }
  return result;
}

}  // namespace heart::validation
