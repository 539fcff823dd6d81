// SPDX-License-Identifier: GPL-3.0-or-later
#include "exporters/certificate_json.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "exporters/files.hpp"
#include "exporters/warning_json.hpp"
#include "model/error.hpp"

namespace heartgen::exporters {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::string_view, 4> verdict_names = {"told", "passed", "warned", "failed"};

/// The bounds of a row by the names that they have in the file.
template <class Row>
auto bounds_of(Row& row) {
  return std::array{std::pair{"at_least", &row.at_least}, std::pair{"at_most", &row.at_most},
                    std::pair{"warn_below", &row.warn_below}, std::pair{"warn_above", &row.warn_above}};
}

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

double number_from(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

Json row_json(const ReportRow& row) {
  Json json = {{"group", row.group}, {"scope", row.scope}, {"metric", row.metric}};
  json["value"] = number(row.value);
  json["unit"] = row.unit;
  for (const auto& [name, bound] : bounds_of(row))
    if (*bound) json[name] = number(**bound);
  if (row.judges()) json["passed"] = row.passed();
  if (row.judges()) json["verdict"] = name_of(row.verdict(), verdict_names);
  if (!row.reason.empty()) json["reason"] = row.reason;
  return json;
}

ReportRow row_from(const Json& json) {
  ReportRow row;
  row.group = json.at("group");
  row.scope = json.at("scope");
  row.metric = json.at("metric");
  row.value = number_from(json.at("value"));
  row.unit = json.at("unit");
  for (const auto& [name, bound] : bounds_of(row))
    if (json.contains(name)) *bound = number_from(json.at(name));
  row.reason = json.value("reason", std::string());
  return row;
}

Certificate certificate_from(const Json& document) {
  Certificate certificate;
  for (const auto& json : document.at("rows")) certificate.rows.push_back(row_from(json));
  certificate.warnings = document.value("warnings", std::vector<Warning>());
  certificate.uses = document.value("uses", std::vector<UseVerdict>());
  return certificate;
}

}  // namespace

std::string certificate_json(const Certificate& certificate) {
  const Verdict verdict = verdict_of(certificate);
  Json rows = Json::array();
  for (const auto& row : certificate.rows) rows.push_back(row_json(row));
  const Json document = {{"passed", verdict != Verdict::failed},
                         {"verdict", name_of(verdict, verdict_names)},
                         {"warnings", certificate.warnings},
                         {"uses", certificate.uses},
                         {"rows", rows}};
  return document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Certificate read_certificate(const std::filesystem::path& folder) {
  const auto path = folder / "validation" / "metrics.json";
  try {
    return certificate_from(Json::parse(read_text(path)));
  } catch (const Json::exception& error) {
    throw UserError(std::string("malformed metrics: ") + error.what(), path.string(), "is the bundle whole?");
  } catch (const std::invalid_argument& error) {
    throw UserError(std::string("malformed metrics: ") + error.what(), path.string(), "is the bundle whole?");
  }
}

}  // namespace heartgen::exporters
