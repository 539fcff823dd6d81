// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/parallel/slab.hpp"

#include <algorithm>
#include <cstring>

#include "generator/parallel/mpi_calls.hpp"

namespace heartgen::parallel {
namespace {

int owner(std::int64_t slice, std::int64_t slices, const Comm& comm) {
  for (int rank = 0; rank < comm.size; ++rank)
    if (slice < owned_slices(slices, comm, rank).end) return rank;
  return comm.size - 1;
}

/// Calls body(ghost, source) for every ghost slice of a rank: its position and the slice of the image that fills it.
template <class Body>
void for_ghosts(std::int64_t slices, std::int64_t ghosts, const SliceRange& own, Body&& body) {
  if (own.begin == own.end) return;
  const auto source = [&](std::int64_t k) { return std::clamp<std::int64_t>(k, 0, slices - 1); };
  for (auto k = own.begin - ghosts; k < own.begin; ++k) body(k, source(k));
  for (auto k = own.end; k < own.end + ghosts; ++k) body(k, source(k));
}

}  // namespace

SliceRange owned_slices(std::int64_t slices, const Comm& comm, int rank) {
  return {slices * rank / comm.size, slices * (rank + 1) / comm.size};
}

void exchange_halo_bytes(const Comm& comm, std::int64_t slices, std::int64_t ghosts, std::size_t slice_bytes,
                         void* slab_bytes, const std::function<void()>& meanwhile) {
  const auto own = owned_slices(slices, comm, comm.rank);
  const auto owns = [&](std::int64_t k) { return k >= own.begin && k < own.end; };
  const auto at = [&](std::int64_t k) {
    return static_cast<char*>(slab_bytes) + static_cast<std::size_t>(k - own.begin + ghosts) * slice_bytes;
  };
  // Both sides walk the receivers' ghosts in the same order; the ghost's position is the tag.
  std::vector<MPI_Request> requests;
  for_ghosts(slices, ghosts, own, [&](std::int64_t ghost, std::int64_t source) {
    if (owns(source)) {
      std::memcpy(at(ghost), at(source), slice_bytes);
      return;
    }
    MPI_Irecv(at(ghost), static_cast<int>(slice_bytes), MPI_BYTE, owner(source, slices, comm),
              static_cast<int>(ghost + ghosts), MPI_COMM_WORLD, &requests.emplace_back());
  });
  for (int rank = 0; rank < comm.size; ++rank) {
    if (rank == comm.rank) continue;
    for_ghosts(slices, ghosts, owned_slices(slices, comm, rank), [&](std::int64_t ghost, std::int64_t source) {
      if (owns(source))
        MPI_Isend(at(source), static_cast<int>(slice_bytes), MPI_BYTE, rank, static_cast<int>(ghost + ghosts),
                  MPI_COMM_WORLD, &requests.emplace_back());
    });
  }
  meanwhile();
  if (!requests.empty()) MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
}

void scatter_bytes(const Comm& comm, std::int64_t slices, std::size_t slice_bytes, const void* on_root, void* owned) {
  const auto mine = owned_slices(slices, comm, comm.rank);
  const auto count = static_cast<std::size_t>(mine.end - mine.begin) * slice_bytes;
  if (!comm.is_root()) return receive_bytes(0, owned, count);
  const auto* source = static_cast<const char*>(on_root);
  if (count) std::memcpy(owned, source, count);
  for (int rank = 1; rank < comm.size; ++rank) {
    const auto range = owned_slices(slices, comm, rank);
    send_bytes(rank, source + static_cast<std::size_t>(range.begin) * slice_bytes,
               static_cast<std::size_t>(range.end - range.begin) * slice_bytes);
  }
}

void gather_bytes(const Comm& comm, std::int64_t slices, std::size_t slice_bytes, const void* owned, void* on_root) {
  const auto mine = owned_slices(slices, comm, comm.rank);
  const auto count = static_cast<std::size_t>(mine.end - mine.begin) * slice_bytes;
  if (!comm.is_root()) return send_bytes(0, owned, count);
  auto* target = static_cast<char*>(on_root);
  if (count) std::memcpy(target, owned, count);
  for (int rank = 1; rank < comm.size; ++rank) {
    const auto range = owned_slices(slices, comm, rank);
    receive_bytes(rank, target + static_cast<std::size_t>(range.begin) * slice_bytes,
                  static_cast<std::size_t>(range.end - range.begin) * slice_bytes);
  }
}

}  // namespace heartgen::parallel
