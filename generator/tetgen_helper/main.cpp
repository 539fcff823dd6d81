// SPDX-License-Identifier: AGPL-3.0-or-later
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <heartgen/version.hpp>
#include <string_view>

#include "generator/tetgen_helper/fill.hpp"

namespace {

constexpr const char* help =
    "heartgen-tetgen: the mesher TetGen for heartgen, which starts it for backend = \"tetgen\"\n"
    "Usage: heartgen-tetgen < TASK > ANSWER\n\n"
    "OPTIONS:\n"
    "  -h, --help     Print this help message and exit\n"
    "      --version  Print version and exit\n\n"
    "TASK holds surfaces, seeds and edge lengths as heartgen writes them, ANSWER the cells between the surfaces.\n"
    "This program is linked with TetGen and is under the AGPL-3.0-or-later; heartgen is not.\n";

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1) {
    const std::string_view option = argv[1];
    if (option == "--version") return std::puts(HEARTGEN_VERSION) < 0;
    const bool is_help = option == "--help" || option == "-h";
    return std::fputs(help, is_help ? stdout : stderr) < 0 ? 1 : is_help ? 0 : 2;
  }
  if (isatty(STDIN_FILENO) == 1) return std::fputs(help, stderr), 2;
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // nobody waits for the answer any more
  const rlimit no_core_file{0, 0};
  setrlimit(RLIMIT_CORE, &no_core_file);
  // TetGen prints on standard output: that goes where errors go, unbuffered, so that it survives a crash.
  std::FILE* const answer = fdopen(dup(STDOUT_FILENO), "wb");
  if (answer == nullptr || dup2(STDERR_FILENO, STDOUT_FILENO) < 0) return 1;
  std::setvbuf(stdout, nullptr, _IONBF, 0);
  _exit(heartgen::tetgen_helper::answer_task(stdin, answer, stderr));
}
