// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/parallel/memory.hpp"

#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace heartgen::parallel {
namespace {

constexpr std::size_t line_bytes = 64;
constexpr std::size_t huge_page_bytes = std::size_t{2} << 20;

std::align_val_t alignment(std::size_t bytes) {
  return std::align_val_t{bytes >= huge_page_bytes ? huge_page_bytes : line_bytes};
}

}  // namespace

void* allocate_pages(std::size_t bytes) {
  void* memory = ::operator new(bytes, alignment(bytes));
#ifdef MADV_HUGEPAGE
  // Whole pages only; a refusal changes nothing.
  if (bytes >= huge_page_bytes) madvise(memory, bytes / huge_page_bytes * huge_page_bytes, MADV_HUGEPAGE);
#endif
  return memory;
}

void free_pages(void* memory, std::size_t bytes) { ::operator delete(memory, alignment(bytes)); }

}  // namespace heartgen::parallel
