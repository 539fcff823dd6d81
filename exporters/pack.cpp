// A bundle as one deterministic .tar.zst, and back.
#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>

#include <fstream>
#include <memory>
#include <set>

#include "exporters/bundle.hpp"
#include "exporters/files.hpp"
#include "exporters/manifest.hpp"
#include "model/error.hpp"

namespace heart::exporters {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t block_bytes = 1 << 20;

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

void write_archive(const fs::path& folder, const Manifest& manifest, const fs::path& path) {
  Writer writer(archive_write_new(), &archive_write_free);
  if (archive_write_add_filter_zstd(writer.get()) != ARCHIVE_OK ||
      archive_write_set_format_pax_restricted(writer.get()) != ARCHIVE_OK ||
      archive_write_set_options(writer.get(), "zstd:compression-level=9") != ARCHIVE_OK ||
      archive_write_open_filename(writer.get(), path.c_str()) != ARCHIVE_OK)
    fail(path, "cannot be written", writer.get());
  const std::string top = manifest.name + "-" + manifest.version + "/";
  append(writer.get(), folder / "manifest.json", top + "manifest.json", path);
  for (const auto& file : manifest.files) append(writer.get(), folder / file.path, top + file.path, path);
  if (archive_write_close(writer.get()) != ARCHIVE_OK) fail(path, "cannot be written", writer.get());
}

/// The path below the archive's top folder; throws for anything that is not a plain file inside it.
std::string checked_name(const fs::path& path, archive_entry* entry, std::set<std::string>& seen) {
  const char* raw = archive_entry_pathname(entry);
  const std::string full = raw ? raw : "";
  const auto refuse = [&](const std::string& why) {
    throw UserError(fmt::format("entry '{}' {}", full, why), path.string(), "the archive is not a packed bundle");
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

void extract_entry(archive* reader, const fs::path& target, const fs::path& archive_path) {
  fs::create_directories(target.parent_path());
  std::ofstream stream(target, std::ios::binary);
  const void* data = nullptr;
  std::size_t bytes = 0;
  la_int64_t offset = 0;
  int status = ARCHIVE_OK;
  while ((status = archive_read_data_block(reader, &data, &bytes, &offset)) == ARCHIVE_OK) {
    stream.seekp(offset);
    stream.write(static_cast<const char*>(data), static_cast<std::streamsize>(bytes));
  }
  if (status != ARCHIVE_EOF) fail(archive_path, "cannot be read", reader);
  stream.close();
  if (!stream) throw UserError("cannot be written", target.string(), "is there room on the disk?");
}

void extract_archive(const fs::path& path, const fs::path& folder) {
  Reader reader(archive_read_new(), &archive_read_free);
  archive_read_support_filter_zstd(reader.get());
  archive_read_support_format_tar(reader.get());
  if (archive_read_open_filename(reader.get(), path.c_str(), block_bytes) != ARCHIVE_OK)
    fail(path, "cannot be read", reader.get());
  std::set<std::string> seen;
  archive_entry* entry = nullptr;
  int status = ARCHIVE_OK;
  while ((status = archive_read_next_header(reader.get(), &entry)) == ARCHIVE_OK)
    extract_entry(reader.get(), folder / checked_name(path, entry, seen), path);
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
  const fs::path partial = hidden_sibling(archive, "partial");
  std::error_code error;
  try {
    write_archive(folder, read_manifest(folder), partial);
    fs::rename(partial, archive, error);
    if (error) throw UserError("cannot be written: " + error.message(), archive.string(), "");
  } catch (...) {
    fs::remove(partial, error);
    throw;
  }
}

void unpack_bundle(const fs::path& archive, const fs::path& folder) {
  const fs::path target = plain_path(folder);
  if (!fs::is_regular_file(archive)) throw UserError("no such file", archive.string(), "");
  if (fs::exists(fs::symlink_status(target)))
    throw UserError("exists already", target.string(), "name a folder that does not exist");
  const fs::path partial = hidden_sibling(target, "partial");
  std::error_code error;
  fs::remove_all(partial, error);
  fs::create_directories(partial, error);
  if (error) throw UserError("cannot be made: " + error.message(), target.string(), "");
  try {
    extract_archive(archive, partial);
    require_whole(partial, archive);
    fs::rename(partial, target);
  } catch (...) {
    fs::remove_all(partial, error);
    throw;
  }
}

}  // namespace heart::exporters
