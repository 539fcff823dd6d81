// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/adapters/tetgen_mesher.hpp"

#define TETLIBRARY
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <tetgen.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <utility>

#include "model/error.hpp"

namespace heartgen::adapters {
namespace {

constexpr int refused = 99;  // exit code of the child for errors that TetGen has no number for
const std::array<std::pair<int, const char*>, 5> meanings{{{1, "out of memory"},
                                                           {3, "surfaces cross each other"},
                                                           {4, "a detail of the surfaces is too small"},
                                                           {5, "two faces lie too close to each other"},
                                                           {10, "the surfaces are not a complex"}}};

/// What TetGen's question about a cell needs: it is a bare function without a context.
struct Sizes {
  const std::function<double(const Vec3&)>* edge_mm = nullptr;
  double volume_share = 0;
};
thread_local Sizes sizes;

bool is_too_large(REAL* a, REAL* b, REAL* c, REAL* d, REAL* /*elen*/, REAL /*volume*/) {
  const Vec3 p{a[0], a[1], a[2]}, q{b[0], b[1], b[2]}, r{c[0], c[1], c[2]}, s{d[0], d[1], d[2]};
  const double volume = std::abs(dot(q - p, cross(r - p, s - p))) / 6;
  const double edge = (*sizes.edge_mm)(0.25 * (p + q + r + s));
  return volume > sizes.volume_share * edge * edge * edge;
}

/// The arrays of the input belong to this struct, not to TetGen, which frees what its own struct names.
struct Input {
  std::vector<double> coordinates, regions;
  std::vector<int> corners, markers;
  std::vector<tetgenio::polygon> polygons;
  std::vector<tetgenio::facet> facets;
  tetgenio io;

  explicit Input(const SurfaceComplex& surfaces) {
    for (const auto& p : surfaces.nodes_mm) coordinates.insert(coordinates.end(), {p.x, p.y, p.z});
    for (const auto& seed : surfaces.seeds)
      regions.insert(regions.end(),
                     {seed.point_mm.x, seed.point_mm.y, seed.point_mm.z, static_cast<double>(seed.label), 0.0});
    for (const auto& face : surfaces.faces) corners.insert(corners.end(), face.begin(), face.end());
    const std::size_t count = surfaces.faces.size();
    polygons.resize(count);
    facets.resize(count);
    markers.assign(count, 1);
    for (std::size_t f = 0; f < count; ++f) {
      polygons[f] = {corners.data() + 3 * f, 3};
      facets[f] = {polygons.data() + f, 1, nullptr, 0};
    }
    io.firstnumber = 0;
    io.pointlist = coordinates.data();
    io.numberofpoints = static_cast<int>(surfaces.nodes_mm.size());
    io.regionlist = regions.data();
    io.numberofregions = static_cast<int>(surfaces.seeds.size());
    io.facetlist = facets.data();
    io.facetmarkerlist = markers.data();
    io.numberoffacets = static_cast<int>(count);
    io.tetunsuitable = &is_too_large;
  }
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;
  ~Input() { io.initialize(); }  // forgets the arrays: nothing is left to free
};

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

template <class T>
void write(std::FILE* file, const T* values, std::size_t count) {
  if (std::fwrite(values, sizeof(T), count, file) != count) throw std::runtime_error("disk is full");
}

template <class T>
std::vector<T> read(std::FILE* file, std::size_t count) {
  std::vector<T> values(count);
  if (std::fread(values.data(), sizeof(T), count, file) != count)
    throw std::runtime_error("TetGen's cells are cut off");
  return values;
}

std::size_t number(int n) { return static_cast<std::size_t>(n); }

void write_output(std::FILE* file, const tetgenio& output) {
  if (output.numberofcorners != 4 || output.numberoftetrahedronattributes < 1) throw std::runtime_error("no labels");
  const std::array counts{output.numberofpoints, output.numberoftetrahedra, output.numberoftetrahedronattributes};
  const std::size_t cells = number(output.numberoftetrahedra);
  write(file, counts.data(), counts.size());
  write(file, output.pointlist, 3 * number(output.numberofpoints));
  write(file, output.tetrahedronlist, 4 * cells);
  write(file, output.tetrahedronattributelist, cells * number(output.numberoftetrahedronattributes));
  if (std::fflush(file) != 0) throw std::runtime_error("disk is full");
}

/// Labels above last_label are pieces without a seed.
LabelledCells read_output(std::FILE* file, std::int32_t last_label) {
  std::rewind(file);
  const auto counts = read<int>(file, 3);
  const auto points = read<double>(file, 3 * number(counts[0]));
  const auto corners = read<std::int32_t>(file, 4 * number(counts[1]));
  const auto attributes = read<double>(file, number(counts[1]) * number(counts[2]));
  LabelledCells result;
  for (std::size_t n = 0; n < points.size(); n += 3)
    result.nodes_mm.push_back({points[n], points[n + 1], points[n + 2]});
  for (std::size_t c = 0; c < number(counts[1]); ++c) {
    const auto label = static_cast<std::int32_t>(std::lround(attributes[number(counts[2]) * (c + 1) - 1]));
    if (label < 1 || label > last_label) continue;
    Cell cell{corners[4 * c], corners[4 * c + 1], corners[4 * c + 2], corners[4 * c + 3]};
    const auto at = [&](std::size_t i) { return result.nodes_mm[number(cell[i])]; };
    if (dot(at(1) - at(0), cross(at(2) - at(0), at(3) - at(0))) < 0) std::swap(cell[2], cell[3]);
    result.cells.push_back(cell);
    result.label.push_back(label);
  }
  return result;
}

/// In the child process: never returns.
[[noreturn]] void work(Input& input, std::string& switches, std::FILE* cells, std::FILE* printed) {
  for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) dup2(fileno(printed), stream);
  std::setvbuf(stdout, nullptr, _IONBF, 0);  // what was printed must survive a crash
  for (const int sign : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE}) std::signal(sign, SIG_DFL);
  const rlimit no_core_file{0, 0};
  setrlimit(RLIMIT_CORE, &no_core_file);
  int code = 0;
  try {
    tetgenbehavior behaviour;
    tetgenio output;
    if (!behaviour.parse_commandline(switches.data())) _exit(refused);
    tetrahedralize(&behaviour, &input.io, &output);
    write_output(cells, output);
  } catch (const int thrown) {
    code = thrown;
  } catch (...) {
    code = refused;
  }
  _exit(code);
}

std::string first_line(std::FILE* file) {
  std::rewind(file);
  std::array<char, 200> line{};
  if (std::fgets(line.data(), static_cast<int>(line.size()), file) == nullptr) return "";
  std::string text = line.data();
  while (!text.empty() && (text.back() == '\n' || text.back() == '.')) text.pop_back();
  return text;
}

/// What went wrong, from how the child ended; empty if nothing did.
std::string failure(int status, std::FILE* printed) {
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return "";
  const std::string line = first_line(printed);
  const std::string said = line.empty() ? "" : ": " + line;
  if (!WIFEXITED(status)) return fmt::format("gave up by signal {}{}", WTERMSIG(status), said);
  const int code = WEXITSTATUS(status);
  const auto known = std::find_if(meanings.begin(), meanings.end(), [&](const auto& m) { return m.first == code; });
  if (known != meanings.end()) return std::string(known->second) + said;
  return fmt::format("internal error {}{}", code, said);
}

/// TetGen runs in a process of its own: when it gives up, it frees its memory twice, and its assertions abort.
LabelledCells run(Input& input, std::string switches, std::int32_t last_label) {
  const Scratch cells, printed;
  std::fflush(stdout);
  const pid_t child = fork();
  if (child < 0) throw UserError("no process for TetGen", "mesh", "end other programs");
  if (child == 0) work(input, switches, cells.file, printed.file);
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) throw std::runtime_error("TetGen's process is lost");
  const std::string problem = failure(status, printed.file);
  if (!problem.empty())
    throw UserError("TetGen: " + problem, "recipe, [mesh], backend = \"tetgen\"",
                    "use \"lattice\", or look at the label map for regions that touch in a point");
  return read_output(cells.file, last_label);
}

}  // namespace

bool has_tetgen() { return true; }

LabelledCells fill_surfaces(const SurfaceComplex& surfaces, const std::function<double(const Vec3&)>& edge_mm,
                            const FillSettings& settings) {
  if (surfaces.faces.empty() || surfaces.seeds.empty()) return {};
  Input input(surfaces);
  sizes = {&edge_mm, settings.volume_share};
  std::int32_t last = 0;
  for (const auto& seed : surfaces.seeds) last = std::max(last, seed.label);
  // p: given surfaces, Y: their triangles stay, M: coplanar ones too, A: labels, q: quality, Q: quiet.
  auto cells = run(input, fmt::format("pYMAq{}/{}Q", settings.radius_edge_ratio, settings.min_angle_deg), last);
  if (cells.cells.empty())
    throw UserError("TetGen made no cells", "recipe, [mesh], backend = \"tetgen\"", "use \"lattice\"");
  return cells;
}

}  // namespace heartgen::adapters
