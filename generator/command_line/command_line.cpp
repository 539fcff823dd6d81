// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/command_line/command_line.hpp"

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

#include "generator/parallel/simd.hpp"
#include "generator/parallel/threads.hpp"
#include "generator/pipeline/heartbeat.hpp"
#include "generator/pipeline/output.hpp"
#include "generator/pipeline/versions.hpp"
#include "model/error.hpp"
#include "model/memory.hpp"
#include "model/text.hpp"
#include "model/unfinished.hpp"

namespace heartgen::command_line {
namespace {

constexpr int exit_defect = 1;
constexpr int exit_user = 2;
constexpr unsigned threads_per_processor = 16;  // for the same bits on small machines; more only wait

/// Long work says so.
std::unique_ptr<pipeline::Heartbeat> watch_over(const CommandLine& line) {
  const auto name = line.app.get_subcommands().front()->get_name();
  if (!line.comm.is_root() || std::ranges::find(line.talkative, name) != line.talkative.end()) return nullptr;
  const auto program = line.app.get_name();
  return std::make_unique<pipeline::Heartbeat>(pipeline::longest_silence, [program, name](double seconds) {
    fmt::print(stderr, "{} {}: {:.0f} s so far\n", program, name, seconds);
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

int run(CommandLine& line) {
  if (line.threads < 0) throw UserError("must be positive", "--threads", "give the number of threads");
  const auto max_threads = static_cast<int>(threads_per_processor * std::max(1U, std::thread::hardware_concurrency()));
  if (line.threads > max_threads)
    throw UserError(fmt::format("{} threads would wait for each other", line.threads), "--threads",
                    fmt::format("give at most {} on this machine, or 0 for one per processor", max_threads));
  if (line.threads > 0) parallel::set_thread_count(line.threads);
  if (!line.simd.empty()) choose_simd(line.simd);
  if (!line.memory_limit.empty()) set_memory_limit(bytes_of_text(line.memory_limit, "--memory-limit"));
  const auto watch = watch_over(line);
  return line.chosen();
}

/// One line, whatever the file names in it hold.
void say(const std::string& program, std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  fmt::print(stderr, "{}: {}\n", program, text);
}

/// CLI11 has exit codes of its own; ours are 0 for --help and 2 for a mistake.
int parse_failed(CommandLine& line, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) return line.comm.is_root() ? line.app.exit(error) : 0;
  const auto program = line.app.get_name();
  std::string what = error.what();
  if (const auto left = line.app.remaining(); line.app.get_subcommands().empty() && !left.empty()) {
    std::vector<std::string> names;
    for (const auto* command : line.app.get_subcommands({})) names.push_back(command->get_name());
    what = fmt::format("unknown command \"{}\": did you mean \"{}\"?", left.front(), nearest_name(left.front(), names));
  }
  if (line.comm.is_root()) say(program, fmt::format("{} ({} --help shows the commands)", what, program));
  return exit_user;
}

/// Of the exception that is being handled: its message, and its exit code. What the machine lacks is no defect.
int explained(const std::string& program, bool speaks) {
  wait_where_stopped();  // what fails because a signal took its files away is not told
  const auto tell = [&](const std::string& text) {
    if (speaks) say(program, text);
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

int parse_and_run(CommandLine& line, int argc, char** argv) {
  try {
    line.app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return parse_failed(line, error);
  }
  try {
    return run(line);
  } catch (...) {
    return explained(line.app.get_name(), line.comm.is_root());
  }
}

/// Mistakes and defects become messages and exit codes.
int command_line(int argc, char** argv, const std::string& name, const std::string& what,
                 const std::function<void(CommandLine&)>& add_commands) {
  const parallel::Environment environment(&argc, &argv);
  CommandLine line(what);
  line.app.name(name);
  if (!line.comm.is_root()) pipeline::say_nothing_when_stopped();
  line.app.set_version_flag("--version", pipeline::program_version());
  line.app.require_subcommand(1);
  add_machine_options(line, line.app);
  line.app.fallthrough();
  add_commands(line);
  return parse_and_run(line, argc, argv);
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

void add_machine_options(CommandLine& line, CLI::App& app) {
  app.add_option("--threads", line.threads, "threads per process (default: all)");
  app.add_option(
      "--simd", line.simd,
      "vector instructions at most: plain, avx2 or avx512 (default: the processor's best; the same results)");
  app.add_option("--memory-limit", line.memory_limit,
                 "refuse work that needs more memory, e.g. 8G (default: what the machine, cgroups and ulimits leave)");
}

CLI::App* add_command(CommandLine& line, const std::string& name, const std::string& what, const std::string& example,
                      std::function<int()> action) {
  auto* command = line.app.add_subcommand(name, what);
  command->footer("Example:\n  " + example);
  command->callback([&line, action = std::move(action)] { line.chosen = action; });
  return command;
}

std::function<int()> on_root(CommandLine& line, std::function<int()> action) {
  return [&line, action = std::move(action)] { return parallel::run_on_root(line.comm, action); };
}

CLI::Option* add_vector(CLI::App& command, const std::string& name, Vec3& value, const std::string& text) {
  const auto set = [&value](const std::vector<double>& given) { value = {given[0], given[1], given[2]}; };
  return command.add_option_function<std::vector<double>>(name, set, text)->delimiter(',')->expected(3);
}

void add_grid_options(CLI::App& command, Index3& size, Vec3& spacing_mm, const std::string& of) {
  const auto set = [&size](const std::vector<std::int64_t>& given) { size = {given[0], given[1], given[2]}; };
  const auto sizes = fmt::format("{}voxels NX,NY,NZ (default {},{},{})", of, size[0], size[1], size[2]);
  command.add_option_function<std::vector<std::int64_t>>("--size", set, sizes)->delimiter(',')->expected(3);
  add_vector(command, "--spacing", spacing_mm,
             fmt::format("mm SX,SY,SZ (default {:g},{:g},{:g})", spacing_mm.x, spacing_mm.y, spacing_mm.z));
}

int run_program(int argc, char** argv, const std::string& what, const std::function<void(CommandLine&)>& add_commands) {
  keep_freed_memory();
  std::setlocale(LC_ALL, "C");
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond the system's limit ends in a message, as on a full disk
  pipeline::begin_output();
  pipeline::watch_signals();
  const auto name = what.substr(0, what.find(':'));
  int code = exit_defect;
  try {
    code = command_line(argc, argv, name, what, add_commands);
  } catch (...) {  // what is thrown before a command runs or while its message is printed; nothing may leave main
    fmt::print(stderr, "{}: internal error\n", name);
  }
  const auto unwritten = pipeline::finish_output();
  if (unwritten.empty()) return code;
  say(name, UserError(fmt::format("cannot be written: {}", unwritten), "standard output", "is there room on the disk?")
                .message);
  return exit_user;
}

}  // namespace heartgen::command_line
