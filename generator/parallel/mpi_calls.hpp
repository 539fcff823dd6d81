// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: MPI calls for messages of any length.
#pragma once
#define OMPI_SKIP_MPICXX 1  // the deprecated C++ bindings, which need a library of their own
#define MPICH_SKIP_MPICXX 1
#include <mpi.h>

#include <algorithm>
#include <cstddef>

namespace heartgen::parallel {

/// MPI counts are ints: longer messages go in pieces of this many bytes.
inline constexpr std::size_t piece_bytes = std::size_t{1} << 30;

/// Calls body(pointer, count) for the pieces of a buffer, in order.
template <class Byte, class Body>
void for_pieces(Byte* bytes, std::size_t count, Body&& body) {
  for (std::size_t done = 0; done < count; done += piece_bytes)
    body(bytes + done, static_cast<int>(std::min(piece_bytes, count - done)));
}

}  // namespace heartgen::parallel
