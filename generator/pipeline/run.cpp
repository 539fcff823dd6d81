// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/run.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <new>
#include <sstream>
#include <stdexcept>

#include "exporters/bundle.hpp"
#include "model/error.hpp"
#include "model/new_file.hpp"

namespace heartgen::pipeline {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t hash_length = 64;
constexpr const char* entry_ending = ".stage";

fs::path entry_path(const fs::path& folder, const std::string& key) { return folder / (key + entry_ending); }

/// A folder that is not there has none; a file that cannot be removed stays.
template <class Rule>
void remove_files(const fs::path& folder, Rule goes) {
  std::error_code ignored;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder, ignored))
    if (goes(entry.path())) files.push_back(entry.path());
  for (const auto& file : files) fs::remove(file, ignored);
}

double peak_gib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / (1 << 20);  // Linux counts KiB
}

const char* remark_of(From from) {
  return from == From::cache ? "  from the cache" : from == From::file ? "  from a file" : "";
}

}  // namespace

std::string Run::stage_key(const std::string& name, const std::vector<std::string>& inputs) const {
  std::string text = program_hash + "\n" + name + "\n";
  for (const auto& input : inputs) text += std::to_string(input.size()) + ":" + input + "\n";
  return exporters::sha256_of_text(text);
}

bool Run::read_entry(const std::string& key, std::string& bytes) const {
  if (cache_folder.empty()) return false;
  std::ifstream file(entry_path(cache_folder, key), std::ios::binary);
  if (!file) return false;
  std::string hash(hash_length, ' ');
  file.read(hash.data(), hash_length);
  std::ostringstream rest;
  rest << file.rdbuf();
  bytes = std::move(rest).str();
  return exporters::sha256_of_text(bytes) == hash;
}

void Run::write_entry(const std::string& key, const std::string& bytes) const {
  try {
    NewFile whole(entry_path(cache_folder, key));
    std::ofstream file(whole.partial, std::ios::binary);
    file << exporters::sha256_of_text(bytes);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (file.flush()) whole.finish();
  } catch (const UserError&) {  // a cache that cannot be written costs time, not results
  }
}

bool Run::agreed(bool on_root) const {
  std::string text = on_root ? "1" : "0";
  parallel::broadcast(comm, text);
  return text == "1";
}

void Run::record(const std::string& name, double seconds, From from, std::vector<PartTime> parts) {
  times.push_back({name, seconds, from, peak_gib(), std::move(parts)});
  stage_ends(progress, name,
             from == From::cache  ? "from the cache"
             : from == From::file ? "from the given file"
                                  : fmt::format("{:.1f} s", seconds));
}

std::string Run::hash_of_bytes(const std::string& bytes) { return exporters::sha256_of_text(bytes); }

/// What a result was made from: the inputs and settings of the image stages, and the files that came in between.
std::string Run::origin_so_far() const {
  std::string text = files.origin;
  for (const auto& stage : files.changed) text += "\n" + stage;
  return exporters::sha256_of_text(text);
}

/// The stage's own key for the result that it would make itself, else a new one. @collective
std::string Run::replacement_key(const std::string& name, const std::string& file, std::string contents) {
  std::string key;
  if (comm.is_root()) {
    const StageRecord known = read_stage_record(fs::path(file).parent_path(), name);
    if (known.contents == contents && known.origin == origin_so_far()) key = known.key;
  }
  parallel::broadcast(comm, contents);
  parallel::broadcast(comm, key);
  if (!key.empty()) return key;
  files.changed.push_back(name + " " + contents);
  return exporters::sha256_of_text(files.changed.back());
}

void Run::rethrow_in_stage(const std::string& name) {
  try {
    throw;
  } catch (const UserError& error) {
    if (!error.where.empty()) throw;
    throw UserError(error.problem, name, error.remedy);
  } catch (const std::bad_alloc&) {
    throw UserError("not enough memory", name, "take longer edges, a smaller image or a larger machine");
  } catch (const fs::filesystem_error& error) {
    throw UserError(error.code().message(), error.path1().string(), "check the folder, its rights and the space left");
  } catch (const std::exception& error) {
    throw std::runtime_error(name + ": " + error.what());
  }
}

void clear_unfinished_entries(const fs::path& cache_folder) {
  remove_files(cache_folder, [](const fs::path& file) { return file.filename().string().starts_with(".partial"); });
}

void forget_other_entries(const fs::path& cache_folder, const std::vector<std::string>& keys) {
  remove_files(cache_folder, [&](const fs::path& file) {
    return file.extension() == entry_ending && std::find(keys.begin(), keys.end(), file.stem().string()) == keys.end();
  });
}

std::string time_log(const Run& run) {
  std::string text = fmt::format("{:<22} {:>8}   most memory so far\n", "stage", "");
  double seconds = 0, gib = 0;
  for (const auto& time : run.times) {
    text +=
        fmt::format("{:<22} {:8.2f} s {:8.2f} GiB{}\n", time.name, time.seconds, time.peak_gib, remark_of(time.from));
    for (const auto& part : time.parts) text += fmt::format("  {:<20} {:8.2f} s\n", part.name, part.seconds);
    seconds += time.seconds;
    gib = std::max(gib, time.peak_gib);
  }
  return text + fmt::format("{:<22} {:8.2f} s {:8.2f} GiB on {}\n", "all", seconds, gib,
                            run.comm.size == 1 ? "1 rank" : fmt::format("the first of {} ranks", run.comm.size));
}

}  // namespace heartgen::pipeline
