// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/parallel/tasks.hpp"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <exception>
#include <vector>

#include "generator/parallel/threads.hpp"

namespace heartgen::parallel {

void run_tasks(std::span<const std::function<void()>> tasks) {
  std::vector<std::exception_ptr> errors(tasks.size());
  std::atomic<std::size_t> next = 0;
  parallel_for(0, std::min<std::int64_t>(thread_count(), static_cast<std::int64_t>(tasks.size())),
               [&](std::int64_t, std::int64_t) {
                 for (std::size_t t = next++; t < tasks.size(); t = next++) try {
                     tasks[t]();
                   } catch (...) {
                     errors[t] = std::current_exception();
                   }
               });
  for (const auto& error : errors)
    if (error) std::rethrow_exception(error);
}

}  // namespace heartgen::parallel
