// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/atlas/exnode_text.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>
#include <utility>

#include "model/error.hpp"
#include "model/input_file.hpp"

namespace heartgen::atlas::exnode {
namespace {

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
  constexpr std::size_t block = 1 << 16, max_bytes = std::size_t{1} << 28;
  Lines lines{path, {}, 0};
  require_input_file(path);
  gzFile file = gzopen(path.c_str(), "rb");
  if (!file) throw UserError("cannot be read", path, "check the path");
  std::string text(block, '\0');
  std::size_t size = 0;
  int got = 0;
  while ((got = gzread(file, text.data() + size, block)) > 0 && size < max_bytes) {
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

}  // namespace

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

}  // namespace heartgen::atlas::exnode
