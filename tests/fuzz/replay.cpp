// SPDX-License-Identifier: GPL-3.0-or-later
// The corpus, and random changes of it, without libFuzzer: replay CORPUS SECONDS [SEED [FILES [KIND...]]]. The changes
// are the same in every run of a seed; a slow machine has time for fewer of them. What a reader does not survive stays
// where the first line says.
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "fuzz/readers.hpp"
#include "support/data.hpp"
#include "support/files.hpp"

namespace {

namespace fs = std::filesystem;
using namespace heartgen;

constexpr unsigned slowest_s = 60;  // for one file; three times what a library may take for a small one
constexpr rlim_t max_bytes = rlim_t{8} << 30;

struct Seed {
  std::string kind, bytes;
};

std::vector<Seed> corpus(const fs::path& folder, const std::vector<std::string>& kinds) {
  std::vector<Seed> seeds;
  for (const auto& kind : kinds) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder / kind)) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (const auto& file : files) seeds.push_back({kind, testing::bytes_of(file)});
  }
  return seeds;
}

using Random = std::mt19937_64;

std::size_t below(Random& random, std::size_t end) { return end == 0 ? 0 : random() % end; }

/// One change: other bits, bytes of a count, a piece that is lost, doubled or of another file.
void change(std::string& bytes, const std::string& other, Random& random) {
  const std::string extremes[] = {
      "0",     "-1", "999999999",          "2147483648",           "18446744073709551615", "nan",
      "1e308", "",   std::string(4, '\0'), std::string(4, '\xff'), std::string(8, '\x7f')};
  const auto at = below(random, bytes.size() + 1),
             length = below(random, std::min<std::size_t>(64, bytes.size() - at) + 1);
  switch (below(random, 6)) {
    case 0:
      if (at < bytes.size()) bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(random, 8)));
      break;
    case 1:
      if (at < bytes.size()) bytes[at] = static_cast<char>(random());
      break;
    case 2:
      bytes.replace(at, below(random, 12), extremes[below(random, std::size(extremes))]);
      break;
    case 3:
      bytes.erase(at, length);
      break;
    case 4:
      bytes.insert(at, bytes.substr(at, length));
      break;
    default:
      bytes.replace(at, length, other.substr(below(random, other.size() + 1), length));
  }
}

/// Whether the readers answered.
bool answered(const Seed& seed, const std::string& folder) {
  alarm(slowest_s);
  try {
    fuzz::feed(seed.kind, seed.bytes, folder);
    return true;
  } catch (const std::exception& error) {
    fmt::print("{}: {} (the file is in {})\n", seed.kind, error.what(), folder);
  }
  return false;
}

struct Extent {
  double seconds = 60;
  std::uint64_t random_seed = 1;
  std::size_t files = 40'000;
  std::vector<std::string> kinds = fuzz::kinds();
};

int replay(const fs::path& folder, const Extent& extent) {
  const auto scratch = testing::scratch_folder(fmt::format("fuzz_{}", getpid())).string();
  fmt::print("the file at hand is in {}\n", scratch);
  std::fflush(stdout);
  fuzz::limit_memory();
  const auto seeds = corpus(folder, extent.kinds);
  for (const auto& seed : seeds)
    if (!answered(seed, scratch)) return 1;
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(extent.seconds);
  Random random(extent.random_seed);
  std::size_t count = seeds.size();
  for (; count < extent.files && std::chrono::steady_clock::now() < end; ++count) {
    Seed seed = seeds[count % seeds.size()];
    const auto& other = seeds[below(random, seeds.size())];
    for (auto changes = 1 + below(random, 4); changes > 0; --changes) change(seed.bytes, other.bytes, random);
    if (!answered(seed, scratch)) return 1;
  }
  fs::remove_all(scratch);
  fmt::print("{} files, {} of them of the corpus\n", count, seeds.size());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 2;
#ifndef __SANITIZE_ADDRESS__
  const rlimit limit{max_bytes, max_bytes};
  setrlimit(RLIMIT_AS, &limit);
#endif
  Extent extent;
  extent.seconds = std::atof(argv[2]);
  if (argc > 3) extent.random_seed = std::strtoull(argv[3], nullptr, 10);
  if (argc > 4) extent.files = std::strtoull(argv[4], nullptr, 10);
  if (argc > 5) extent.kinds.assign(argv + 5, argv + argc);
  return replay(argv[1], extent);
}
