// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What the benchmarks measure with: times, memory, the machine's own limits.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "generator/parallel/comm.hpp"

namespace heartgen::benchmarks {

/// One line of the table.
struct Row {
  std::string bench;  ///< "sweep"
  std::string what;   ///< "Chan-Vese, semi-explicit, 2 threads"
  double value = 0;
  std::string unit;  ///< "G voxels/s"
  std::string note;  ///< what it is to be compared with; may be empty
};

using Table = std::vector<Row>;

/// From now on, seconds are processor time divided by the number of threads instead of wall-clock time: what a machine
/// that does other things meanwhile would take, nearly, if it did not. Waiting for other ranks counts as work.
void count_processor_time(bool instead);

/// Seconds of work().
double seconds(const std::function<void()>& work);

/// Processor time of all threads of this process so far.
double processor_seconds();

/// Median of `repeats` runs, after one that is not counted.
double median_seconds(int repeats, const std::function<void()>& work);

/// Seconds of work() on all ranks, which start together; the slowest counts. @collective
double slowest_seconds(const parallel::Comm& comm, const std::function<void()>& work);

/// The middle one; of an even number the larger of the two in the middle.
double median(std::vector<double> values);

/// Bytes per second of a[i] = b[i] + s c[i] on arrays much larger than the caches, 12 bytes counted for each element
/// as STREAM does (McCalpin 1995), with the threads that parallel_for uses.
double triad_bandwidth();

/// Largest memory that the process held since the last call of start_peak(), above what it held then, in bytes.
/// 0 where the system cannot tell.
void start_peak();
double peak_bytes();

/// Memory that the system could still give to this process, in bytes; huge where the system cannot tell.
double free_bytes();

}  // namespace heartgen::benchmarks
