// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Marks that several threads set: whoever comes first, what is left is the same.
#pragma once
#include <atomic>

namespace heartgen::tetmesh {

/// Sets bits in a word that other threads set bits in.
template <class T>
void set_bits(T& word, T bits) {
  const std::atomic_ref shared(word);
  if ((shared.load(std::memory_order_relaxed) & bits) != bits) shared.fetch_or(bits, std::memory_order_relaxed);
}

/// Writes a value that is the only one which threads write at a time.
template <class T>
void set_to(T& word, T value) {
  const std::atomic_ref shared(word);
  if (shared.load(std::memory_order_relaxed) != value) shared.store(value, std::memory_order_relaxed);
}

/// Writes a value that is the only one which threads write at a time; whether this call changed it.
template <class T>
bool set_first(T& word, T value) {
  const std::atomic_ref shared(word);
  return shared.load(std::memory_order_relaxed) != value && shared.exchange(value, std::memory_order_relaxed) != value;
}

}  // namespace heartgen::tetmesh
