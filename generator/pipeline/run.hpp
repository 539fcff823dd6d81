// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Runs single stages of a build. Run alone knows timing, progress, caching by content, and error context; a stage is
/// a plain function that returns its value and its notes.
#pragma once
#include <chrono>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "generator/parallel/comm.hpp"
#include "generator/pipeline/archive.hpp"
#include "generator/pipeline/noted.hpp"
#include "generator/pipeline/progress.hpp"
#include "generator/pipeline/stage_files.hpp"
#include "model/part_clock.hpp"

namespace heartgen::pipeline {

enum class On { root, all_ranks };

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
  Notes notes{};                         ///< of the stages so far. Root only

  /// `make` returns a Noted<T>. On the root: the other ranks get an empty value, or the same error. On all ranks: it
  /// runs on all together, and its result counts on the root. `sources` stand for all that it is made from.
  /// @collective
  template <class F>
  auto stage(On on, const std::string& name, const std::vector<std::string>& sources, F&& make) {
    using T = decltype(make().value);
    return timed<T>(name, [&](Noted<T>& made, std::string& key) {
      key = stage_key(name, sources);
      From from = From::file;
      if (!replace(name, made.value, key)) {
        from = load(key, made) ? From::cache : From::making;
        if (from == From::making) {
          make_on(on, name, make, made);
          save(key, made);
        }
        keep(name, made.value, key);
      }
      used_keys.push_back(key);
      return from;
    });
  }

  /// The same without a cache, for what is kept elsewhere. @collective
  template <class F>
  auto last_stage(On on, const std::string& name, F&& make) {
    using T = decltype(make().value);
    return timed<T>(name, [&](Noted<T>& made, std::string&) {
      make_on(on, name, make, made);
      return From::making;
    });
  }

  /// What the root says. @collective
  bool agreed(bool on_root) const;

 private:
  template <class T, class Get>
  Staged<T> timed(const std::string& name, const Get& get) {
    const auto start = std::chrono::steady_clock::now();
    Noted<T> made;
    std::string key;
    stage_begins(progress, name);
    const From from = get(made, key);
    notes.insert(notes.end(), made.notes.begin(), made.notes.end());
    record(name, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), from, made.parts);
    return {std::move(made.value), std::move(key)};
  }

  template <class T, class F>
  void make_on(On on, const std::string& name, F&& make, Noted<T>& made) const {
    with_context(name, [&] {
      if (on == On::all_ranks)
        made = make();
      else
        parallel::run_on_root(comm, [&] { made = make(); });
    });
  }

  /// Takes the result from a file where one is given. An unchanged one keeps the stage's key.
  template <class T>
  bool replace(const std::string& name, T& value, std::string& key) {
    if constexpr (has_stage_file<T>) {
      const auto file = files.replaced_by.find(name);
      if (file == files.replaced_by.end()) return false;
      key = replacement_key(name, file->second, parallel::run_on_root(comm, [&] {
                              read_stage_file(file->second, files.grid, value);
                              return contents_hash(value);
                            }));
      return true;
    } else {
      return false;
    }
  }

  template <class T>
  void keep(const std::string& name, const T& value, const std::string& key) {
    if constexpr (has_stage_file<T>) {
      if (files.keep_folder.empty()) return;
      parallel::run_on_root(comm, [&] {
        write_stage_file(files.keep_folder, name, value);
        write_stage_record(files.keep_folder, name, {origin_so_far(), key, contents_hash(value)});
      });
    }
  }

  template <class T>
  bool load(const std::string& key, Noted<T>& made) {
    bool found = false;
    parallel::run_on_root(comm, [&] {
      std::string bytes;
      if (!read_entry(key, bytes)) return;
      try {
        Reader{bytes}.get(made);
        found = true;
      } catch (const std::runtime_error&) {
        made = {};  // written by a program of another shape: make it again
      }
    });
    return agreed(found);
  }

  template <class T>
  void save(const std::string& key, const Noted<T>& made) {
    if (comm.rank != 0 || cache_folder.empty()) return;
    Writer writer;
    writer.put(made);
    write_entry(key, writer.bytes);
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
  void record(const std::string& name, double seconds, From from, std::vector<PartTime> parts);
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
