// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/recipe.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "model/error.hpp"
#include "model/input_file.hpp"
#include "model/labels.hpp"
#include "model/text.hpp"
#include "model/toml_text.hpp"

namespace heartgen {
namespace {

namespace fs = std::filesystem;

/// How the names of lengths, volumes and shares end.
constexpr const char* never_negative[] = {"_mm", "_radii", "_ml", "_hu", "_gap", "_fraction"};

// ---- reading ----

bool assign(const toml::node& node, std::string& value) {
  if (const auto* text = node.as_string()) return value = text->get(), true;
  return false;
}
bool assign(const toml::node& node, int& value) {
  const auto* number = node.as_integer();
  if (!number || !std::in_range<int>(number->get())) return false;
  value = static_cast<int>(number->get());
  return true;
}
bool assign(const toml::node& node, double& value) {
  if (const auto number = node.value<double>(); number && node.is_number()) return value = *number, true;
  return false;
}
bool assign(const toml::node& node, bool& value) {
  if (const auto* flag = node.as_boolean()) return value = flag->get(), true;
  return false;
}
template <class T>
bool assign(const toml::node& node, std::vector<T>& values) {
  const auto* array = node.as_array();
  if (!array) return false;
  values.clear();
  for (const auto& element : *array)
    if (!assign(element, values.emplace_back())) return false;
  return true;
}
bool assign(const toml::node& node, LabelKeys& value) {
  const auto* array = node.as_array();
  if (!array) return false;
  value.keys.clear();
  for (const auto& element : *array) {
    int number = 0;
    if (assign(element, number))
      value.keys.push_back(std::to_string(number));
    else if (!assign(element, value.keys.emplace_back()))
      return false;
  }
  return true;
}
bool assign(const toml::node& node, Vec3& value) {
  std::vector<double> numbers;
  if (!assign(node, numbers) || numbers.size() != 3) return false;
  value = {numbers[0], numbers[1], numbers[2]};
  return true;
}

const char* expected(const std::string&) { return "a text in quotes"; }
const char* expected(bool) { return "true or false"; }
const char* expected(int) { return "a whole number"; }
const char* expected(double) { return "a number"; }
const char* expected(const std::vector<std::string>&) { return "a list of texts"; }
const char* expected(const std::vector<int>&) { return "a list of whole numbers"; }
const char* expected(const std::vector<double>&) { return "a list of numbers"; }
const char* expected(const LabelKeys&) { return "a list of values or names"; }
const char* expected(const Vec3&) { return "three numbers [x, y, z] in LPS mm"; }

/// What no setting of that name can be; nullptr: nothing is wrong with it. Bounds that need more knowledge are checked
/// by those who use the setting.
template <class T>
const char* mistake_in(const std::string&, const T&) {
  return nullptr;
}
const char* mistake_in(const std::string& key, double value) {
  if (!std::isfinite(value)) return "must be finite";
  const bool measures = std::any_of(std::begin(never_negative), std::end(never_negative),
                                    [&](const char* ending) { return key.ends_with(ending); });
  return measures && value < 0 ? "must not be negative" : nullptr;
}
const char* mistake_in(const std::string&, int value) { return value < 0 ? "must not be negative" : nullptr; }
const char* mistake_in(const std::string&, const std::vector<int>& values) {
  return std::any_of(values.begin(), values.end(), [](int v) { return v < 0; }) ? "must not be negative" : nullptr;
}
const char* mistake_in(const std::string&, const Vec3& v) {
  return std::isfinite(v.x + v.y + v.z) ? nullptr : "must be finite";
}

std::string place(const std::string& path, const toml::node& node) {
  return fmt::format("{}:{}", path, node.source().begin.line);
}

/// Takes keys out of one table; what is left over at the end is unknown.
struct Section {
  const toml::table& table;
  std::string path;  // of the recipe
  std::string name;  // "epicardium", "" for the top level
  std::vector<std::string> known{};

  std::string full(const std::string& key) const { return name.empty() ? key : name + "." + key; }

  template <class T>
  void take(const std::string& key, T& value) {
    known.push_back(key);
    const auto* node = table.get(key);
    if (!node) return;
    if (!assign(*node, value))
      throw UserError(fmt::format("key \"{}\" must be {}", full(key), expected(value)), place(path, *node),
                      "correct the recipe");
    if (const char* mistake = mistake_in(key, value))
      throw UserError(fmt::format("key \"{}\" {}", full(key), mistake), place(path, *node), "correct the recipe");
  }

  const toml::table* subtable(const std::string& key) {
    known.push_back(key);
    const auto* node = table.get(key);
    if (!node) return nullptr;
    if (!node->is_table())
      throw UserError(fmt::format("\"{}\" must be a section", full(key)), place(path, *node),
                      "write [" + full(key) + "]");
    return node->as_table();
  }

  void refuse_unknown() const {
    for (const auto& [key, node] : table) {
      const std::string text(key.str());
      if (std::find(known.begin(), known.end(), text) == known.end())
        throw UserError(fmt::format("unknown key \"{}\"", full(text)), place(path, node),
                        fmt::format("did you mean \"{}\"?", full(nearest_name(text, known))));
    }
  }
};

template <class Settings>
void read_settings(const toml::table& table, const std::string& path, const std::string& name, Settings& settings) {
  Section section{table, path, name};
  Settings::describe([&](const char* key, auto& value, const char*) { section.take(key, value); }, settings);
  section.refuse_unknown();
}

template <class Settings>
void read_section(Section& top, const std::string& name, Settings& settings) {
  if (const auto* table = top.subtable(name)) read_settings(*table, top.path, name, settings);
}

void read_valve(const toml::table& table, const std::string& path, const std::string& name, ValvePlane& valve) {
  Section section{table, path, "landmarks.valves." + name};
  section.take("center_mm", valve.center_mm);
  section.take("normal", valve.normal);
  section.take("radius_mm", valve.radius_mm);
  section.refuse_unknown();
}

void read_landmark_section(Section& top, Landmarks& landmarks) {
  const auto* table = top.subtable("landmarks");
  if (!table) return;
  Section section{*table, top.path, "landmarks"};
  if (const auto* seeds = section.subtable("seeds_mm"))
    for (const auto& [key, node] : *seeds) {
      Section seed{*seeds, top.path, "landmarks.seeds_mm"};
      seed.take(std::string(key.str()), landmarks.seeds_mm[std::string(key.str())]);
    }
  if (const auto* valves = section.subtable("valves"))
    for (const auto& [key, node] : *valves) {
      if (!node.is_table())
        throw UserError("a valve must be a section", place(top.path, node), "write [landmarks.valves.mitral]");
      read_valve(*node.as_table(), top.path, std::string(key.str()), landmarks.valves[std::string(key.str())]);
    }
  Vec3 apex;
  section.take("lv_apex_mm", apex);
  if (table->contains("lv_apex_mm")) landmarks.lv_apex_mm = apex;
  section.refuse_unknown();
}

void read_label_section(Section& top, LabelSettings& labels) {
  const auto* table = top.subtable("labels");
  if (!table) return;
  Section section{*table, top.path, "labels"};
  if (const auto* regions = section.subtable("regions")) {
    Section names{*regions, top.path, "labels.regions"};
    for (const auto& region : region_table()) {
      if (!is_label(static_cast<Region>(region.tag))) continue;
      const std::string name(region.name);
      if (regions->contains(name))
        names.take(name, labels.regions[name]);
      else
        names.known.push_back(name);
    }
    names.refuse_unknown();
    labels.preset = "none";  // unless the recipe names one: what the user maps is all there is
  }
  LabelSettings::describe([&](const char* key, auto& value, const char*) { section.take(key, value); }, labels);
  section.refuse_unknown();
}

void read_fiber_section(Section& top, FiberSettings& fibers) {
  const auto* table = top.subtable("fibers");
  if (!table) return;
  Section section{*table, top.path, "fibers"};
  if (const auto* rule = section.subtable("rule")) read_settings(*rule, top.path, "fibers.rule", fibers.rule);
  FiberSettings::describe([&](const char* key, auto& value, const char*) { section.take(key, value); }, fibers);
  section.refuse_unknown();
}

/// [[name]], as often as there are entries.
template <class Settings>
void read_list(Section& top, const std::string& name, std::vector<Settings>& entries) {
  top.known.push_back(name);
  const auto* node = top.table.get(name);
  if (!node) return;
  const auto remedy = fmt::format("write [[{}]] for each", name);
  const auto* array = node->as_array();
  if (!array) throw UserError(fmt::format("\"{}\" must be a list of sections", name), place(top.path, *node), remedy);
  entries.clear();
  for (const auto& element : *array) {
    if (!element.is_table())
      throw UserError(fmt::format("an entry of \"{}\" must be a section", name), place(top.path, element), remedy);
    read_settings(*element.as_table(), top.path, name, entries.emplace_back());
  }
}

void resolve(std::string& file, const fs::path& folder) {
  if (!file.empty() && fs::path(file).is_relative()) file = (folder / file).lexically_normal().string();
}

// ---- writing ----

std::string toml_text(const std::string& value) {
  std::string text = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') text += '\\';
    if (static_cast<unsigned char>(c) < 0x20)
      text += fmt::format("\\u{:04x}", static_cast<int>(c));
    else
      text += c;
  }
  return text + "\"";
}
std::string toml_text(bool value) { return value ? "true" : "false"; }
std::string toml_text(int value) { return std::to_string(value); }
std::string toml_text(double value) { return number_text(value); }
std::string toml_text(const Vec3& v) {
  return fmt::format("[{}, {}, {}]", number_text(v.x), number_text(v.y), number_text(v.z));
}
template <class T>
std::string toml_text(const std::vector<T>& values) {
  std::string text = "[";
  for (const auto& value : values) text += (text.size() > 1 ? ", " : "") + toml_text(value);
  return text + "]";
}
std::string toml_text(const LabelKeys& value) { return toml_text(value.keys); }

template <class Settings>
std::string settings_text(const std::string& header, const Settings& settings) {
  std::string text = "\n" + header + "\n";
  Settings::describe(
      [&](const char* key, const auto& value, const char* meaning) {
        text += fmt::format("{} = {}  # {}\n", key, toml_text(value), meaning);
      },
      settings);
  return text;
}

std::string landmarks_text(const Landmarks& landmarks) {
  std::string text = "\n[landmarks]\n";
  if (landmarks.lv_apex_mm) text += "lv_apex_mm = " + toml_text(*landmarks.lv_apex_mm) + "\n";
  text += "\n[landmarks.seeds_mm]\n";
  for (const auto& [name, point] : landmarks.seeds_mm) text += name + " = " + toml_text(point) + "\n";
  for (const auto& [name, valve] : landmarks.valves)
    text += fmt::format("\n[landmarks.valves.{}]\ncenter_mm = {}\nnormal = {}\nradius_mm = {}\n", name,
                        toml_text(valve.center_mm), toml_text(valve.normal), toml_text(valve.radius_mm));
  return text;
}

std::string labels_text(const LabelSettings& labels) {
  std::string text = settings_text("[labels]", labels) + "\n[labels.regions]\n";
  for (const auto& [region, values] : labels.regions) text += region + " = " + toml_text(values) + "\n";
  return text;
}

void drop_folder(const char*, std::string& value, const char*) {
  const fs::path path = value;
  value = (path.has_filename() ? path : path.parent_path()).filename().string();  // "masks/" is a folder
}

template <class Paths>
Paths without_folders(Paths paths) {
  Paths::describe(drop_folder, paths);
  return paths;
}

}  // namespace

std::vector<SegmentationStep> default_segmentation() {
  SegmentationStep body{.name = "body", .mu = 0};
  SegmentationStep soft{.name = "soft", .domain = "body.above", .mu = 0.05};
  SegmentationStep blood{.name = "blood", .domain = "soft.above", .mu = 0.1};
  return {body, soft, blood};
}

ValidationSettings bounds_of(const Recipe& recipe) {
  auto bounds = recipe.validation;
  if (recipe.fibers.method == "rule") bounds.maximum_inpainted_fraction = 1;
  const bool is_lattice = recipe.mesh.backend == MeshSettings{}.backend;
  if (is_lattice && bounds.minimum_dihedral_deg == 0) bounds.minimum_dihedral_deg = 25;
  if (is_lattice && bounds.maximum_dihedral_deg == 0) bounds.maximum_dihedral_deg = 145;
  return bounds;
}

Recipe read_recipe(const std::string& path) {
  require_input_file(path);
  toml::table table;
  try {
    table = toml::parse(checked_toml(path), path);
  } catch (const toml::parse_error& error) {
    throw UserError(fmt::format("not valid TOML: {}", error.description()),
                    fmt::format("{}:{}", path, error.source().begin.line), "correct the recipe");
  }
  Recipe recipe;
  recipe.segmentation = default_segmentation();
  Section top{table, path, ""};
  for (auto [key, value] : {std::pair{"name", &recipe.name},
                            {"version", &recipe.version},
                            {"license", &recipe.license},
                            {"author", &recipe.author},
                            {"attribution", &recipe.attribution},
                            {"date_published", &recipe.date_published}})
    top.take(key, *value);
  top.take("synthetic_image", recipe.synthetic_image);
  read_section(top, "input", recipe.input);
  const fs::path folder = fs::path(path).parent_path();
  InputSettings::describe_files([&](const char*, std::string& file, const char*) { resolve(file, folder); },
                                recipe.input);
  read_label_section(top, recipe.labels);
  read_section(top, "replace", recipe.replace);
  ReplaceSettings::describe([&](const char*, std::string& file, const char*) { resolve(file, folder); },
                            recipe.replace);
  if (!recipe.input.landmarks.empty()) recipe.landmarks = read_landmarks(recipe.input.landmarks);
  read_landmark_section(top, recipe.landmarks);
  check_landmarks(recipe.landmarks, path);
  read_section(top, "denoise", recipe.denoise);
  read_list(top, "segmentation", recipe.segmentation);
  read_section(top, "chambers", recipe.chambers);
  read_section(top, "epicardium", recipe.epicardium);
  read_section(top, "torso", recipe.torso);
  TorsoSettings::describe_files([&](const char*, std::string& file, const char*) { resolve(file, folder); },
                                recipe.torso);
  read_list(top, "regions", recipe.regions);
  for (auto& region : recipe.regions) resolve(region.file, folder);
  read_section(top, "mesh", recipe.mesh);
  read_fiber_section(top, recipe.fibers);
  read_section(top, "validation", recipe.validation);
  top.refuse_unknown();
  return recipe;
}

std::string write_recipe(const Recipe& recipe, bool file_names_only) {
  std::string text = "# heartgen recipe, every setting written out. Lengths in mm, grey values in Hounsfield units.\n";
  for (const auto& [key, value] : {std::pair{"name", recipe.name},
                                   {"version", recipe.version},
                                   {"license", recipe.license},
                                   {"author", recipe.author},
                                   {"attribution", recipe.attribution},
                                   {"date_published", recipe.date_published}})
    text += fmt::format("{} = {}\n", key, toml_text(value));
  text += fmt::format("synthetic_image = {}\n", recipe.synthetic_image);
  // The landmarks follow in full; a copied file name would be read again on top of them.
  InputSettings input = recipe.input;
  if (file_names_only) InputSettings::describe_files(drop_folder, input);
  input.landmarks.clear();
  text += settings_text("[input]", input) + labels_text(recipe.labels);
  text += settings_text("[replace]", file_names_only ? without_folders(recipe.replace) : recipe.replace);
  for (const char* section : {"landmarks", "denoise", "segmentation", "chambers", "epicardium"})
    text += recipe_section(recipe, section);
  TorsoSettings torso = recipe.torso;
  if (file_names_only) TorsoSettings::describe_files(drop_folder, torso);
  text += settings_text("[torso]", torso);
  for (RegionSettings region : recipe.regions) {
    if (file_names_only) drop_folder("", region.file, "");
    text += settings_text("[[regions]]", region);
  }
  for (const char* section : {"mesh", "fibers", "validation"}) text += recipe_section(recipe, section);
  return text;
}

std::string recipe_section(const Recipe& recipe, std::string_view section) {
  if (section == "labels") return labels_text(recipe.labels);
  if (section == "replace") return settings_text("[replace]", recipe.replace);
  if (section == "landmarks") return landmarks_text(recipe.landmarks);
  if (section == "denoise") return settings_text("[denoise]", recipe.denoise);
  if (section == "chambers") return settings_text("[chambers]", recipe.chambers);
  if (section == "epicardium") return settings_text("[epicardium]", recipe.epicardium);
  if (section == "torso") return settings_text("[torso]", recipe.torso);
  if (section == "mesh") return settings_text("[mesh]", recipe.mesh);
  if (section == "fibers")
    return settings_text("[fibers]", recipe.fibers) + settings_text("[fibers.rule]", recipe.fibers.rule);
  if (section == "validation") return settings_text("[validation]", recipe.validation);
  std::string text;
  for (const auto& step : recipe.segmentation) text += settings_text("[[segmentation]]", step);
  return text;
}

}  // namespace heartgen
