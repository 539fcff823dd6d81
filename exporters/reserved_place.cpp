// SPDX-License-Identifier: GPL-3.0-or-later
#include "exporters/reserved_place.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdio.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "exporters/bundle.hpp"
#include "exporters/files.hpp"
#include "model/error.hpp"
#include "model/unfinished.hpp"

namespace heartgen::exporters {
namespace {

namespace fs = std::filesystem;

/// Opens a folder and locks it. -1 with `errno` where that cannot be, EWOULDBLOCK where another run holds it. Some
/// network file systems know no locks: there the user has to see to it.
int locked_folder(const fs::path& folder) {
  const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor < 0 || flock(descriptor, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return descriptor;
  close(descriptor);
  errno = EWOULDBLOCK;
  return -1;
}

/// A lock on a folder. The system lets go of it however the program ends.
struct Claim {
  int descriptor = -1;
  fs::path partial;
  std::vector<fs::path> made;  ///< folders above it that this run has made, the deepest first

  Claim() = default;
  Claim(const Claim&) = delete;
  Claim& operator=(const Claim&) = delete;
  ~Claim() {
    std::error_code ignored;
    forget_unfinished(partial);
    if (holds()) fs::remove_all(partial, ignored);
    if (descriptor >= 0) close(descriptor);
    for (const auto& folder : made) fs::remove(folder, ignored);  // where they are empty
  }

  /// Whether the locked folder is the one that has the name now: it may have been moved into its place meanwhile.
  bool holds() const {
    struct stat locked {
    }, named{};
    return descriptor >= 0 && fstat(descriptor, &locked) == 0 && lstat(partial.c_str(), &named) == 0 &&
           locked.st_ino == named.st_ino && locked.st_dev == named.st_dev;
  }
};

/// Path and SHA-256 of the files that a bundle of any version lists; nothing where there is no bundle.
std::map<std::string, std::string> listed_files(const fs::path& folder) {
  std::map<std::string, std::string> files;
  try {
    const auto manifest = nlohmann::json::parse(read_text(folder / "manifest.json"));
    if (!manifest.at("schema").get<std::string>().starts_with("heartgen-")) return {};
    for (const auto& file : manifest.at("files"))
      if (const std::string path = file.at("path"); is_safe_path(path)) files[path] = file.at("sha256");
    return files;
  } catch (const std::exception&) {
    return {};
  }
}

/// What lies in a bundle's folder and was not written with it, or was changed since: relative paths.
std::vector<std::string> foreign_in(const fs::path& folder, const std::map<std::string, std::string>& listed) {
  std::set<fs::path> own = {"manifest.json", "logs", "logs/build.log"};
  for (const auto& [path, sha256] : listed)
    for (fs::path part = path; !part.empty(); part = part.parent_path()) own.insert(part);
  std::vector<std::string> foreign;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const fs::path path = entry.path().lexically_relative(folder);
    const bool is_folder = entry.is_directory() && !entry.is_symlink();
    const auto file = listed.find(path.string());
    if (!own.contains(path) && !(is_folder && !fs::is_empty(entry)))
      foreign.push_back(path.string());
    else if (file != listed.end() && (!entry.is_regular_file() || sha256_of_file(entry) != file->second))
      foreign.push_back(path.string() + " (changed)");
  }
  std::sort(foreign.begin(), foreign.end());
  return foreign;
}

void require_replaceable(const fs::path& folder, Existing existing) {
  if (!fs::exists(fs::symlink_status(folder))) return;
  if (fs::is_directory(folder) && fs::is_empty(folder)) return;
  const auto listed = listed_files(folder);
  if (listed.empty())
    throw UserError("exists and is not a bundle", folder.string(), "name another output folder, or move it away");
  if (existing == Existing::refuse)
    throw UserError("a bundle is there already", folder.string(),
                    "name another output folder, or replace the bundle with --force");
  constexpr std::size_t max_named = 3;
  auto foreign = foreign_in(folder, listed);
  if (foreign.empty()) return;
  const auto more = foreign.size() > max_named ? fmt::format(" and {} more", foreign.size() - max_named) : "";
  foreign.resize(std::min(foreign.size(), max_named));
  throw UserError(fmt::format("holds files that are not in its manifest: {}{}", fmt::join(foreign, ", "), more),
                  folder.string(), "move them away, or name another output folder");
}

[[noreturn]] void refuse(const fs::path& folder, const std::string& why) {
  throw UserError("cannot be made: " + why, folder.string(), "name another output folder, where you may write");
}

[[noreturn]] void refuse_second_run(const fs::path& folder) {
  throw UserError("another run is making a bundle there", folder.string(), "wait for it, or name another folder");
}

/// Locks the folder `partial`, which is made where there is none.
std::shared_ptr<Claim> claim_folder(const fs::path& partial, const fs::path& folder) {
  auto claim = std::make_shared<Claim>();
  claim->partial = partial;
  for (fs::path above = partial.parent_path(); !above.empty() && !fs::exists(above); above = above.parent_path())
    claim->made.push_back(above);
  std::error_code error;
  fs::create_directories(partial, error);
  if (error) refuse(folder, error.message());
  claim->descriptor = locked_folder(partial);
  if (claim->descriptor < 0 && errno == EWOULDBLOCK) refuse_second_run(folder);
  if (claim->descriptor < 0 && errno != ENOENT)
    refuse(folder, std::error_code(errno, std::generic_category()).message());
  return claim;
}

/// What was killed between two steps of move_into_place left the older bundle aside. Returns what was done.
std::string put_right(const fs::path& folder) {
  const fs::path old = hidden_sibling(folder, "old");
  const auto listed = listed_files(old);
  if (listed.empty()) return "";
  std::error_code error;
  if (!fs::exists(fs::symlink_status(folder)) || fs::is_empty(folder, error)) {
    fs::rename(old, folder, error);
    if (error) refuse(folder, error.message());
    return fmt::format("{}: a run that was stopped had left the older bundle as {}: put back", folder.string(),
                       old.filename().string());
  }
  if (!foreign_in(old, listed).empty())
    return fmt::format("{}: left of an older bundle, with files that are not its own: move them away", old.string());
  fs::remove_all(old, error);
  return fmt::format("{}: left of an older bundle by a run that was stopped: removed", old.string());
}

/// Removes what a killed run left, and sees whether files can be written.
void make_empty(const fs::path& partial, const fs::path& folder) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(partial, error)) {
    fs::remove_all(entry.path(), error);
    if (error) refuse(folder, error.message());
  }
  if (!error) fs::create_directory(partial / "meshes", error);
  if (!error) fs::remove(partial / "meshes", error);
  if (error) refuse(folder, error.message());
}

/// After something was put right, which the user is told in any case.
void require_replaceable_now(const ReservedPlace& place, Existing existing) {
  try {
    require_replaceable(place.folder, existing);
  } catch (const UserError& error) {
    throw UserError(place.remark + "; " + error.problem, "", error.remedy);
  }
}

}  // namespace

ReservedPlace reserve_place(const fs::path& folder, Existing existing) {
  ReservedPlace place;
  place.folder = plain_path(folder);
  require_replaceable(place.folder, existing);
  place.partial = hidden_sibling(place.folder, "partial");
  constexpr int attempts = 3;  // another run may just have moved the folder that was locked into its place
  for (int attempt = 0; attempt < attempts; ++attempt) {
    const auto claim = claim_folder(place.partial, place.folder);
    if (!claim->holds()) continue;
    note_unfinished(place.partial);
    make_empty(place.partial, place.folder);
    place.remark = put_right(place.folder);
    place.claim = claim;
    if (!place.remark.empty()) require_replaceable_now(place, existing);
    return place;
  }
  refuse_second_run(place.folder);
}

namespace {

/// Two steps, where the file system cannot exchange folders. The older bundle ends where the new one was prepared.
std::error_code swap_in_steps(const fs::path& prepared, const fs::path& folder) {
  const fs::path old = hidden_sibling(folder, "old");
  std::error_code error;
  fs::rename(folder, old, error);
  if (error) return error;
  fs::rename(prepared, folder, error);
  std::error_code ignored;
  fs::rename(old, error ? folder : prepared, ignored);
  return error;
}

std::error_code swap(const fs::path& prepared, const fs::path& folder) {
  if (renameat2(AT_FDCWD, prepared.c_str(), AT_FDCWD, folder.c_str(), RENAME_EXCHANGE) == 0) return {};
  return swap_in_steps(prepared, folder);
}

}  // namespace

void move_into_place(const ReservedPlace& place, Existing existing) {
  const fs::path &prepared = place.partial, &folder = place.folder;
  require_replaceable(folder, existing);
  std::error_code error;
  forget_unfinished(prepared);
  if (fs::exists(folder) && !fs::is_empty(folder)) {
    const int older = locked_folder(folder);  // nobody prepares another bundle in it while it is removed
    error = swap(prepared, folder);
    if (!error) fs::remove_all(prepared, error);
    if (older >= 0) close(older);
  } else {
    fs::rename(prepared, folder, error);
  }
  if (error) throw UserError("cannot put the bundle in place: " + error.message(), folder.string(), "");
}

}  // namespace heartgen::exporters
