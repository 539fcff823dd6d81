// The command line: parses, calls one function per subcommand, turns errors into messages and exit codes.
#include <fmt/format.h>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <algorithm>
#include <clocale>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <memory>
#include <new>
#include <thread>

#include "generator/adapters/image_checks.hpp"
#include "generator/app/options.hpp"
#include "generator/app/output.hpp"
#include "generator/app/versions.hpp"
#include "generator/app/watch.hpp"
#include "generator/parallel/simd.hpp"
#include "generator/parallel/threads.hpp"
#include "model/error.hpp"
#include "model/memory.hpp"
#include "model/text.hpp"
#include "model/unfinished.hpp"

namespace {

using namespace heart;
using namespace heart::app;

constexpr int exit_defect = 1;
constexpr int exit_user = 2;
constexpr unsigned threads_per_processor = 16;  // for the same bits on small machines; more only wait

/// Long work says so; a build tells of its stages, and `bench` of its benchmarks.
std::unique_ptr<Watch> watch_over(const Program& p) {
  const auto name = p.app.get_subcommands().front()->get_name();
  if (!p.comm.is_root() || name == "build" || name == "bench") return nullptr;
  return std::make_unique<Watch>(longest_silence, [name](double seconds) {
    fmt::print(stderr, "heartgen {}: {:.0f} s so far\n", name, seconds);
    std::fflush(stderr);
  });
}

void choose_simd(const std::string& name) {
  using parallel::Simd;
  constexpr std::pair<const char*, Simd> levels[]{
      {"plain", Simd::plain}, {"avx2", Simd::avx2}, {"avx512", Simd::avx512}};
  const auto* const found =
      std::find_if(std::begin(levels), std::end(levels), [&](auto& level) { return level.first == name; });
  if (found == std::end(levels)) throw UserError("unknown \"" + name + "\"", "--simd", "give plain, avx2 or avx512");
  if (parallel::set_simd_level(found->second) != found->second)
    throw UserError(fmt::format("this processor has no {}", parallel::name_of(found->second)), "--simd",
                    "leave it out: the results are the same");
}

int run(Program& p) {
  if (p.threads < 0) throw UserError("must be positive", "--threads", "give the number of threads");
  const auto most_threads = static_cast<int>(threads_per_processor * std::max(1U, std::thread::hardware_concurrency()));
  if (p.threads > most_threads)
    throw UserError(fmt::format("{} threads would wait for each other", p.threads), "--threads",
                    fmt::format("give at most {} on this machine, or 0 for one per processor", most_threads));
  if (p.threads > 0) parallel::set_thread_count(p.threads);
  if (!p.simd.empty()) choose_simd(p.simd);
  if (!p.memory_limit.empty()) set_memory_limit(bytes_of_text(p.memory_limit, "--memory-limit"));
  if (!p.size.empty()) adapters::check_size({p.size[0], p.size[1], p.size[2]}, "--size", true);
  if (!p.size.empty()) p.phantom.size = p.accuracy.size = p.bench.size = {p.size[0], p.size[1], p.size[2]};
  if (!p.spacing.empty())
    p.phantom.spacing_mm = p.accuracy.spacing_mm = p.bench.spacing_mm = {p.spacing[0], p.spacing[1], p.spacing[2]};
  if (!p.rotation.empty())
    p.phantom.heart.rotation_deg = p.accuracy.heart.rotation_deg = {p.rotation[0], p.rotation[1], p.rotation[2]};
  const auto watch = watch_over(p);
  return p.chosen();
}

/// One line, whatever the file names in it hold.
void say(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  fmt::print(stderr, "heartgen: {}\n", text);
}

/// CLI11 has exit codes of its own; ours are 0 for --help and 2 for a mistake.
int parse_failed(Program& p, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) return p.comm.is_root() ? p.app.exit(error) : 0;
  std::string what = error.what();
  if (const auto left = p.app.remaining(); p.app.get_subcommands().empty() && !left.empty()) {
    std::vector<std::string> names;
    for (const auto* command : p.app.get_subcommands({})) names.push_back(command->get_name());
    what = fmt::format("unknown command \"{}\": did you mean \"{}\"?", left.front(), nearest_name(left.front(), names));
  }
  if (p.comm.is_root()) say(what + " (heartgen --help shows the commands)");
  return exit_user;
}

/// Of the exception that is being handled: its message, and its exit code. What the machine lacks is no defect.
int explained(bool speaks) {
  wait_where_stopped();  // what fails because a signal took its files away is not told
  const auto tell = [&](const std::string& text) {
    if (speaks) say(text);
  };
  try {
    throw;
  } catch (const UserError& error) {
    return tell(error.what()), exit_user;
  } catch (const std::filesystem::filesystem_error& error) {
    return tell(UserError(error.code().message(), error.path1().string(), "check rights and the space left").message),
           exit_user;
  } catch (const std::bad_alloc&) {
    return tell("not enough memory (take longer edges, a smaller image or a larger machine)"), exit_user;
  } catch (const std::exception& error) {
    return tell(std::string("internal error: ") + error.what()), exit_defect;
  }
}

/// Mistakes and defects become messages and exit codes.
int command_line(int argc, char** argv) {
  const parallel::Environment environment(&argc, &argv);
  Program p;
  p.comm = parallel::world();
  if (!p.comm.is_root()) say_nothing_when_stopped();
  p.app.set_version_flag("--version", program_version());
  p.app.require_subcommand(1);
  add_machine_options(p, p.app);
  p.app.fallthrough();
  add_bundle_options(p);
  add_tool_options(p);
  add_measure_options(p);
  try {
    p.app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return parse_failed(p, error);
  }
  try {
    return run(p);
  } catch (...) {
    return explained(p.comm.is_root());
  }
}

/// Arrays of some MB come and go in every step. To give their pages back and ask for them again costs a mesher a tenth
/// of its time; what is kept is bounded, and the next step uses it.
void keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int one_array = 256 << 20, at_most = 768 << 20;  // bytes
  mallopt(M_MMAP_THRESHOLD, one_array);
  mallopt(M_TRIM_THRESHOLD, at_most);
#endif
}

}  // namespace

int main(int argc, char** argv) {
  keep_freed_memory();
  std::setlocale(LC_ALL, "C");
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond the system's limit ends in a message, as on a full disk
  begin_output();
  watch_signals();
  int code = exit_defect;
  try {
    code = command_line(argc, argv);
  } catch (...) {  // what is thrown before a command runs or while its message is printed; nothing may leave main
    std::fputs("heartgen: internal error\n", stderr);
  }
  const auto unwritten = finish_output();
  if (unwritten.empty()) return code;
  say(UserError(fmt::format("cannot be written: {}", unwritten), "standard output", "is there room on the disk?")
          .message);
  return exit_user;
}
