// SPDX-License-Identifier: GPL-3.0-or-later
// Structs that tell their members, and one that forgets one.
#include "model/archive.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <optional>

namespace heartgen {
namespace {

struct Whole {
  std::string name;
  std::vector<Vec3> places;
  std::optional<Vec3> apex;
  double value = 1;
};
auto members(Whole& w) { return std::tie(w.name, w.places, w.apex, w.value); }

struct Forgetful {
  std::string name;
  std::vector<float> forgotten;
};
auto members(Forgetful& f) { return std::tie(f.name); }

static_assert(member_count<Whole>() == 4);
static_assert(all_members_are_told<Whole>());
static_assert(!all_members_are_told<Forgetful>());
static_assert(all_members_are_told<TetMesh>());
static_assert(all_members_are_told<UnstructuredData>());

struct Bytes : Packing<Bytes> {
  std::string bytes;
  void raw(const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); }
};
struct Back : Unpacking<Back> {
  const std::string& bytes;
  std::size_t at = 0;
  explicit Back(const std::string& b) : bytes(b) {}
  void require(std::size_t size) const {
    if (size > bytes.size() - at) throw std::runtime_error("cut");
  }
  void raw(void* data, std::size_t size) {
    require(size);
    std::memcpy(data, bytes.data() + at, size);
    at += size;
  }
};

TEST(Archive, WhatIsPutComesBack) {
  const Whole whole{"a", {{1, 2, 3}}, Vec3{4, 5, 6}, 7};
  Bytes out;
  out.put(whole);
  Back in(out.bytes);
  Whole again;
  in.get(again);
  EXPECT_EQ(again.name, "a");
  ASSERT_EQ(again.places.size(), 1U);
  EXPECT_EQ(again.places[0].z, 3);
  ASSERT_TRUE(again.apex);
  EXPECT_EQ(again.apex->x, 4);
  EXPECT_EQ(again.value, 7);
  EXPECT_EQ(in.at, out.bytes.size());
}

}  // namespace
}  // namespace heartgen
