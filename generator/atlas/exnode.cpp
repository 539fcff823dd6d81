#include "generator/atlas/exnode.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "generator/atlas/axis_tensor.hpp"
#include "model/error.hpp"

namespace heart::atlas {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t corners = 8;
constexpr std::array<std::size_t, 3> divisions{10, 8, 6};  // of an element of a heart's wall: cells of about 2 mm

// ---- text ----

struct Lines {
  std::string path;
  std::vector<std::string> line;
  std::size_t at = 0;

  bool done() const { return at >= line.size(); }
  [[noreturn]] void fail(const std::string& what) const {
    throw UserError(what, fmt::format("{}:{}", path, std::min(at, line.size()) + 1),
                    "give .exnode and .exelem files of hexahedra with Lagrange and Hermite bases");
  }
};

Lines read_lines(const std::string& path) {
  constexpr std::size_t block = 1 << 16, most_bytes = std::size_t{1} << 28;
  Lines lines{path, {}, 0};
  gzFile file = gzopen(path.c_str(), "rb");
  if (!file) throw UserError("cannot be read", path, "check the path");
  std::string text(block, '\0');
  std::size_t size = 0;
  int got = 0;
  while ((got = gzread(file, text.data() + size, block)) > 0 && size < most_bytes) {
    size += static_cast<std::size_t>(got);
    text.resize(size + block);
  }
  gzclose(file);
  if (got != 0) throw UserError("is damaged or larger than 256 MB", path, "check the file");
  text.resize(size);
  for (std::size_t from = 0; from < text.size();) {
    const auto end = std::min(text.find('\n', from), text.size());
    lines.line.push_back(text.substr(from, end - from));
    if (!lines.line.back().empty() && lines.line.back().back() == '\r') lines.line.back().pop_back();
    from = end + 1;
  }
  return lines;
}

bool has(std::string_view text, std::string_view part) { return text.find(part) != std::string_view::npos; }

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
  return first == std::string_view::npos ? std::string_view{} : text.substr(first, last - first + 1);
}

/// Numbers at the start of a text, separated by blanks, up to anything else.
template <class T>
std::vector<T> leading_numbers(std::string_view text) {
  std::vector<T> numbers;
  for (;;) {
    text = trimmed(text);
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || text.empty()) return numbers;
    numbers.push_back(value);
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  }
}

/// The number behind a key such as "#Derivatives="; empty where the key or the number is missing.
template <class T>
std::optional<T> number_behind(std::string_view text, std::string_view key) {
  const auto at = text.find(key);
  if (at == std::string_view::npos) return std::nullopt;
  const auto numbers = leading_numbers<T>(text.substr(at + key.size()));
  return numbers.empty() ? std::nullopt : std::optional<T>(numbers.front());
}

/// Numbers of this line (behind `key`) and of the following ones as long as they hold nothing else.
template <class T>
std::vector<T> numbers_over_lines(Lines& lines) {
  std::vector<T> all;
  for (; !lines.done(); ++lines.at) {
    const auto numbers = leading_numbers<T>(lines.line[lines.at]);
    if (numbers.empty()) break;
    all.insert(all.end(), numbers.begin(), numbers.end());
  }
  return all;
}

/// "  fibre angle.  rest" becomes "fibre angle" and "rest".
std::optional<std::pair<std::string, std::string_view>> component_line(std::string_view line) {
  const auto dot = line.find(".  ");
  if (dot == std::string_view::npos) return std::nullopt;
  return std::pair{std::string(trimmed(line.substr(0, dot))), trimmed(line.substr(dot + 1))};
}

/// " 1) coordinates, coordinate, …" names a field.
std::optional<std::string> field_line(std::string_view line) {
  const auto text = trimmed(line);
  const auto bracket = text.find(')');
  if (bracket == std::string_view::npos || bracket == 0 || bracket > 3 || text[0] < '0' || text[0] > '9')
    return std::nullopt;
  return std::string(trimmed(text.substr(bracket + 1, text.find(',') - bracket - 1)));
}

// ---- nodes ----

struct ExNode {
  std::size_t layout = 0;  ///< which layout its values have
  std::vector<double> values;
};

struct NodeFile {
  /// Where a component ("field/component") begins in a node's values.
  std::vector<std::map<std::string, std::size_t>> layouts;
  std::map<int, ExNode> nodes;
};

NodeFile read_nodes(const std::string& path) {
  Lines lines = read_lines(path);
  NodeFile file;
  std::string field;
  while (!lines.done()) {
    const std::string& line = lines.line[lines.at];
    if (has(line, "#Fields")) {
      file.layouts.emplace_back();
    } else if (const auto name = field_line(line)) {
      field = *name;
    } else if (const auto start = number_behind<std::size_t>(line, "Value index=")) {
      const auto component = component_line(line);
      if (!component || file.layouts.empty() || *start == 0) lines.fail("a component of a node cannot be understood");
      file.layouts.back()[field + "/" + component->first] = *start - 1;
    } else if (const auto id = number_behind<int>(line, "Node:")) {
      if (file.layouts.empty()) lines.fail("a node comes before any #Fields");
      ++lines.at;
      file.nodes[*id] = {file.layouts.size() - 1, numbers_over_lines<double>(lines)};
      continue;
    }
    ++lines.at;
  }
  if (file.nodes.empty()) lines.fail("there are no nodes in the file");
  return file;
}

// ---- elements ----

/// How a component follows from the values at the corners.
struct ExComponent {
  std::string name;                                            ///< "field/component"
  std::array<bool, 3> hermite{};                               ///< along each axis; else linear
  bool decreasing = false;                                     ///< an angle that must fall along xi1
  std::array<std::vector<std::size_t>, corners> value, scale;  ///< 0-based places
  std::array<std::size_t, corners> node{};  ///< 0-based place in the element's list: fewer nodes where it is collapsed
};

struct ElementKind {
  bool prolate = false;
  double focus = 0;
  std::array<std::string, 3> coordinate, angle;  ///< names of components
  std::vector<ExComponent> components;
};

struct ExElement {
  std::size_t kind = 0;
  std::vector<int> nodes;
  std::vector<double> scale;
};

struct ElementFile {
  std::vector<ElementKind> kinds;
  std::vector<ExElement> elements;
};

std::array<bool, 3> basis_of(const Lines& lines, std::string_view text) {
  std::array<bool, 3> hermite{};
  std::string_view basis = text.substr(0, text.find(','));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto one = basis.substr(0, basis.find('*'));
    if (one != "c.Hermite" && one != "l.Lagrange") lines.fail(fmt::format("basis \"{}\" is not known", one));
    hermite[axis] = one == "c.Hermite";
    basis.remove_prefix(std::min(basis.size(), one.size() + 1));
  }
  return hermite;
}

std::vector<std::size_t> places(const Lines& lines, std::string_view key) {
  const auto& line = lines.line[lines.at];
  const auto at = line.find(key);
  auto numbers = leading_numbers<std::size_t>(std::string_view(line).substr(at + key.size()));
  for (auto& n : numbers) {
    if (n == 0) lines.fail("indices begin at 1");
    --n;
  }
  return numbers;
}

void start_field(const Lines& lines, const std::string& line, const std::string& field, ElementKind& kind,
                 std::array<std::string, 3>*& names) {
  names = nullptr;
  if (has(line, "anatomical")) names = &kind.angle;
  if (!has(line, ", coordinate,")) return;
  names = &kind.coordinate;
  kind.prolate = has(line, "prolate spheroidal");
  if (!kind.prolate && !has(line, "rectangular cartesian"))
    lines.fail("coordinates must be prolate spheroidal or rectangular cartesian");
  kind.focus = number_behind<double>(line, "focus=").value_or(1);
  if (field.empty()) lines.fail("a field without a name");
}

/// Header of elements, from "#Scale factor sets" to the first element.
ElementKind read_kind(Lines& lines) {
  ElementKind kind;
  std::string field;
  std::array<std::string, 3>* names = nullptr;
  std::size_t component = 0, corner = 0;
  for (; !lines.done() && !has(lines.line[lines.at], "Element:"); ++lines.at) {
    const std::string& line = lines.line[lines.at];
    if (const auto name = field_line(line)) {
      field = *name, component = 0;
      start_field(lines, line, field, kind, names);
    } else if (has(line, "node based")) {
      const auto parts = component_line(line);
      if (!parts) lines.fail("a component of an element cannot be understood");
      ExComponent one;
      one.name = field + "/" + parts->first;
      one.hermite = basis_of(lines, parts->second);
      one.decreasing = has(parts->second, "decreasing in xi1");
      if (names && component < 3) (*names)[component++] = one.name;
      kind.components.push_back(std::move(one));
      corner = 0;
    } else if (has(line, "#Values=") && !kind.components.empty() && corner < corners) {
      const auto place = leading_numbers<std::size_t>(line);
      if (place.empty() || place[0] == 0) lines.fail("a corner's node cannot be understood");
      kind.components.back().node[corner] = place[0] - 1;
    } else if (has(line, "Value indices:") || has(line, "Scale factor indices:")) {
      if (kind.components.empty() || corner >= corners) lines.fail("indices belong to no corner");
      const bool values = has(line, "Value indices:");
      (values ? kind.components.back().value : kind.components.back().scale)[corner] =
          places(lines, values ? "Value indices:" : "factor indices:");
      if (!values) ++corner;
    }
  }
  return kind;
}

ExElement read_element(Lines& lines, std::size_t kind) {
  ExElement element;
  element.kind = kind;
  for (++lines.at; !lines.done(); ++lines.at) {
    const std::string& line = lines.line[lines.at];
    if (has(line, "Nodes:") && !has(line, "#")) {
      ++lines.at;
      element.nodes = numbers_over_lines<int>(lines);
      --lines.at;
    } else if (has(line, "Scale factors:")) {
      ++lines.at;
      element.scale = numbers_over_lines<double>(lines);
      break;
    } else if (has(line, "Element:") || has(line, "#")) {
      break;
    }
  }
  if (element.nodes.empty()) lines.fail("an element has no nodes");
  return element;
}

ElementFile read_elements(const std::string& path) {
  Lines lines = read_lines(path);
  ElementFile file;
  bool solid = false;
  while (!lines.done()) {
    const std::string& line = lines.line[lines.at];
    if (const auto dimension = number_behind<int>(line, "Dimension=")) solid = *dimension == 3;
    if (solid && has(line, "#Scale factor sets")) {
      file.kinds.push_back(read_kind(lines));
      continue;
    }
    if (solid && has(line, "Element:")) {
      if (file.kinds.empty()) lines.fail("an element comes before any #Fields");
      file.elements.push_back(read_element(lines, file.kinds.size() - 1));
      continue;
    }
    ++lines.at;
  }
  if (file.elements.empty()) lines.fail("there are no three-dimensional elements in the file");
  return file;
}

// ---- evaluation ----

/// What each corner contributes: its values times scale factors, in the order value, d/ds of the first Hermite axis, of
/// the second, of both, and so on.
using Contributions = std::array<std::vector<double>, corners>;

[[noreturn]] void fail_element(const std::string& path, const std::string& what) {
  throw UserError(what, path, "check that the .exnode and .exelem files belong together");
}

/// An angle falls along xi1, and the element's four edges in that direction lie in the same turn.
void unwind(Contributions& angle) {
  constexpr double turn = 2 * std::numbers::pi;
  for (std::size_t c = 0; c < corners; c += 2) {
    auto &first = angle[c][0], &second = angle[c + 1][0];
    if (first < second) first += turn;
    const double turns = std::round((angle[0][0] + angle[1][0] - first - second) / (2 * turn));
    first += turns * turn;
    second += turns * turn;
  }
}

Contributions contributions(const std::string& path, const NodeFile& nodes, const ExElement& element,
                            const ExComponent& component) {
  Contributions all;
  const auto wanted = std::size_t{1} << std::count(component.hermite.begin(), component.hermite.end(), true);
  for (std::size_t c = 0; c < corners; ++c) {
    const auto local = component.node[c];
    const auto node = local < element.nodes.size() ? nodes.nodes.find(element.nodes[local]) : nodes.nodes.end();
    if (node == nodes.nodes.end()) fail_element(path, "an element names a node that does not exist");
    const auto& layout = nodes.layouts[node->second.layout];
    const auto start = layout.find(component.name);
    if (start == layout.end() || component.value[c].size() != wanted || component.scale[c].size() != wanted)
      fail_element(path, fmt::format("values of \"{}\" are missing", component.name));
    for (std::size_t v = 0; v < wanted; ++v) {
      const auto at = start->second + component.value[c][v], scale = component.scale[c][v];
      if (at >= node->second.values.size() || scale >= element.scale.size())
        fail_element(path, fmt::format("values of \"{}\" end early", component.name));
      all[c].push_back(node->second.values[at] * element.scale[scale]);
    }
  }
  if (component.decreasing) unwind(all);
  return all;
}

/// One-dimensional basis function of an end (0 or 1), of its value or its derivative, and that function's slope.
struct Basis {
  double value, slope;
};

Basis basis_at(bool hermite, bool end, bool derivative, double x) {
  if (!hermite) return end ? Basis{x, 1} : Basis{1 - x, -1};
  if (!derivative)
    return end ? Basis{x * x * (3 - 2 * x), 6 * x * (1 - x)} : Basis{1 - x * x * (3 - 2 * x), 6 * x * (x - 1)};
  return end ? Basis{x * x * (x - 1), x * (3 * x - 2)} : Basis{x * (1 - x) * (1 - x), (1 - x) * (1 - 3 * x)};
}

/// A component and its derivatives by xi.
struct Jet {
  double value = 0;
  std::array<double, 3> slope{};
};

Jet evaluate(const ExComponent& component, const Contributions& from, const Vec3& xi) {
  Jet jet;
  for (std::size_t c = 0; c < corners; ++c)
    for (std::size_t v = 0; v < from[c].size(); ++v) {
      std::array<Basis, 3> basis;
      std::size_t bits = v;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const bool derivative = component.hermite[axis] && (bits & 1);
        if (component.hermite[axis]) bits >>= 1;
        basis[axis] = basis_at(component.hermite[axis], (c >> axis) & 1, derivative, xi[static_cast<int>(axis)]);
      }
      jet.value += from[c][v] * basis[0].value * basis[1].value * basis[2].value;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t b = (axis + 1) % 3, d = (axis + 2) % 3;
        jet.slope[axis] += from[c][v] * basis[axis].slope * basis[b].value * basis[d].value;
      }
    }
  return jet;
}

/// Position and its derivatives by xi.
struct Place {
  Vec3 position;
  std::array<Vec3, 3> slope;
};

Place place_of(const ElementKind& kind, const std::array<Jet, 3>& c) {
  Place place;
  if (!kind.prolate) {
    place.position = {c[0].value, c[1].value, c[2].value};
    for (std::size_t a = 0; a < 3; ++a) place.slope[a] = {c[0].slope[a], c[1].slope[a], c[2].slope[a]};
    return place;
  }
  const double f = kind.focus, ch = std::cosh(c[0].value), sh = std::sinh(c[0].value);
  const double cm = std::cos(c[1].value), sm = std::sin(c[1].value);
  const double ct = std::cos(c[2].value), st = std::sin(c[2].value);
  place.position = f * Vec3{ch * cm, sh * sm * ct, sh * sm * st};
  for (std::size_t a = 0; a < 3; ++a)
    place.slope[a] = (f * c[0].slope[a]) * Vec3{sh * cm, ch * sm * ct, ch * sm * st} +
                     (f * c[1].slope[a]) * Vec3{-ch * sm, sh * cm * ct, sh * cm * st} +
                     (f * c[2].slope[a]) * Vec3{0, -sh * sm * st, sh * sm * ct};
  return place;
}

/// Zero where the element is collapsed.
Vec3 fiber_of(const Place& place, double fiber_angle, double imbrication_angle) {
  const Vec3 along = normalized(place.slope[0]), normal = normalized(cross(along, place.slope[1]));
  const Vec3 fiber = std::cos(fiber_angle) * along + std::sin(fiber_angle) * cross(normal, along);
  return normal == Vec3{} ? Vec3{} : std::cos(imbrication_angle) * fiber + std::sin(imbrication_angle) * normal;
}

/// One element with the contributions of its coordinates and angles.
struct Evaluator {
  const ElementKind& kind;
  std::array<const ExComponent*, 3> coordinate{};
  std::array<Contributions, 3> position;
  std::array<const ExComponent*, 2> angle{};  ///< fibre and imbrication
  std::array<Contributions, 2> turn;

  Evaluator(const std::string& path, const NodeFile& nodes, const ElementFile& file, const ExElement& element)
      : kind(file.kinds[element.kind]) {
    const auto find = [&](const std::string& name) {
      const auto at = std::find_if(kind.components.begin(), kind.components.end(),
                                   [&](const ExComponent& c) { return c.name == name; });
      if (name.empty() || at == kind.components.end())
        fail_element(path, "an element lacks coordinates or an anatomical field of fibre angles");
      return &*at;
    };
    for (std::size_t a = 0; a < 3; ++a) {
      coordinate[a] = find(kind.coordinate[a]);
      position[a] = contributions(path, nodes, element, *coordinate[a]);
    }
    for (std::size_t a = 0; a < 2; ++a) {
      angle[a] = find(kind.angle[a]);
      turn[a] = contributions(path, nodes, element, *angle[a]);
    }
  }

  Place place(const Vec3& xi) const {
    std::array<Jet, 3> jets;
    for (std::size_t a = 0; a < 3; ++a) jets[a] = evaluate(*coordinate[a], position[a], xi);
    return place_of(kind, jets);
  }
  Vec3 fiber(const Vec3& xi) const {
    return fiber_of(place(xi), evaluate(*angle[0], turn[0], xi).value, evaluate(*angle[1], turn[1], xi).value);
  }
};

// ---- tetrahedra ----

/// Points closer than this are one: neighbouring elements share their faces.
constexpr double same_point_mm = 1e-3;

struct Builder {
  std::map<std::array<std::int64_t, 3>, std::int32_t> ids;
  std::vector<Vec3> points;
  std::vector<AxisTensor> axes;
  std::vector<Cell> cells;

  std::int32_t add(const Vec3& p, const Vec3& fiber) {
    std::array<std::int64_t, 3> key;
    for (std::size_t a = 0; a < 3; ++a) key[a] = std::llround(p[static_cast<int>(a)] / same_point_mm);
    const auto [at, is_new] = ids.try_emplace(key, static_cast<std::int32_t>(points.size()));
    if (is_new) points.push_back(p), axes.emplace_back();
    axes[static_cast<std::size_t>(at->second)] += axis_tensor(fiber);
    return at->second;
  }

  /// Six tetrahedra around the diagonal from the first to the last corner; flat ones are left out.
  void add_brick(const std::array<std::int32_t, corners>& corner) {
    constexpr double least_volume_mm3 = 1e-6;
    constexpr std::array<std::array<std::size_t, 4>, 6> split{
        {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}}};
    for (const auto& four : split) {
      Cell cell;
      std::array<Vec3, 4> p;
      for (std::size_t k = 0; k < 4; ++k) {
        cell[k] = corner[four[k]];
        p[k] = points[static_cast<std::size_t>(cell[k])];
      }
      if (std::abs(dot(p[1] - p[0], cross(p[2] - p[0], p[3] - p[0]))) > 6 * least_volume_mm3) cells.push_back(cell);
    }
  }

  void add_element(const Evaluator& element) {
    const std::size_t n1 = divisions[0], n2 = divisions[1], n3 = divisions[2];
    std::vector<std::int32_t> id;
    for (std::size_t k = 0; k <= n3; ++k)
      for (std::size_t j = 0; j <= n2; ++j)
        for (std::size_t i = 0; i <= n1; ++i) {
          const Vec3 xi{static_cast<double>(i) / static_cast<double>(n1),
                        static_cast<double>(j) / static_cast<double>(n2),
                        static_cast<double>(k) / static_cast<double>(n3)};
          id.push_back(add(element.place(xi).position, element.fiber(xi)));
        }
    for (std::size_t k = 0; k < n3; ++k)
      for (std::size_t j = 0; j < n2; ++j)
        for (std::size_t i = 0; i < n1; ++i) {
          std::array<std::int32_t, corners> corner;
          for (std::size_t c = 0; c < corners; ++c)
            corner[c] = id[((k + (c >> 2)) * (n2 + 1) + j + ((c >> 1) & 1)) * (n1 + 1) + i + (c & 1)];
          add_brick(corner);
        }
  }
};

/// "heart.exnode.gz" and ".exelem" become "heart.exelem.gz", or "heart.exelem" where only that exists.
std::string partner(const std::string& path, const std::string& from, const std::string& to) {
  std::string other = path;
  other.replace(other.rfind(from), from.size(), to);
  if (fs::exists(other)) return other;
  const std::string zipped = ".gz";
  const bool ends = other.ends_with(zipped);
  const std::string second = ends ? other.substr(0, other.size() - zipped.size()) : other + zipped;
  return fs::exists(second) ? second : other;
}

}  // namespace

bool is_exnode_path(const std::string& path) {
  for (const char* ending : {".exnode", ".exelem", ".exnode.gz", ".exelem.gz"})
    if (path.ends_with(ending)) return true;
  return false;
}

FiberAtlas read_exnode_atlas(const std::string& path) {
  const bool is_node = path.rfind(".exnode") != std::string::npos && path.rfind(".exelem") == std::string::npos;
  const std::string node_path = is_node ? path : partner(path, ".exelem", ".exnode");
  const std::string element_path = is_node ? partner(path, ".exnode", ".exelem") : path;
  const NodeFile nodes = read_nodes(node_path);
  const ElementFile elements = read_elements(element_path);
  Builder builder;
  for (const auto& element : elements.elements) builder.add_element(Evaluator(element_path, nodes, elements, element));
  std::vector<Vec3> fibers;
  for (const auto& tensor : builder.axes) fibers.push_back(leading_axis(tensor));
  auto atlas = make_fiber_atlas(path, std::move(builder.points), std::move(builder.cells), fibers);
  atlas.name = fs::path(path).filename().string();
  return atlas;
}

}  // namespace heart::atlas
