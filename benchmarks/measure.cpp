// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/measure.hpp"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <fstream>
#include <limits>
#include <string>
#include <utility>

#include "generator/parallel/threads.hpp"
#include "model/quantile.hpp"

#ifdef __GLIBC__  // which the headers above define
#include <malloc.h>
#endif

namespace heartgen::benchmarks {
namespace {

/// A field of /proc/self/status, in bytes.
double status_bytes(const std::string& field) {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word)
    if (word == field + ":") {
      double kib = 0;
      status >> kib;
      return kib * 1024;
    }
  return 0;
}

double held_at_start = 0;
bool processor_time = false;

double now() {
  if (processor_time)
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC / static_cast<double>(parallel::thread_count());
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

void count_processor_time(bool instead) { processor_time = instead; }

double median(std::vector<double> values) { return upper_median(values); }

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double seconds(const std::function<void()>& work) {
  const double begin = now();
  work();
  return now() - begin;
}

double median_seconds(int repeats, const std::function<void()>& work) {
  work();
  std::vector<double> times(static_cast<std::size_t>(repeats));
  for (double& time : times) time = seconds(work);
  return median(std::move(times));
}

double slowest_seconds(const parallel::Comm& comm, const std::function<void()>& work) {
  parallel::barrier(comm);
  return parallel::max(comm, seconds(work));
}

double triad_bandwidth() {
  constexpr std::int64_t count = 40'000'000;
  std::vector<float> a(count), b(count), c(count);
  parallel::parallel_for(0, count, [&](std::int64_t begin, std::int64_t end) {  // pages belong to who touches them
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      a[i] = 0;
      b[i] = static_cast<float>(i % 7);
      c[i] = static_cast<float>(i % 5);
    }
  });
  const auto triad = [&] {
    parallel::parallel_for(0, count, [&](std::int64_t begin, std::int64_t end) {
      float* to = a.data();
      const float *from = b.data(), *factor = c.data();
      for (auto i = begin; i < end; ++i) to[i] = from[i] + 3.0f * factor[i];
    });
  };
  return 12.0 * static_cast<double>(count) / median_seconds(7, triad);
}

void start_peak() {
#ifdef __GLIBC__
  malloc_trim(0);  // what was freed but kept would be used again without being counted
#endif
  std::ofstream("/proc/self/clear_refs") << "5";
  held_at_start = status_bytes("VmRSS");
}

double peak_bytes() { return std::max(0.0, status_bytes("VmHWM") - held_at_start); }

double free_bytes() {
  std::ifstream file("/proc/meminfo");
  for (std::string word; file >> word;)
    if (double kilobytes = 0; word == "MemAvailable:" && file >> kilobytes) return 1024 * kilobytes;
  return std::numeric_limits<double>::max();
}

}  // namespace heartgen::benchmarks
