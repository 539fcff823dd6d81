// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/lab/study_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "benchmarks/study/studies.hpp"
#include "model/error.hpp"
#include "model/text.hpp"

namespace heartgen::lab {
namespace {

using study::StudyResult;

const study::StudyEntry& entry_of(const std::string& name) {
  const auto all = study::all_studies();
  const auto found = std::find_if(all.begin(), all.end(), [&](const auto& entry) { return entry.name == name; });
  if (found != all.end()) return *found;
  std::vector<std::string> known;
  for (const auto& entry : all) known.emplace_back(entry.name);
  throw UserError(fmt::format("no study is called \"{}\"", name), "study",
                  fmt::format("did you mean \"{}\"? heartgen-lab study --help lists them", nearest_name(name, known)));
}

std::vector<study::StudyEntry> chosen(const std::vector<std::string>& names) {
  std::vector<study::StudyEntry> entries;
  entries.reserve(names.size());
  for (const auto& name : names) entries.push_back(entry_of(name));
  if (names.empty()) entries.assign(study::all_studies().begin(), study::all_studies().end());
  return entries;
}

nlohmann::ordered_json json_of(const StudyResult& result) {
  nlohmann::ordered_json json{{"name", result.name}, {"title", result.title}, {"setup", result.setup}};
  for (const auto& claim : result.claims)
    json["claims"].push_back({{"source", claim.source},
                              {"statement", claim.statement},
                              {"holds", claim.holds},
                              {"measured", claim.measured}});
  for (const auto& table : result.tables)
    json["tables"].push_back(
        {{"name", table.name}, {"title", table.title}, {"columns", table.columns}, {"rows", table.rows}});
  return json;
}

void print_text(const StudyResult& result) {
  fmt::print("\n# {}\n\n{}\n", result.title, result.setup);
  for (const auto& table : result.tables) fmt::print("\n{}", study::markdown(table));
  fmt::print("\n");
  for (const auto& claim : result.claims)
    fmt::print("{:<14} {}: {}\n    {}\n", claim.holds ? "holds" : "does not hold", claim.source, claim.statement,
               claim.measured);
}

}  // namespace

int study_command(const StudyCommand& command) {
  const std::vector<study::StudyEntry> entries = chosen(command.names);
  if (!command.output.empty()) check_output(std::filesystem::path(command.output) / "index.html");
  std::vector<StudyResult> results;
  for (const auto& entry : entries) {
    study::StudySettings settings;
    settings.quick = command.quick;
    settings.progress = [&](const std::string& what) { fmt::print(stderr, "study {}: {}\n", entry.name, what); };
    results.push_back(entry.run(settings));
    if (!command.json) print_text(results.back());
  }
  if (!command.output.empty()) study::write_studies(command.output, results);
  if (command.json) {
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const auto& result : results) all.push_back(json_of(result));
    fmt::print("{}\n", all.dump(2));
  } else if (!command.output.empty()) {
    fmt::print("\nwritten: {}/index.html\n", command.output);
  }
  return 0;
}

std::string study_help() {
  std::string text = "Studies:";
  for (const auto& entry : study::all_studies()) text += fmt::format("\n  {:<16} {}", entry.name, entry.what);
  return text + "\n";
}

}  // namespace heartgen::lab
