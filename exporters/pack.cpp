// SPDX-License-Identifier: GPL-3.0-or-later
// A bundle as one deterministic .tar.zst, and back.
#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <memory>
#include <set>

#include "exporters/bundle.hpp"
#include "exporters/files.hpp"
#include "exporters/manifest.hpp"
#include "model/error.hpp"
#include "model/input_file.hpp"
#include "model/new_file.hpp"
#include "model/text.hpp"

namespace heartgen::exporters {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t block_bytes = 1 << 20;
constexpr const char* not_packed = "the archive is not a packed bundle";

[[noreturn]] void fail(const fs::path& path, const std::string& problem, archive* handle) {
  const char* reason = handle ? archive_error_string(handle) : nullptr;
  throw UserError(problem + (reason ? std::string(": ") + reason : ""), path.string(), "");
}

using Entry = std::unique_ptr<archive_entry, decltype(&archive_entry_free)>;
using Writer = std::unique_ptr<archive, decltype(&archive_write_free)>;
using Reader = std::unique_ptr<archive, decltype(&archive_read_free)>;

/// Appends one file; time, owner and mode are the same everywhere.
void append(archive* writer, const fs::path& file, const std::string& name, const fs::path& archive_path) {
  Entry entry(archive_entry_new(), &archive_entry_free);
  archive_entry_set_pathname(entry.get(), name.c_str());
  archive_entry_set_filetype(entry.get(), AE_IFREG);
  archive_entry_set_perm(entry.get(), 0644);
  archive_entry_set_mtime(entry.get(), 0, 0);
  archive_entry_set_size(entry.get(), static_cast<la_int64_t>(fs::file_size(file)));
  if (archive_write_header(writer, entry.get()) != ARCHIVE_OK) fail(archive_path, "cannot be written", writer);
  std::ifstream stream(file, std::ios::binary);
  std::vector<char> block(block_bytes);
  while (stream.read(block.data(), static_cast<std::streamsize>(block.size())) || stream.gcount() > 0)
    if (archive_write_data(writer, block.data(), static_cast<std::size_t>(stream.gcount())) < 0)
      fail(archive_path, "cannot be written", writer);
}

/// Writes `file`, which becomes `path`.
void write_archive(const fs::path& folder, const Manifest& manifest, const fs::path& file, const fs::path& path) {
  Writer writer(archive_write_new(), &archive_write_free);
  if (archive_write_add_filter_zstd(writer.get()) != ARCHIVE_OK ||
      archive_write_set_format_pax_restricted(writer.get()) != ARCHIVE_OK ||
      archive_write_set_options(writer.get(), "zstd:compression-level=9") != ARCHIVE_OK ||
      archive_write_open_filename(writer.get(), file.c_str()) != ARCHIVE_OK)
    fail(path, "cannot be written", writer.get());
  const std::string top = manifest.name + "-" + manifest.version + "/";
  append(writer.get(), folder / "manifest.json", top + "manifest.json", path);
  for (const auto& listed : manifest.files) append(writer.get(), folder / listed.path, top + listed.path, path);
  if (archive_write_close(writer.get()) != ARCHIVE_OK) fail(path, "cannot be written", writer.get());
}

/// The path below the archive's top folder; throws for anything that is not a plain file inside it.
std::string checked_name(const fs::path& path, archive_entry* entry, std::set<std::string>& seen) {
  const char* raw = archive_entry_pathname(entry);
  const std::string full = raw ? raw : "";
  const auto refuse = [&](const std::string& why) {
    throw UserError(fmt::format("entry '{}' {}", full, why), path.string(), not_packed);
  };
  if (!is_safe_path(full)) refuse("leaves the folder");
  if (archive_entry_hardlink(entry) || archive_entry_symlink(entry) || archive_entry_filetype(entry) != AE_IFREG)
    refuse("is not a plain file");
  const auto slash = full.find('/');
  if (slash == std::string::npos) refuse("is not below a folder of its own");
  if (!seen.empty() && seen.begin()->substr(0, slash + 1) != full.substr(0, slash + 1)) refuse("is in another folder");
  if (!seen.insert(full).second) refuse("is there twice");
  return full.substr(slash + 1);
}

/// Hands the entry's bytes to `take(bytes, count, offset)`. Throws UserError where there are more than `most`.
template <class Take>
void read_entry(archive* reader, const fs::path& archive_path, std::int64_t most, const Take& take) {
  const void* data = nullptr;
  std::size_t bytes = 0;
  la_int64_t offset = 0;
  int status = ARCHIVE_OK;
  while ((status = archive_read_data_block(reader, &data, &bytes, &offset)) == ARCHIVE_OK) {
    if (offset < 0 || offset > most || static_cast<std::int64_t>(bytes) > most - offset)
      throw UserError("an entry is longer than it says", archive_path.string(), not_packed);
    take(static_cast<const char*>(data), bytes, static_cast<std::size_t>(offset));
  }
  if (status != ARCHIVE_EOF) fail(archive_path, "cannot be read", reader);
}

/// The first entry, which says what the others are.
std::string read_manifest_entry(archive* reader, const fs::path& path, std::set<std::string>& seen) {
  constexpr std::int64_t max_bytes = 1 << 26;
  archive_entry* entry = nullptr;
  const int status = archive_read_next_header(reader, &entry);
  if (status != ARCHIVE_OK && status != ARCHIVE_EOF) fail(path, "cannot be read", reader);
  if (status == ARCHIVE_EOF || checked_name(path, entry, seen) != "manifest.json")
    throw UserError("does not begin with manifest.json", path.string(), not_packed);
  std::string text;
  read_entry(reader, path, max_bytes, [&](const char* data, std::size_t bytes, std::size_t offset) {
    if (text.size() < offset + bytes) text.resize(offset + bytes);
    std::copy_n(data, bytes, text.begin() + static_cast<std::ptrdiff_t>(offset));
  });
  return text;
}

/// Path and bytes of what the manifest lists. Throws UserError where that is too much.
std::map<std::string, std::int64_t> listed_sizes(const Manifest& manifest, const fs::path& path, const fs::path& into) {
  constexpr std::size_t max_files = 100'000;
  if (manifest.files.size() > max_files)
    throw UserError(fmt::format("its manifest lists {} files", manifest.files.size()), path.string(),
                    fmt::format("a bundle has at most {}", max_files));
  std::map<std::string, std::int64_t> sizes;
  double all = 0;
  for (const auto& file : manifest.files) all += static_cast<double>(sizes[file.path] = file.bytes);
  std::error_code error;
  const auto space = fs::space(into, error);
  if (!error && all > static_cast<double>(space.available))
    throw UserError(
        fmt::format("unpacks to {:.2f} GB, and {:.2f} are free", all / 1e9, static_cast<double>(space.available) / 1e9),
        path.string(), "make room, or name a folder on another disk");
  return sizes;
}

void extract_entry(archive* reader, const fs::path& target, std::int64_t bytes_listed, const fs::path& archive_path) {
  fs::create_directories(target.parent_path());
  std::ofstream stream(target, std::ios::binary);
  read_entry(reader, archive_path, bytes_listed, [&](const char* data, std::size_t bytes, std::size_t offset) {
    stream.seekp(static_cast<std::streamoff>(offset));
    stream.write(data, static_cast<std::streamsize>(bytes));
  });
  stream.close();
  if (!stream) throw UserError("cannot be written", target.string(), "is there room on the disk?");
}

/// Only what the manifest lists, and no more bytes of it.
void extract_archive(const fs::path& path, const fs::path& folder) {
  Reader reader(archive_read_new(), &archive_read_free);
  archive_read_support_filter_zstd(reader.get());
  archive_read_support_format_tar(reader.get());
  if (archive_read_open_filename(reader.get(), path.c_str(), block_bytes) != ARCHIVE_OK)
    fail(path, "cannot be read", reader.get());
  std::set<std::string> seen;
  const auto text = read_manifest_entry(reader.get(), path, seen);
  const auto sizes = listed_sizes(parse_manifest(text, path.string() + ": manifest.json"), path, folder);
  write_text(folder / "manifest.json", text);
  archive_entry* entry = nullptr;
  int status = ARCHIVE_OK;
  while ((status = archive_read_next_header(reader.get(), &entry)) == ARCHIVE_OK) {
    const auto name = checked_name(path, entry, seen);
    const auto listed = sizes.find(name);
    if (listed == sizes.end() || archive_entry_size(entry) != listed->second)
      throw UserError(fmt::format("entry '{}' is not as the manifest lists it", name), path.string(), not_packed);
    extract_entry(reader.get(), folder / name, listed->second, path);
  }
  if (status != ARCHIVE_EOF) fail(path, "cannot be read", reader.get());
}

void require_whole(const fs::path& folder, const fs::path& named) {
  const auto problems = verify_bundle(folder);
  if (problems.empty()) return;
  std::string text = fmt::format("{} {}", problems[0].file, problems[0].what);
  if (problems.size() > 1) text += fmt::format(" (and {} more)", problems.size() - 1);
  throw UserError("the bundle does not verify: " + text, named.string(), "build or download it again");
}

}  // namespace

void pack_bundle(const fs::path& folder, const fs::path& archive) {
  if (const auto name = archive.filename().string(); !name.ends_with(".tar.zst") && !name.ends_with(".tzst"))
    throw UserError("a packed bundle is a tar file compressed by zstd", archive.string(), "name it NAME.tar.zst");
  require_whole(folder, folder);
  NewFile whole(archive);
  write_archive(folder, read_manifest(folder), whole.partial, archive);
  whole.finish();
}

void unpack_bundle(const fs::path& archive, const fs::path& folder) {
  require_input_file(archive);
  if (fs::exists(fs::symlink_status(plain_path(folder))))
    throw UserError("exists already", plain_path(folder).string(), "name a folder that does not exist");
  const auto place = reserve_place(folder, Existing::refuse);
  extract_archive(archive, place.partial);
  require_whole(place.partial, archive);
  move_into_place(place, Existing::refuse);
}

}  // namespace heartgen::exporters
