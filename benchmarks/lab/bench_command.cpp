// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/lab/bench_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "benchmarks/benchmarks.hpp"
#include "generator/adapters/image_checks.hpp"
#include "generator/pipeline/heartbeat.hpp"
#include "model/error.hpp"
#include "model/text.hpp"

namespace heartgen::lab {
namespace {

using benchmarks::Benchmark;
using benchmarks::Row;
using Json = nlohmann::ordered_json;

std::vector<Benchmark> chosen(const std::vector<std::string>& names) {
  if (names.empty()) return benchmarks::all();
  std::vector<std::string> known;
  for (const auto& bench : benchmarks::all()) known.push_back(bench.name);
  std::vector<Benchmark> list;
  for (const auto& name : names) {
    const auto before = list.size();
    for (const auto& bench : benchmarks::all())
      if (bench.name == name || bench.name.starts_with(name + "-")) list.push_back(bench);
    if (list.size() == before)
      throw UserError(fmt::format("unknown benchmark \"{}\"", name), "bench",
                      fmt::format("did you mean \"{}\"? Known: {}", nearest_name(name, known), fmt::join(known, ", ")));
  }
  return list;
}

void print(const Row& row) {
  fmt::print("{:<17}{:<62}{:>10.4g} {:<12}{}\n", row.bench, row.what, row.value, row.unit,
             row.note.empty() ? "" : "  " + row.note);
  std::fflush(stdout);
}

void tell(const std::string& text) {
  fmt::print(stderr, "heartgen-lab bench: {}\n", text);
  std::fflush(stderr);
}

/// Says what is measured, and that it still is: a line in ten seconds is nothing to what is measured.
benchmarks::Table watched(const Benchmark& bench, std::size_t n, std::size_t count,
                          const benchmarks::Settings& settings, const parallel::Comm& comm) {
  if (!comm.is_root()) return bench.run(settings, comm);
  tell(fmt::format("{} ({} of {}): {}", bench.name, n, count, bench.help));
  const pipeline::Heartbeat heartbeat(pipeline::longest_silence, [&](double seconds) {
    tell(fmt::format("{}: {:.0f} s so far", bench.name, seconds));
  });
  return bench.run(settings, comm);
}

}  // namespace

int bench_command(const BenchCommand& command, const parallel::Comm& comm) {
  adapters::check_size(command.size, "--size", true);
  const benchmarks::Settings settings{command.size,   command.spacing_mm, command.repeats,      command.threads,
                                      command.labels, command.variant,    command.heart_edge_mm};
  benchmarks::count_processor_time(command.processor_time);
  Json all = Json::array();
  const auto list = chosen(command.names);
  for (std::size_t n = 0; n < list.size(); ++n) {
    const auto rows = watched(list[n], n + 1, list.size(), settings, comm);
    if (!comm.is_root()) continue;
    for (const Row& row : rows) {
      if (!command.json) print(row);
      all.push_back(
          {{"bench", row.bench}, {"what", row.what}, {"value", row.value}, {"unit", row.unit}, {"note", row.note}});
    }
  }
  if (command.json && comm.is_root()) fmt::print("{}\n", all.dump(1));
  return 0;
}

std::string bench_help() {
  std::string text = "Benchmarks (all of them when none is named):\n";
  for (const auto& bench : benchmarks::all()) text += fmt::format("  {:<17} {}\n", bench.name, bench.help);
  return text;
}

}  // namespace heartgen::lab
