// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Runs the stages of a build. Run alone knows timing, progress, caching by content, and error context; a stage is a
/// plain function that returns a value.
#pragma once
#include <chrono>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "generator/parallel/comm.hpp"
#include "generator/pipeline/archive.hpp"
#include "generator/pipeline/progress.hpp"
#include "generator/pipeline/stage_files.hpp"

namespace heartgen::pipeline {

/// A stage's result with the key of its content: what it was made from, hashed.
template <class T>
struct Staged {
  T value;
  std::string key;
  const T& operator*() const { return value; }
  const T* operator->() const { return &value; }
};

enum class From { making, cache, file };

struct StageTime {
  std::string name;
  double seconds = 0;
  From from = From::making;
  double peak_gib = 0;            ///< the most memory that the root has held until its end
  std::vector<PartTime> parts{};  ///< that the stage itself told
};

struct Run {
  parallel::Comm comm;
  std::filesystem::path cache_folder;  ///< empty: no cache
  std::string program_hash;            ///< of this executable: a new program trusts no old results
  Progress progress;
  std::vector<StageTime> times{};
  StageFiles files{};
  std::vector<std::string> used_keys{};  ///< of the stages so far

  /// `make` runs on every rank together. Its result counts on the root only. @collective
  template <class F>
  auto stage(const std::string& name, const std::vector<std::string>& inputs, F&& make) {
    return timed<std::decay_t<decltype(make())>>(name, inputs, std::forward<F>(make));
  }

  /// `make` runs on the root; the other ranks get an empty value, or the same error. @collective
  template <class F>
  auto root_stage(const std::string& name, const std::vector<std::string>& inputs, F&& make) {
    using T = std::decay_t<decltype(make())>;
    return timed<T>(name, inputs, [&] {
      T value;
      parallel::run_on_root(comm, [&] { value = make(); });
      return value;
    });
  }

 private:
  template <class T, class F>
  Staged<T> timed(const std::string& name, const std::vector<std::string>& inputs, F&& make) {
    const auto start = std::chrono::steady_clock::now();
    Staged<T> result{T{}, stage_key(name, inputs)};
    stage_begins(progress, name);
    From from = From::file;
    if (!replace(name, result)) {
      from = load(result) ? From::cache : From::making;
      if (from == From::making) {
        with_context(name, [&] { result.value = make(); });
        save(result);
      }
      keep(name, result);
    }
    used_keys.push_back(result.key);
    record(name, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), from);
    return result;
  }

  /// Takes the result from a file where one is given. An unchanged one keeps the stage's key.
  template <class T>
  bool replace(const std::string& name, Staged<T>& result) {
    if constexpr (has_stage_file<T>) {
      const auto file = files.replaced_by.find(name);
      if (file == files.replaced_by.end()) return false;
      result.key = replacement_key(name, file->second, parallel::run_on_root(comm, [&] {
                                     read_stage_file(file->second, files.grid, result.value);
                                     return contents_hash(result.value);
                                   }));
      return true;
    } else {
      return false;
    }
  }

  template <class T>
  void keep(const std::string& name, const Staged<T>& result) {
    if constexpr (has_stage_file<T>) {
      if (files.keep_folder.empty()) return;
      parallel::run_on_root(comm, [&] {
        write_stage_file(files.keep_folder, name, result.value);
        write_stage_record(files.keep_folder, name, {origin_so_far(), result.key, contents_hash(result.value)});
      });
    }
  }

  template <class T>
  bool load(Staged<T>& result) {
    bool found = false;
    parallel::run_on_root(comm, [&] {
      std::string bytes;
      if (!read_entry(result.key, bytes)) return;
      try {
        Reader{bytes}.get(result.value);
        found = true;
      } catch (const std::runtime_error&) {
        result.value = T{};  // written by a program of another shape: make it again
      }
    });
    return agreed(found);
  }

  template <class T>
  void save(const Staged<T>& result) {
    if (comm.rank != 0 || cache_folder.empty()) return;
    Writer writer;
    writer.put(result.value);
    write_entry(result.key, writer.bytes);
  }

  template <class F>
  static void with_context(const std::string& name, F&& make) {
    try {
      make();
    } catch (const std::exception&) {
      rethrow_in_stage(name);
    }
  }

  std::string stage_key(const std::string& name, const std::vector<std::string>& inputs) const;
  bool read_entry(const std::string& key, std::string& bytes) const;
  void write_entry(const std::string& key, const std::string& bytes) const;
  bool agreed(bool on_root) const;
  void record(const std::string& name, double seconds, From from);
  std::string origin_so_far() const;
  std::string replacement_key(const std::string& name, const std::string& file, std::string contents);
  static std::string hash_of_bytes(const std::string& bytes);

  template <class T>
  static std::string contents_hash(const T& value) {
    Writer writer;
    writer.put(value);
    return hash_of_bytes(writer.bytes);
  }
  [[noreturn]] static void rethrow_in_stage(const std::string& name);
};

/// Takes away what killed runs left of entries. No other run may use the cache.
void clear_unfinished_entries(const std::filesystem::path& cache_folder);

/// Takes away the entries that have none of these keys: those of older programs, which nobody reads again, and of
/// settings that have changed. No other run may use the cache.
void forget_other_entries(const std::filesystem::path& cache_folder, const std::vector<std::string>& keys);

/// A line per stage with its seconds and the memory so far, and a last one of all.
std::string time_log(const Run& run);

}  // namespace heartgen::pipeline
