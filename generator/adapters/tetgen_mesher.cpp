// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/adapters/tetgen_mesher.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "generator/adapters/tetgen_exchange.hpp"
#include "model/error.hpp"
#include "model/own_file.hpp"
#include "model/printable.hpp"

namespace heartgen::adapters {
namespace {

namespace fs = std::filesystem;

constexpr const char* program_name = "heartgen-tetgen";
constexpr const char* key = "recipe, [mesh], backend = \"tetgen\"";

/// A file without a name, removed when it is closed.
struct Scratch {
  std::FILE* file = std::tmpfile();
  Scratch() {
    if (file == nullptr) throw UserError("no temporary file", "TMPDIR", "free some disk space");
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() { std::fclose(file); }
};

std::string first_line(std::FILE* file) {
  std::rewind(file);
  std::array<char, 200> line{};
  if (std::fgets(line.data(), static_cast<int>(line.size()), file) == nullptr) return "";
  std::string text = line.data();
  while (!text.empty() && (text.back() == '\n' || text.back() == '.')) text.pop_back();
  return printable(text);
}

/// Runs the program with these files as its standard input, output and error. Returns its wait status.
int run(const fs::path& program, const Scratch& input, const Scratch& output, const Scratch& printed) {
  std::rewind(input.file);
  posix_spawn_file_actions_t streams;
  posix_spawn_file_actions_init(&streams);
  const std::pair<const Scratch*, int> places[]{
      {&input, STDIN_FILENO}, {&output, STDOUT_FILENO}, {&printed, STDERR_FILENO}};
  for (const auto& [scratch, stream] : places)
    posix_spawn_file_actions_adddup2(&streams, fileno(scratch->file), stream);
  std::string name = program.string();
  std::array<char*, 2> arguments{name.data(), nullptr};
  pid_t child = -1;
  const int error = posix_spawn(&child, name.c_str(), &streams, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&streams);
  if (error != 0)
    throw UserError("cannot be started: " + std::generic_category().message(error), name, "use \"lattice\" meanwhile");
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) throw std::runtime_error("the process of TetGen is lost");
  return status;
}

UserError gave_up(const std::string& problem) {
  return {"TetGen: " + problem, key, "use \"lattice\", or look at the label map for regions that touch in a point"};
}

/// What went wrong, from how the program ended; empty if nothing did.
std::string failure(int status, std::FILE* printed) {
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return "";
  const std::string line = first_line(printed);
  const std::string said = line.empty() ? "" : ": " + line;
  if (WIFSIGNALED(status)) return fmt::format("gave up by signal {}{}", WTERMSIG(status), said);
  return fmt::format("gave up with exit code {}{}", WEXITSTATUS(status), said);
}

FillAnswer ask(const FillTask& task, const fs::path& program) {
  const Scratch input, output, printed;
  write_exchange(input.file, task);
  if (const auto problem = failure(run(program, input, output, printed), printed.file); !problem.empty())
    throw gave_up(problem);
  try {
    return read_exchange<FillAnswer>(output.file);
  } catch (const std::runtime_error& error) {
    throw UserError(fmt::format("its answer {}", error.what()), program.string(),
                    "install heartgen and heartgen-tetgen of one version");
  }
}

/// Throws UserError where the answer does not speak of the task.
void check_answer(const FillAnswer& answer, const SurfaceComplex& surfaces) {
  const auto count = static_cast<std::int32_t>(answer.nodes_mm.size());
  const auto is_node = [count](std::int32_t n) { return n >= 0 && n < count; };
  const bool is_sound =
      answer.label.size() == answer.cells.size() && answer.nodes_mm.size() >= surfaces.nodes_mm.size() &&
      std::ranges::all_of(answer.cells, [&](const Cell& c) { return std::ranges::all_of(c, is_node); });
  if (!is_sound) throw gave_up("its answer is damaged");
}

/// Labels that no seed has are of pieces without one.
LabelledCells seeded_cells(FillAnswer answer, const SurfaceComplex& surfaces) {
  std::int32_t last = 0;
  for (const auto& seed : surfaces.seeds) last = std::max(last, seed.label);
  LabelledCells result;
  result.nodes_mm = std::move(answer.nodes_mm);
  for (std::size_t c = 0; c < answer.cells.size(); ++c) {
    if (answer.label[c] < 1 || answer.label[c] > last) continue;
    Cell cell = answer.cells[c];
    const auto at = [&](std::size_t i) { return result.nodes_mm[static_cast<std::size_t>(cell[i])]; };
    if (dot(at(1) - at(0), cross(at(2) - at(0), at(3) - at(0))) < 0) std::swap(cell[2], cell[3]);
    result.cells.push_back(cell);
    result.label.push_back(answer.label[c]);
  }
  return result;
}

}  // namespace

fs::path find_tetgen() {
  std::vector<fs::path> folders{fs::weakly_canonical(own_file()).parent_path()};
  const char* const path = std::getenv("PATH");
  for (std::string_view left = path != nullptr ? path : ""; !left.empty();) {
    const auto end = std::min(left.find(':'), left.size());
    folders.emplace_back(left.substr(0, end));
    left.remove_prefix(std::min(end + 1, left.size()));
  }
  for (const auto& folder : folders)
    if (const auto file = folder / program_name; access(file.c_str(), X_OK) == 0) return file;
  throw UserError(fmt::format("the program {} is neither beside heartgen nor on the PATH", program_name), key,
                  "install it, or use \"lattice\"");
}

LabelledCells fill_surfaces(const FillTask& task, const fs::path& program) {
  if (task.surfaces.faces.empty() || task.surfaces.seeds.empty()) return {};
  auto answer = ask(task, program);
  if (!answer.problem.empty()) throw gave_up(answer.problem);
  check_answer(answer, task.surfaces);
  auto cells = seeded_cells(std::move(answer), task.surfaces);
  if (cells.cells.empty()) throw UserError("TetGen made no cells", key, "use \"lattice\"");
  return cells;
}

}  // namespace heartgen::adapters
