// SPDX-License-Identifier: GPL-3.0-or-later
// The house as cmake/rooms.cmake declares it against the house as its files are. `make rooms` prints the arrows.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "architecture/source_files.hpp"

namespace heartgen {
namespace {

struct Room {
  std::string name, folder, sentence;
  std::set<std::string> depends;
};

std::set<std::string> words(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

std::vector<Room> declared() {
  const auto text = text_of(root / "cmake/rooms.cmake");
  const std::regex call(
      R"re(heartgen_room\((\w+)(?: PARTS)? FOLDER (\S+)\s+SENTENCE "([^"]+)"(?:\s+DEPENDS ([a-z_\s]+))?[^)]*\))re");
  std::vector<Room> rooms;
  for (std::sregex_iterator at(text.begin(), text.end(), call), end; at != end; ++at)
    rooms.push_back({(*at)[1], (*at)[2], (*at)[3], words((*at)[4])});
  return rooms;
}

std::vector<fs::path> sources() {
  return sources_in({"include", "model", "generator", "validation", "exporters", "datasets", "benchmarks"});
}

/// The public headers are the library's.
std::string folder_of(const fs::path& source) {
  const auto folder = fs::relative(source, root).parent_path().string();
  return folder == "include/heartgen" ? "generator/library" : folder;
}

/// Includes of other rooms: folder to folder to how many.
using Arrows = std::map<std::string, std::map<std::string, int>>;

Arrows arrows() {
  const std::regex include(
      R"re(#include [<"]((?:model|generator|validation|exporters|datasets|benchmarks|heartgen)[^">]*)/([^">/]+)[">])re");
  Arrows found;
  for (const auto& source : sources()) {
    const auto text = text_of(source);
    for (std::sregex_iterator at(text.begin(), text.end(), include), end; at != end; ++at)
      if (const auto folder = (*at)[1] == "heartgen" ? "generator/library" : (*at)[1].str();
          folder != folder_of(source) && (*at)[2] != "version.hpp")  // which every room may include
        ++found[folder_of(source)][folder];
  }
  return found;
}

TEST(Rooms, EveryFolderIsOne) {
  std::set<std::string> folders;
  for (const auto& room : declared()) EXPECT_TRUE(folders.insert(room.folder).second) << room.folder;
  for (const auto& source : sources()) EXPECT_TRUE(folders.count(folder_of(source))) << source;
}

/// Prints them too, with how many includes each stands for.
TEST(Rooms, ArrowsAreTheDeclaredOnes) {
  std::map<std::string, std::string> name_of;
  for (const auto& room : declared()) name_of[room.folder] = room.name;
  auto seen = arrows();
  for (const auto& room : declared()) {
    std::set<std::string> included;
    std::vector<std::string> counts;
    for (const auto& [folder, count] : seen[room.folder]) {
      ASSERT_TRUE(name_of.count(folder)) << room.folder << " includes " << folder;
      included.insert(name_of[folder]);
      counts.push_back(fmt::format("{} {}", name_of[folder], count));
    }
    EXPECT_EQ(included, room.depends) << room.name;
    fmt::print("{:<13} {}\n              -> {}\n", room.name, room.sentence, fmt::join(counts, ", "));
  }
}

/// A room depends on rooms above it in the file: what cannot be drawn in one direction cannot be declared.
TEST(Rooms, PointOneWay) {
  std::set<std::string> above;
  const auto rooms = declared();
  EXPECT_GT(rooms.size(), 20U);
  for (const auto& room : rooms) {
    for (const auto& other : room.depends) EXPECT_TRUE(above.count(other)) << room.name << " depends on " << other;
    above.insert(room.name);
  }
}

TEST(Rooms, NamespaceIsTheRooms) {
  const std::regex opened(R"(\nnamespace heartgen(?:::(\w+))?)");
  for (const auto& room : declared())
    for (const auto& source : sources()) {
      if (folder_of(source) != room.folder) continue;
      const auto text = text_of(source);
      std::set<std::string> names;
      for (std::sregex_iterator at(text.begin(), text.end(), opened), end; at != end; ++at) names.insert((*at)[1]);
      if (names.empty()) continue;  // main()
      // Plain "heartgen" for what a library finds by a type's namespace.
      EXPECT_TRUE(names.count(room.name == "model" ? "math" : room.name) || names.count("")) << source;
    }
}

}  // namespace
}  // namespace heartgen
