// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/app/get_command.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <heartgen/bundle.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "model/text.hpp"
#include "model/unfinished.hpp"

namespace heartgen::app {
namespace {

namespace fs = std::filesystem;

bool is_url(const std::string& source) { return source.find("://") != std::string::npos; }

/// A file that goes with this object, and where a signal ends the program.
struct Partial {
  fs::path path;
  explicit Partial(fs::path path_) : path(std::move(path_)) { note_unfinished(path); }
  ~Partial() {
    std::error_code ignored;
    fs::remove(path, ignored);
    forget_unfinished(path);
  }
  Partial(const Partial&) = delete;
  Partial& operator=(const Partial&) = delete;
};

/// Downloads with curl, which says what it does on standard error. Returns its exit code; -1 where there is no curl.
int download(const std::string& url, const fs::path& to) {
  std::vector<std::string> words{"curl",     "--fail",    "--location", "--silent", "--show-error",
                                 "--output", to.string(), "--",         url};
  std::vector<char*> arguments;
  for (auto& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t child = -1;
  if (posix_spawnp(&child, words.front().c_str(), nullptr, nullptr, arguments.data(), environ) != 0) return -1;
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void require_download(const std::string& url, const fs::path& to) {
  const int code = download(url, to);
  if (code == 0) return;
  throw UserError(code < 0 ? "needs the program curl" : fmt::format("cannot be downloaded (curl ends with {})", code),
                  url,
                  code < 0 ? "install curl, or download the file yourself and give its name" : "is the address right?");
}

/// The first word of a file as sha256sum writes it; nothing where there is no such file.
std::optional<std::string> first_word(const fs::path& file) {
  std::ifstream in(file);
  std::string word;
  return in >> word ? std::optional(word) : std::nullopt;
}

/// What the file's SHA-256 must be, if anybody says.
std::optional<std::string> wanted_sha256(const GetCommand& command, const fs::path& scratch) {
  if (!command.sha256.empty()) return command.sha256;
  if (!is_url(command.source)) return first_word(command.source + ".sha256");
  const Partial beside(scratch.string() + ".sha256");
  if (download(command.source + ".sha256", beside.path) != 0) return std::nullopt;
  return first_word(beside.path);
}

void check(const fs::path& archive, const GetCommand& command, std::string wanted) {
  std::transform(wanted.begin(), wanted.end(), wanted.begin(),
                 [](char c) { return c >= 'A' && c <= 'F' ? static_cast<char>(c - 'A' + 'a') : c; });
  const bool is_digest = wanted.size() == 64 && wanted.find_first_not_of("0123456789abcdef") == std::string::npos;
  if (!is_digest) throw UserError("is no SHA-256", "the checksum of " + command.source, "it has 64 digits 0 to f");
  if (const auto found = bundle::sha256_of_file(archive); found != wanted)
    throw UserError(fmt::format("its SHA-256 is {}, and should be {}", found, wanted), command.source,
                    "download it again; if that does not help, ask whoever publishes it");
}

}  // namespace

int get_command(const GetCommand& command) {
  const fs::path folder = fs::path(command.folder).lexically_normal();
  if (fs::exists(folder)) throw UserError("exists", command.folder, "name a folder to make");
  check_output(folder);
  std::optional<Partial> download_of;
  fs::path archive = command.source;
  if (is_url(command.source)) {
    download_of.emplace(folder.parent_path() / fmt::format(".{}.{}.tar.zst", folder.filename().string(), getpid()));
    archive = download_of->path;
    make_folder_of(archive);
    require_download(command.source, archive);
  }
  const auto wanted = wanted_sha256(command, archive);
  if (wanted) check(archive, command, *wanted);
  bundle::unpack_bundle(archive, folder);
  const auto manifest = bundle::read_manifest(folder);
  const char* const told = wanted ? "its SHA-256 is the published one" : "no checksum was published with it";
  if (command.json)
    fmt::print("{}\n", nlohmann::ordered_json{{"bundle", command.folder},
                                              {"content_id", manifest.content_id},
                                              {"checksum_compared", wanted.has_value()}}
                           .dump(1));
  else
    fmt::print("{}: {} {}; {}, and every file is as its manifest says\n", command.folder, manifest.name,
               manifest.version, told);
  return 0;
}

}  // namespace heartgen::app
