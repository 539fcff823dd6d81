// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Processes that work on one image together. MPI stays behind this header: a Comm of size 1 never calls MPI, so that
/// serial programs and tests need no launcher and no initialisation.
///
/// Every function that takes a Comm is @collective: all ranks call it, in the same order. Sums are exact (integers) or
/// added in a fixed order (slices), so results do not depend on the number of ranks.
#pragma once
#include <cstddef>
#include <cstdint>
#include <exception>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace heartgen::parallel {

/// All processes of the launch (size > 1), or this process alone (size 1).
struct Comm {
  int rank = 0;
  int size = 1;
  bool is_root() const { return rank == 0; }
};

/// This process alone.
inline Comm self() { return {}; }

/// All processes of the launch; the same as self() without a live Environment or outside of mpirun.
Comm world();

/// Starts MPI when the process was launched by mpirun (or a compatible launcher), and ends it. One per program, first
/// thing in main. When an exception leaves main's scope through it, all ranks are aborted rather than left waiting.
struct Environment {
  Environment(int* argc, char*** argv);
  ~Environment();
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  bool started_ = false;
  int exceptions_ = 0;
};

/// Copies the root's bytes into everybody's buffer of the same size. Any size. @collective
void broadcast_bytes(const Comm& comm, void* bytes, std::size_t count);

/// The root's value for everybody. @collective
template <class T>
requires std::is_trivially_copyable_v<T>
void broadcast(const Comm& comm, T& value) { broadcast_bytes(comm, &value, sizeof(T)); }

template <class T>
requires std::is_trivially_copyable_v<T>
void broadcast(const Comm& comm, std::vector<T>& values) {
  std::uint64_t count = values.size();
  broadcast(comm, count);
  values.resize(count);
  broadcast_bytes(comm, values.data(), count * sizeof(T));
}

void broadcast(const Comm& comm, std::string& text);
void broadcast(const Comm& comm, std::vector<std::string>& texts);

/// From one rank to another, of any size; the send may wait for the receive. Not collective.
void send_bytes(int to, const void* bytes, std::size_t count);
void receive_bytes(int from, void* bytes, std::size_t count);

/// Waits for everybody. @collective
void barrier(const Comm& comm);

/// Largest value over all ranks. @collective
double max(const Comm& comm, double value);
/// Smallest value over all ranks. @collective
double min(const Comm& comm, double value);

/// Exact sums over all ranks; the span is summed element by element in place (histograms). @collective
std::int64_t sum_int64(const Comm& comm, std::int64_t value);
void sum_int64(const Comm& comm, std::span<std::int64_t> values);

/// The sum of one number per slice of an image that is divided into slabs: every rank gives the numbers of the slices
/// it owns, in order (possibly none). They are added in slice order on every rank, so the result has the same bits
/// for any number of ranks. @collective
double sum_by_slice(const Comm& comm, std::span<const double> owned_slice_sums);

/// Ends a piece of work that only the root did: throws the root's error on every rank. On the other ranks a UserError
/// arrives as the same UserError, anything else as std::runtime_error with the same message. @collective
void share_outcome(const Comm& comm, const std::exception_ptr& error_on_root);

/// Runs `work` on the root only. Returns its result there and a default-constructed one elsewhere; when it throws,
/// every rank throws the same error, so that nobody waits for a rank that has given up. @collective
template <class Work>
auto run_on_root(const Comm& comm, Work&& work) {
  using Result = std::invoke_result_t<Work>;
  std::exception_ptr error;
  if constexpr (std::is_void_v<Result>) {
    try {
      if (comm.is_root()) work();
    } catch (...) {
      error = std::current_exception();
    }
    share_outcome(comm, error);
  } else {
    Result result{};
    try {
      if (comm.is_root()) result = work();
    } catch (...) {
      error = std::current_exception();
    }
    share_outcome(comm, error);
    return result;
  }
}

}  // namespace heartgen::parallel
