#include "exporters/reserved_place.hpp"

#include <fcntl.h>
#include <stdio.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <nlohmann/json.hpp>

#include "exporters/files.hpp"
#include "model/error.hpp"

namespace heart::exporters {
namespace {

namespace fs = std::filesystem;

/// A lock on a folder. The system lets go of it however the program ends.
struct Claim {
  int descriptor = -1;
  fs::path partial;

  Claim() = default;
  Claim(const Claim&) = delete;
  Claim& operator=(const Claim&) = delete;
  ~Claim() {
    std::error_code ignored;
    if (holds()) fs::remove_all(partial, ignored);
    if (descriptor >= 0) close(descriptor);
  }

  /// Whether the locked folder is the one that has the name now: it may have been moved into its place meanwhile.
  bool holds() const {
    struct stat locked {
    }, named{};
    return descriptor >= 0 && fstat(descriptor, &locked) == 0 && lstat(partial.c_str(), &named) == 0 &&
           locked.st_ino == named.st_ino && locked.st_dev == named.st_dev;
  }
};

bool holds_bundle(const fs::path& folder) {
  try {
    const auto manifest = nlohmann::json::parse(read_text(folder / "manifest.json"));
    return manifest.at("schema").get<std::string>().starts_with("heartgen-");
  } catch (const std::exception&) {
    return false;
  }
}

void require_replaceable(const fs::path& folder, Existing existing) {
  if (!fs::exists(fs::symlink_status(folder))) return;
  if (fs::is_directory(folder) && fs::is_empty(folder)) return;
  if (!holds_bundle(folder))
    throw UserError("exists and is not a bundle", folder.string(), "name another output folder, or move it away");
  if (existing == Existing::refuse)
    throw UserError("a bundle is there already", folder.string(),
                    "name another output folder, or replace the bundle with --force");
}

[[noreturn]] void refuse(const fs::path& folder, const std::string& why) {
  throw UserError("cannot be made: " + why, folder.string(), "name another output folder, where you may write");
}

/// Locks the folder `partial`, which is made where there is none.
std::shared_ptr<Claim> claim_folder(const fs::path& partial, const fs::path& folder) {
  auto claim = std::make_shared<Claim>();
  claim->partial = partial;
  std::error_code error;
  fs::create_directories(partial, error);
  if (error) refuse(folder, error.message());
  const int descriptor = open(partial.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor < 0) refuse(folder, std::error_code(errno, std::generic_category()).message());
  // Some network file systems know no locks: there the user has to see to it.
  if (flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    close(descriptor);
    throw UserError("another run is making a bundle there", folder.string(), "wait for it, or name another folder");
  }
  claim->descriptor = descriptor;
  return claim;
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
    make_empty(place.partial, place.folder);
    place.claim = claim;
    return place;
  }
  throw UserError("another run is making a bundle there", place.folder.string(), "name another folder");
}

void move_into_place(const ReservedPlace& place, Existing existing) {
  const fs::path &prepared = place.partial, &folder = place.folder;
  require_replaceable(folder, existing);
  std::error_code error;
  if (fs::exists(folder) && !fs::is_empty(folder)) {
    if (renameat2(AT_FDCWD, prepared.c_str(), AT_FDCWD, folder.c_str(), RENAME_EXCHANGE) == 0) {
      fs::remove_all(prepared, error);
      return;
    }
    const fs::path old = hidden_sibling(folder, "old");
    fs::remove_all(old, error);
    fs::rename(folder, old, error);
    if (!error) fs::rename(prepared, folder, error);
    if (!error) fs::remove_all(old, error);
  } else {
    fs::rename(prepared, folder, error);
  }
  if (error) throw UserError("cannot put the bundle in place: " + error.message(), folder.string(), "");
}

}  // namespace heart::exporters
