#include "generator/lattice/quality.hpp"

namespace heart::lattice {
namespace {

HEART_LATTICE_VECTOR void rate(const CellBatch& c, double* quality) {
  for (std::size_t i = 0; i < CellBatch::size; ++i)
    quality[i] = cell_quality({c.x[0][i], c.y[0][i], c.z[0][i]}, {c.x[1][i], c.y[1][i], c.z[1][i]},
                              {c.x[2][i], c.y[2][i], c.z[2][i]}, {c.x[3][i], c.y[3][i], c.z[3][i]});
}

}  // namespace

std::array<double, CellBatch::size> cell_qualities(const CellBatch& cells) {
  std::array<double, CellBatch::size> quality;
  rate(cells, quality.data());
  return quality;
}

}  // namespace heart::lattice
