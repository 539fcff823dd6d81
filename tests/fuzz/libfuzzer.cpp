// SPDX-License-Identifier: GPL-3.0-or-later
// For clang's libFuzzer: fuzz_readers --kind=KIND CORPUS.
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "fuzz/readers.hpp"
#include "support/data.hpp"

namespace {

std::string kind, folder;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  constexpr std::string_view option = "--kind=";
  for (int a = 1; a < *argc; ++a)
    if (const std::string_view text = (*argv)[a]; text.starts_with(option)) kind = text.substr(option.size());
  if (kind.empty()) {
    std::fputs("give --kind=, one of the folders of tests/fuzz/corpus\n", stderr);
    std::exit(2);
  }
  heartgen::fuzz::limit_memory();
  folder = heartgen::testing::scratch_folder("libfuzzer_" + std::to_string(getpid())).string();
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  heartgen::fuzz::feed(kind, {reinterpret_cast<const char*>(data), size}, folder);
  return 0;
}
