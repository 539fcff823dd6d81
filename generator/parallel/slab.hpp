// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A z-slab of an image: the contiguous slices that one rank owns, with ghost slices on both sides.
/// i runs fastest, so slices are contiguous and a halo exchange copies whole slices. A 2D image is one slice. Ranks may
/// own no slice at all (more ranks than slices): then `count` is 0 and there are no values.
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "generator/parallel/comm.hpp"
#include "generator/parallel/memory.hpp"
#include "generator/parallel/threads.hpp"
#include "model/volume.hpp"

namespace heartgen::parallel {

template <class T>
struct Slab {
  Grid grid;                ///< of the whole image
  std::int64_t first = 0;   ///< first owned slice
  std::int64_t count = 0;   ///< owned slices
  std::int64_t ghosts = 0;  ///< ghost slices on each side; beyond the image they repeat its border slice
  Pages<T> values;          ///< (ghosts + count + ghosts) slices, empty where count is 0

  std::int64_t slice_size() const { return grid.size[0] * grid.size[1]; }
  std::int64_t end() const { return first + count; }

  /// Row j of slice k, both global; k from first - ghosts to end() + ghosts - 1.
  T* row(std::int64_t j, std::int64_t k) { return values.data() + offset(j, k); }
  const T* row(std::int64_t j, std::int64_t k) const { return values.data() + offset(j, k); }
  T* slice(std::int64_t k) { return row(0, k); }
  const T* slice(std::int64_t k) const { return row(0, k); }

  std::span<T> owned() { return {values.data() + (count ? ghosts * slice_size() : 0), owned_size()}; }
  std::span<const T> owned() const { return {values.data() + (count ? ghosts * slice_size() : 0), owned_size()}; }

 private:
  std::int64_t offset(std::int64_t j, std::int64_t k) const {
    return ((k - first + ghosts) * grid.size[1] + j) * grid.size[0];
  }
  std::size_t owned_size() const { return static_cast<std::size_t>(count * slice_size()); }
};

/// Slices [begin, end) of a rank: shares differ by one slice at most.
struct SliceRange {
  std::int64_t begin = 0, end = 0;
};
SliceRange owned_slices(std::int64_t slices, const Comm& comm, int rank);

/// A slab of this rank's share of the grid, filled with one value. Not collective.
template <class T>
Slab<T> make_slab(const Grid& grid, const Comm& comm, std::int64_t ghosts, T value = T{}) {
  const auto range = owned_slices(grid.size[2], comm, comm.rank);
  Slab<T> slab{grid, range.begin, range.end - range.begin, ghosts, {}};
  if (slab.count) slab.values.assign(static_cast<std::size_t>((slab.count + 2 * ghosts) * slab.slice_size()), value);
  return slab;
}

/// A slab with the same shares as `like`.
template <class T, class U>
Slab<T> make_slab_like(const Slab<U>& like, std::int64_t ghosts, T value = T{}) {
  Slab<T> slab{like.grid, like.first, like.count, ghosts, {}};
  if (slab.count) slab.values.assign(static_cast<std::size_t>((slab.count + 2 * ghosts) * slab.slice_size()), value);
  return slab;
}

/// Byte versions of the functions below; `slab_bytes` points at the first ghost slice.
void exchange_halo_bytes(const Comm& comm, std::int64_t slices, std::int64_t ghosts, std::size_t slice_bytes,
                         void* slab_bytes, const std::function<void()>& meanwhile);
void scatter_bytes(const Comm& comm, std::int64_t slices, std::size_t slice_bytes, const void* on_root, void* owned);
void gather_bytes(const Comm& comm, std::int64_t slices, std::size_t slice_bytes, const void* owned, void* on_root);

/// Fills the ghost slices from the ranks that own them; beyond the image they repeat its border slice (homogeneous
/// Neumann). `meanwhile` works while the slices travel: it neither reads ghost slices nor writes to the slab.
/// @collective
template <class T>
void exchange_halo(
    Slab<T>& slab, const Comm& comm, const std::function<void()>& meanwhile = [] {}) {
  if (slab.ghosts == 0) return meanwhile();
  exchange_halo_bytes(comm, slab.grid.size[2], slab.ghosts, static_cast<std::size_t>(slab.slice_size()) * sizeof(T),
                      slab.values.data(), meanwhile);
}

/// Some rows of some slices, ghost slices included; both ends exclusive, both global.
struct RowBlock {
  std::int64_t first_row = 0, end_row = 0;
  std::int64_t first_slice = 0, end_slice = 0;
};

/// Rows from one rank's slab to another's; a receive for each send, in the same order. Not collective.
template <class T>
void send_rows(const Slab<T>& slab, int to, const RowBlock& block) {
  for (auto k = block.first_slice; k < block.end_slice; ++k)
    send_bytes(to, slab.row(block.first_row, k),
               static_cast<std::size_t>((block.end_row - block.first_row) * slab.grid.size[0]) * sizeof(T));
}
template <class T>
void receive_rows(Slab<T>& slab, int from, const RowBlock& block) {
  for (auto k = block.first_slice; k < block.end_slice; ++k)
    receive_bytes(from, slab.row(block.first_row, k),
                  static_cast<std::size_t>((block.end_row - block.first_row) * slab.grid.size[0]) * sizeof(T));
}

/// Divides the root's image among the ranks, ghost slices filled. @collective
template <class T>
Slab<T> scatter(const Volume<T>& on_root, const Comm& comm, std::int64_t ghosts = 1) {
  Grid grid = on_root.grid;
  broadcast(comm, grid);
  Slab<T> slab = make_slab<T>(grid, comm, ghosts);
  scatter_bytes(comm, grid.size[2], static_cast<std::size_t>(slab.slice_size()) * sizeof(T), on_root.voxels.data(),
                slab.owned().data());
  exchange_halo(slab, comm);
  return slab;
}

/// The whole image on the root, an empty volume elsewhere. @collective
template <class T>
Volume<T> gather(const Slab<T>& slab, const Comm& comm) {
  Volume<T> result;
  if (comm.is_root()) result = Volume<T>(slab.grid);
  gather_bytes(comm, slab.grid.size[2], static_cast<std::size_t>(slab.slice_size()) * sizeof(T), slab.owned().data(),
               result.voxels.data());
  return result;
}

/// Calls body(j, k) for every row of some slices (j, k global), rows divided among the threads.
template <class T, class Body>
void for_rows(const Slab<T>& slab, const SliceRange& slices, Body&& body) {
  const auto rows = slab.grid.size[1];
  parallel_for(slices.begin * rows, slices.end * rows, [&](std::int64_t begin, std::int64_t end) {
    for (auto row = begin; row < end; ++row) body(row % rows, row / rows);
  });
}

/// The same for every owned row.
template <class T, class Body>
void for_rows(const Slab<T>& slab, Body&& body) {
  for_rows(slab, SliceRange{slab.first, slab.end()}, body);
}

/// The sum over the image of row_sum(j, k), a double per row: added row by row, then slice by slice, so it has the
/// same bits for any number of ranks and threads. @collective
template <class T, class RowSum>
double sum_rows(const Slab<T>& slab, const Comm& comm, RowSum&& row_sum) {
  const auto rows = slab.grid.size[1];
  std::vector<double> per_row(static_cast<std::size_t>(slab.count * rows));
  for_rows(slab, [&](std::int64_t j, std::int64_t k) {
    per_row[static_cast<std::size_t>((k - slab.first) * rows + j)] = row_sum(j, k);
  });
  std::vector<double> per_slice(static_cast<std::size_t>(slab.count), 0.0);
  for (std::size_t k = 0; k < per_slice.size(); ++k)
    for (std::size_t j = 0; j < static_cast<std::size_t>(rows); ++j)
      per_slice[k] += per_row[k * static_cast<std::size_t>(rows) + j];
  return sum_by_slice(comm, per_slice);
}

}  // namespace heartgen::parallel
