// Runs the stages of a build. Run alone knows timing, progress, caching by content, and error context; a stage is a
// plain function that returns a value.
#pragma once
#include <chrono>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "generator/app/archive.hpp"
#include "generator/app/progress.hpp"
#include "generator/parallel/comm.hpp"

namespace heart::app {

/// A stage's result with the key of its content: what it was made from, hashed.
template <class T>
struct Staged {
  T value;
  std::string key;
  const T& operator*() const { return value; }
  const T* operator->() const { return &value; }
};

struct StageTime {
  std::string name;
  double seconds = 0;
  bool cached = false;
};

struct Run {
  parallel::Comm comm;
  std::filesystem::path cache_folder;  ///< empty: no cache
  std::string program_hash;            ///< of this executable: a new program trusts no old results
  Progress progress;
  std::vector<StageTime> times{};

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
    const bool cached = load(result);
    if (!cached) {
      with_context(name, [&] { result.value = make(); });
      save(result);
    }
    record(name, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), cached);
    return result;
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
  void record(const std::string& name, double seconds, bool cached);
  [[noreturn]] static void rethrow_in_stage(const std::string& name);
};

}  // namespace heart::app
