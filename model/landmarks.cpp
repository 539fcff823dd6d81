// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/landmarks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "model/error.hpp"
#include "model/input_file.hpp"
#include "model/labels.hpp"
#include "model/recipe.hpp"
#include "model/text.hpp"

namespace heartgen {
namespace {

using Json = nlohmann::ordered_json;

const std::vector<std::string> valve_names = {"mitral", "aortic", "tricuspid", "pulmonary"};

/// What `heartgen landmarks --json` tells beside the landmarks.
const std::vector<std::string> report_keys = {"confidence", "warnings", "volumes_ml", "long_axis"};

Vec3 point_from(const Json& json, const std::string& path, const std::string& key) {
  if (!json.is_array() || json.size() != 3 || !json[0].is_number() || !json[1].is_number() || !json[2].is_number())
    throw UserError(fmt::format("\"{}\" must be three numbers [x, y, z] in LPS mm", key), path, "correct the file");
  return {json[0].get<double>(), json[1].get<double>(), json[2].get<double>()};
}

Json json_from(const Vec3& v) { return Json::array({v.x, v.y, v.z}); }

ValvePlane valve_from(const Json& json, const std::string& path, const std::string& name) {
  if (!json.is_object() || !json.contains("center_mm") || !json.contains("normal") || !json.contains("radius_mm") ||
      !json["radius_mm"].is_number())
    throw UserError(fmt::format("valve \"{}\" needs center_mm, normal and radius_mm", name), path, "correct the file");
  return {point_from(json["center_mm"], path, name + ".center_mm"), point_from(json["normal"], path, name + ".normal"),
          json["radius_mm"].get<double>()};
}

void check_name(const std::string& name, const std::vector<std::string>& known, const std::string& what,
                const std::string& where) {
  if (std::find(known.begin(), known.end(), name) == known.end())
    throw UserError(fmt::format("unknown {} \"{}\"", what, name), where,
                    fmt::format("did you mean \"{}\"?", nearest_name(name, known)));
}

}  // namespace

void check_landmarks(const Landmarks& landmarks, const std::string& where) {
  std::vector<std::string> regions;
  for (const auto& row : region_table())
    if (is_label(static_cast<Region>(row.tag))) regions.emplace_back(row.name);
  for (const auto& [name, point] : landmarks.seeds_mm) check_name(name, regions, "seed", where);
  for (const auto& [name, valve] : landmarks.valves) {
    check_name(name, valve_names, "valve", where);
    if (!(norm(valve.normal) > 0) || !(valve.radius_mm > 0))
      throw UserError(fmt::format("valve \"{}\" needs a normal and a radius that are not zero", name), where,
                      "give both, the normal pointing out of the ventricle");
  }
}

Landmarks parse_landmarks(const std::string& json_text, const std::string& where) {
  const Json json = Json::parse(json_text, nullptr, false);
  if (json.is_discarded()) throw UserError("is not valid JSON", where, "correct the file");
  if (!json.is_object()) throw UserError("holds no landmarks", where, "known keys: seeds_mm, valves, lv_apex_mm");
  Landmarks landmarks;
  for (const auto& [key, value] : json.items()) {
    if ((key == "seeds_mm" || key == "valves") && !value.is_object())
      throw UserError(fmt::format("\"{}\" must hold names", key), where, "correct the file");
    if (key == "seeds_mm")
      for (const auto& [name, point] : value.items()) landmarks.seeds_mm[name] = point_from(point, where, name);
    else if (key == "valves")
      for (const auto& [name, valve] : value.items()) landmarks.valves[name] = valve_from(valve, where, name);
    else if (key == "lv_apex_mm")
      landmarks.lv_apex_mm = point_from(value, where, key);
    else if (std::find(report_keys.begin(), report_keys.end(), key) == report_keys.end())
      throw UserError(fmt::format("unknown key \"{}\"", key), where, "known keys: seeds_mm, valves, lv_apex_mm");
  }
  check_landmarks(landmarks, where);
  return landmarks;
}

Landmarks read_landmarks(const std::string& path) {
  require_input_file(path);
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return parse_landmarks(text.str(), path);
}

std::string write_landmarks(const Landmarks& landmarks) {
  Json json;
  json["seeds_mm"] = Json::object();
  for (const auto& [name, point] : landmarks.seeds_mm) json["seeds_mm"][name] = json_from(point);
  json["valves"] = Json::object();
  for (const auto& [name, valve] : landmarks.valves)
    json["valves"][name] = {
        {"center_mm", json_from(valve.center_mm)}, {"normal", json_from(valve.normal)}, {"radius_mm", valve.radius_mm}};
  if (landmarks.lv_apex_mm) json["lv_apex_mm"] = json_from(*landmarks.lv_apex_mm);
  return json.dump(1) + "\n";
}

}  // namespace heartgen
