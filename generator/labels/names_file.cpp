// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/labels/names_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <vector>

#include "generator/labels/presets.hpp"
#include "model/error.hpp"
#include "model/input_file.hpp"

namespace heartgen::labels {
namespace {

using Names = std::map<std::int32_t, std::string>;
using Json = nlohmann::ordered_json;

constexpr const char* remedy = "write two columns, value and name, as .csv, or {\"value\": \"name\"} as .json";

std::optional<std::int32_t> whole_number(const std::string& text) {
  std::int32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string trimmed(const std::string& text) {
  constexpr const char* blank = " \t\r\n\"";
  const auto first = text.find_first_not_of(blank);
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(blank) - first + 1);
}

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, line.find('\t') != std::string::npos ? '\t' : ',');)
    fields.push_back(trimmed(field));
  return fields;
}

void add(Names& names, std::int32_t value, const std::string& name, const std::string& where) {
  if (name.empty()) throw UserError(fmt::format("the value {} has no name", value), where, remedy);
  if (!names.emplace(value, name).second)
    throw UserError(fmt::format("the value {} stands there twice", value), where, "keep one of the two");
}

struct Columns {
  std::size_t value = 0, name = 1;
};

std::size_t column_named(const std::vector<std::string>& header, const std::vector<std::string>& candidates,
                         const std::string& path) {
  for (const auto& candidate : candidates)
    for (std::size_t c = 0; c < header.size(); ++c)
      if (plain_name(header[c]) == candidate) return c;
  throw UserError(fmt::format("has no column {}", fmt::join(candidates, " or ")), path, remedy);
}

/// Where value and name stand, by the first line.
Columns columns_of(const std::vector<std::string>& first, const std::string& path) {
  if (std::any_of(first.begin(), first.end(), [](const auto& field) { return whole_number(field).has_value(); })) {
    if (first.size() != 2) throw UserError("needs a line with the columns' names", path, remedy);
    return whole_number(first[0]) ? Columns{0, 1} : Columns{1, 0};
  }
  return {column_named(first, {"id", "value", "labelvalue", "label_value", "label", "index"}, path),
          column_named(first, {"structure", "name", "region", "label_name", "labelname"}, path)};
}

Names read_csv(const std::string& path, std::istream& file) {
  Names names;
  std::optional<Columns> columns;
  int number = 0;
  for (std::string line; std::getline(file, line);) {
    ++number;
    if (trimmed(line).empty()) continue;
    const auto fields = fields_of(line);
    const bool header = !columns;
    if (header) columns = columns_of(fields, path);
    const std::string where = fmt::format("{}:{}", path, number);
    if (fields.size() <= std::max(columns->value, columns->name))
      throw UserError(fmt::format("has {} columns", fields.size()), where, remedy);
    const auto value = whole_number(fields[columns->value]);
    if (value)
      add(names, *value, fields[columns->name], where);
    else if (!header)
      throw UserError(fmt::format("\"{}\" is no whole number", fields[columns->value]), where, remedy);
  }
  return names;
}

Names read_json(const std::string& path, std::istream& file) {
  Json json = Json::parse(file, nullptr, false);
  if (json.is_object() && json.contains("labels")) json = Json(json["labels"]);
  if (!json.is_object()) throw UserError("is not a JSON object", path, remedy);
  Names names;
  for (const auto& [key, value] : json.items()) {
    const auto number = whole_number(key);
    if (number && value.is_string())
      add(names, *number, value.get<std::string>(), path);
    else if (value.is_number_integer())
      add(names, value.get<std::int32_t>(), key, path);
    else
      throw UserError(fmt::format("\"{}\" has neither a value nor a name", key), path, remedy);
  }
  return names;
}

}  // namespace

Names read_label_names(const std::string& path) {
  require_input_file(path, "check input.label_names");
  std::ifstream file(path, std::ios::binary);
  Names names = path.ends_with(".json") ? read_json(path, file) : read_csv(path, file);
  if (names.empty()) throw UserError("holds no names", path, remedy);
  return names;
}

}  // namespace heartgen::labels
