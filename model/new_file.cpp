#include "model/new_file.hpp"

#include <unistd.h>

#include "model/error.hpp"
#include "model/text.hpp"

namespace heart {
namespace {

namespace fs = std::filesystem;

fs::path place_of(const fs::path& path) {
  std::error_code error;
  const auto place = fs::is_symlink(path, error) ? fs::canonical(path, error) : path;
  return error ? path : place;
}

fs::path partial_of(const fs::path& place) {
  std::error_code ignored;
  const auto folder = place.has_parent_path() ? place.parent_path() : fs::path(".");
  const bool is_plain = !fs::exists(place, ignored) || fs::is_regular_file(place, ignored);
  if (!is_plain || access(folder.c_str(), W_OK) != 0) return place;
  return fs::path(place).replace_filename(".partial." + place.filename().string());
}

}  // namespace

NewFile::NewFile(const fs::path& path_) : path(path_), place(place_of(path_)) {
  make_folder_of(place);
  partial = partial_of(place);
}

NewFile::~NewFile() {
  std::error_code ignored;
  if (partial != place) fs::remove(partial, ignored);
}

void NewFile::finish() {
  std::error_code error;
  if (partial != place) fs::rename(partial, place, error);
  if (error) throw UserError("cannot be written: " + error.message(), path.string(), "name another file");
  partial = place;
}

}  // namespace heart
