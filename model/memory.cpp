// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/memory.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <string>

#include "model/error.hpp"

namespace heartgen {
namespace {

namespace fs = std::filesystem;
constexpr double unlimited = std::numeric_limits<double>::infinity();
std::atomic<double> users_limit{0};

/// The number that a file holds; none ("max", no such file): unlimited.
double limit_in(const fs::path& file) {
  std::ifstream stream(file);
  double bytes = 0;
  return stream >> bytes ? bytes : unlimited;
}

/// Of a group and of all above it, up to the mount. A container sees its own group as the mount itself.
double min_limit(const fs::path& mount, std::string group, const char* file) {
  double least = limit_in(mount / file);
  for (; group.size() > 1; group = fs::path(group).parent_path().string())
    least = std::min(least, limit_in(mount / group.substr(1) / file));
  return least;
}

double own_limit(int resource) {
  rlimit limit{};
  if (getrlimit(static_cast<__rlimit_resource_t>(resource), &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
    return unlimited;
  return static_cast<double>(limit.rlim_cur);
}

double physical_bytes() {
  const auto pages = sysconf(_SC_PHYS_PAGES), bytes = sysconf(_SC_PAGESIZE);
  return pages > 0 && bytes > 0 ? static_cast<double>(pages) * static_cast<double>(bytes) : unlimited;
}

bool has_entry(const std::string& list, const std::string& entry) {
  return ("," + list + ",").find("," + entry + ",") != std::string::npos;
}

/// Bytes that the letters behind a number stand for; 0: none known.
double unit_bytes(std::string unit) {
  constexpr std::string_view letters = "KMGT";
  for (char& c : unit) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  if (unit.empty() || unit == "B") return 1;
  const auto power = letters.find(unit.front());
  const std::string rest = unit.substr(1);
  if (power == std::string_view::npos || !(rest.empty() || rest == "B" || rest == "IB")) return 0;
  double bytes = 1;
  for (std::size_t p = 0; p <= power; ++p) bytes *= rest == "B" ? 1000 : 1024;
  return bytes;
}

}  // namespace

double cgroup_bytes(const fs::path& membership, const fs::path& mounts) {
  double least = unlimited;
  std::ifstream file(membership);
  for (std::string line; std::getline(file, line);) {  // "4:memory:/a/b" of version 1, "0::/a/b" of version 2
    const auto first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1), group = line.substr(second + 1);
    if (controllers.empty()) least = std::min(least, min_limit(mounts, group, "memory.max"));
    if (has_entry(controllers, "memory"))
      least = std::min(least, min_limit(mounts / "memory", group, "memory.limit_in_bytes"));
  }
  return least;
}

double memory_bytes() {
  const double users = users_limit;
  const double least = std::min({physical_bytes(), cgroup_bytes("/proc/self/cgroup", "/sys/fs/cgroup"),
                                 own_limit(RLIMIT_AS), own_limit(RLIMIT_DATA), users > 0 ? users : unlimited});
  return least == unlimited ? 0 : least;
}

void set_memory_limit(double bytes) { users_limit = bytes; }

double bytes_of_text(const std::string& text, const std::string& where) {
  constexpr double least = 1 << 20;
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  std::string unit(end, text.data() + text.size());
  if (!unit.empty() && unit.front() == ' ') unit.erase(0, 1);
  const double bytes = number * unit_bytes(unit);
  if (error != std::errc() || !(bytes >= least) || !std::isfinite(bytes))
    throw UserError(fmt::format("\"{}\" is no amount of memory", text), where,
                    "give a number and a unit, such as 8G or 512M");
  return bytes;
}

std::string text_of_bytes(double bytes) {
  constexpr std::array units{"KiB", "MiB", "GiB", "TiB"};
  std::size_t unit = 0;
  for (bytes /= 1024; bytes >= 1000 && unit + 1 < units.size(); ++unit) bytes /= 1024;
  return fmt::format("{:.3g} {}", bytes, units[unit]);
}

}  // namespace heartgen
