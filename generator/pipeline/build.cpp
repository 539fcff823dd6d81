// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/build.hpp"

#include <system_error>
#include <utility>

namespace heartgen::pipeline {

namespace fs = std::filesystem;

NewCache::NewCache(const fs::path& folder) : folder_(fs::exists(folder) ? fs::path() : folder) {}

NewCache::NewCache(NewCache&& other) noexcept : folder_(std::exchange(other.folder_, {})) {}

NewCache& NewCache::operator=(NewCache&& other) noexcept {
  std::swap(folder_, other.folder_);
  return *this;
}

NewCache::~NewCache() {
  std::error_code ignored;
  if (!folder_.empty()) fs::remove_all(folder_, ignored);
}

}  // namespace heartgen::pipeline
