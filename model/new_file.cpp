// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/new_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "model/error.hpp"
#include "model/text.hpp"
#include "model/unfinished.hpp"

namespace heartgen {
namespace {

namespace fs = std::filesystem;

fs::path place_of(const fs::path& path) {
  std::error_code error;
  const auto place = fs::is_symlink(path, error) ? fs::canonical(path, error) : path;
  return error ? path : place;
}

bool is_written_aside(const fs::path& place) {
  std::error_code ignored;
  const auto folder = place.has_parent_path() ? place.parent_path() : fs::path(".");
  const bool is_plain = !fs::exists(place, ignored) || fs::is_regular_file(place, ignored);
  return is_plain && access(folder.c_str(), W_OK) == 0;
}

/// Whether the open file still has that name: its writer may have moved it into its place meanwhile.
bool has_name(int descriptor, const fs::path& name) {
  struct stat opened {
  }, named{};
  return fstat(descriptor, &opened) == 0 && lstat(name.c_str(), &named) == 0 && opened.st_ino == named.st_ino &&
         opened.st_dev == named.st_dev;
}

/// A lock that goes with the program, however it ends. Not flock, which HDF5 asks for when it opens its file.
bool lock_whole(int descriptor) {
  struct flock whole {};
  whole.l_type = F_WRLCK;
  return fcntl(descriptor, F_OFD_SETLK, &whole) == 0;
}

enum class Claim { held, of_another, impossible };

/// Opens `partial`, which a killed program may have left, and locks it.
Claim claim_file(const fs::path& partial, int& descriptor) {
  constexpr int attempts = 100;  // others may just have finished theirs
  for (int attempt = 0; attempt < attempts; ++attempt) {
    descriptor = open(partial.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (descriptor < 0) return Claim::impossible;
    const bool locked = lock_whole(descriptor);
    const auto why = errno;
    if (locked && has_name(descriptor, partial)) return Claim::held;
    close(descriptor);
    if (locked) continue;
    if (why == EAGAIN || why == EACCES) return Claim::of_another;
    unlink(partial.c_str());  // nobody uses that name where there are no locks
    return Claim::impossible;
  }
  return Claim::of_another;
}

}  // namespace

NewFile::NewFile(const fs::path& path_) : path(path_), place(place_of(path_)), partial(place) {
  wait_where_stopped();
  make_folder_of(place);
  if (!is_written_aside(place)) return;
  const auto named = [&](const std::string& mark) {
    return fs::path(place).replace_filename(fmt::format(".{}.{}", mark, place.filename().string()));
  };
  partial = named("partial");
  const auto claim = claim_file(partial, lock);
  if (claim == Claim::of_another)
    throw UserError("another run is writing this file", path.string(), "wait for it, or name another file");
  if (claim == Claim::impossible) {  // no locks there: a name that no other program takes
    lock = -1;
    partial = named(fmt::format("partial-{}", getpid()));
  }
  note_unfinished(partial);
}

NewFile::~NewFile() {
  std::error_code ignored;
  if (partial != place) {
    forget_unfinished(partial);
    fs::remove(partial, ignored);
  }
  if (lock >= 0) close(lock);
}

void NewFile::finish() {
  std::error_code error;
  if (partial != place) {
    forget_unfinished(partial);
    fs::rename(partial, place, error);
  }
  if (error) throw UserError("cannot be written: " + error.message(), path.string(), "name another file");
  partial = place;
}

}  // namespace heartgen
