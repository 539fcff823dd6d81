// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/parallel/comm.hpp"

#include <array>
#include <cstdlib>
#include <stdexcept>

#include "generator/parallel/mpi_calls.hpp"
#include "model/error.hpp"

namespace heartgen::parallel {
namespace {

/// What Open MPI, MPICH and its relatives, and PMIx launchers set for their processes.
constexpr std::array launcher_variables{"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_SIZE", "PMI_RANK", "MPI_LOCALNRANKS"};

bool launched_by_mpi() {
  for (const char* name : launcher_variables)
    if (std::getenv(name)) return true;
  return false;
}

bool mpi_is_live() {
  int started = 0, ended = 0;
  MPI_Initialized(&started);
  MPI_Finalized(&ended);
  return started && !ended;
}

/// MPI prints and aborts on a failed call (its default error handler), so return codes carry nothing.
double reduce(const Comm& comm, double value, MPI_Op operation) {
  if (comm.size > 1) MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, operation, MPI_COMM_WORLD);
  return value;
}

struct Outcome {
  enum Kind : int { done, user_error, defect } kind = done;
  std::vector<std::string> texts;
};

Outcome describe(const std::exception_ptr& error) {
  try {
    if (error) std::rethrow_exception(error);
    return {Outcome::done, {}};
  } catch (const UserError& user) {
    return {Outcome::user_error, {user.problem, user.where, user.remedy}};
  } catch (const std::exception& defect) {
    return {Outcome::defect, {defect.what()}};
  } catch (...) {
    return {Outcome::defect, {"unknown error"}};
  }
}

}  // namespace

Environment::Environment(int* argc, char*** argv) : exceptions_(std::uncaught_exceptions()) {
  if (!launched_by_mpi() || mpi_is_live()) return;
  int provided = 0;
  MPI_Init_thread(argc, argv, MPI_THREAD_FUNNELED, &provided);
  started_ = true;
}

Environment::~Environment() {
  if (!started_) return;
  if (std::uncaught_exceptions() > exceptions_) MPI_Abort(MPI_COMM_WORLD, 1);
  MPI_Finalize();
}

Comm world() {
  Comm comm;
  if (mpi_is_live()) {
    MPI_Comm_rank(MPI_COMM_WORLD, &comm.rank);
    MPI_Comm_size(MPI_COMM_WORLD, &comm.size);
  }
  return comm;
}

void broadcast_bytes(const Comm& comm, void* bytes, std::size_t count) {
  if (comm.size == 1) return;
  for_pieces(static_cast<char*>(bytes), count,
             [](char* piece, int length) { MPI_Bcast(piece, length, MPI_BYTE, 0, MPI_COMM_WORLD); });
}

void broadcast(const Comm& comm, std::string& text) {
  std::uint64_t count = text.size();
  broadcast(comm, count);
  text.resize(count);
  broadcast_bytes(comm, text.data(), count);
}

void broadcast(const Comm& comm, std::vector<std::string>& texts) {
  std::uint64_t count = texts.size();
  broadcast(comm, count);
  texts.resize(count);
  for (auto& text : texts) broadcast(comm, text);
}

void send_bytes(int to, const void* bytes, std::size_t count) {
  for_pieces(static_cast<const char*>(bytes), count,
             [&](const char* piece, int length) { MPI_Send(piece, length, MPI_BYTE, to, 0, MPI_COMM_WORLD); });
}

void receive_bytes(int from, void* bytes, std::size_t count) {
  for_pieces(static_cast<char*>(bytes), count, [&](char* piece, int length) {
    MPI_Recv(piece, length, MPI_BYTE, from, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  });
}

void barrier(const Comm& comm) {
  if (comm.size > 1) MPI_Barrier(MPI_COMM_WORLD);
}

double max(const Comm& comm, double value) { return reduce(comm, value, MPI_MAX); }
double min(const Comm& comm, double value) { return reduce(comm, value, MPI_MIN); }

std::int64_t sum_int64(const Comm& comm, std::int64_t value) {
  sum_int64(comm, std::span(&value, 1));
  return value;
}

void sum_int64(const Comm& comm, std::span<std::int64_t> values) {
  if (comm.size > 1)
    MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_INT64_T, MPI_SUM, MPI_COMM_WORLD);
}

double sum_by_slice(const Comm& comm, std::span<const double> owned_slice_sums) {
  std::vector<double> all(owned_slice_sums.begin(), owned_slice_sums.end());
  if (comm.size > 1) {
    const auto ranks = static_cast<std::size_t>(comm.size);
    const int own = static_cast<int>(owned_slice_sums.size());
    std::vector<int> counts(ranks), starts(ranks);
    MPI_Allgather(&own, 1, MPI_INT, counts.data(), 1, MPI_INT, MPI_COMM_WORLD);
    for (std::size_t r = 1; r < ranks; ++r) starts[r] = starts[r - 1] + counts[r - 1];
    all.resize(static_cast<std::size_t>(starts.back()) + static_cast<std::size_t>(counts.back()));
    MPI_Allgatherv(owned_slice_sums.data(), own, MPI_DOUBLE, all.data(), counts.data(), starts.data(), MPI_DOUBLE,
                   MPI_COMM_WORLD);
  }
  double sum = 0;
  for (const double value : all) sum += value;
  return sum;
}

void share_outcome(const Comm& comm, const std::exception_ptr& error_on_root) {
  Outcome outcome = comm.is_root() ? describe(error_on_root) : Outcome{};
  broadcast(comm, outcome.kind);
  if (outcome.kind == Outcome::done) return;
  broadcast(comm, outcome.texts);
  if (comm.is_root()) std::rethrow_exception(error_on_root);
  if (outcome.kind == Outcome::user_error)
    throw UserError(outcome.texts.at(0), outcome.texts.at(1), outcome.texts.at(2));
  throw std::runtime_error(outcome.texts.at(0));
}

}  // namespace heartgen::parallel
