// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Independent pieces of work of uneven length, done by whichever thread is free.
#pragma once
#include <functional>
#include <span>

namespace heartgen::parallel {

/// Runs every task once, on up to thread_count() threads, started in their order, and waits for all. Loops inside one
/// of several tasks run on its thread. When tasks throw, that of the first of them, in their order, is rethrown.
void run_tasks(std::span<const std::function<void()>> tasks);

}  // namespace heartgen::parallel
