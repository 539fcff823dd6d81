#include "generator/app/run.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <fstream>
#include <sstream>
#include <stdexcept>

#include "exporters/bundle.hpp"
#include "model/error.hpp"

namespace heart::app {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t hash_length = 64;

fs::path entry_path(const fs::path& folder, const std::string& key) { return folder / (key + ".stage"); }

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
  std::error_code ignored;  // a cache that cannot be written costs time, not results
  fs::create_directories(cache_folder, ignored);
  const fs::path partial = cache_folder / fmt::format("{}.{}.partial", key, getpid());
  {
    std::ofstream file(partial, std::ios::binary);
    file << exporters::sha256_of_text(bytes);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!file.flush()) {
      fs::remove(partial, ignored);
      return;
    }
  }
  fs::rename(partial, entry_path(cache_folder, key), ignored);
}

bool Run::agreed(bool on_root) const {
  std::string text = on_root ? "1" : "0";
  parallel::broadcast(comm, text);
  return text == "1";
}

void Run::record(const std::string& name, double seconds, From from) {
  times.push_back({name, seconds, from});
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
  } catch (const std::exception& error) {
    throw std::runtime_error(name + ": " + error.what());
  }
}

}  // namespace heart::app
