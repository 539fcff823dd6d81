// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/printable.hpp"

#include <gtest/gtest.h>

namespace heartgen {
namespace {

TEST(Printable, TakesWhatSteersTerminals) {
  EXPECT_EQ(printable("\x1b[31mred\x1b[0m\a\r\x7f"), "?[31mred?[0m???");
  EXPECT_EQ(printable("\xc2\x9b"
                      "31m"),
            "?31m")
      << "CSI as one character";
  EXPECT_EQ(printable(std::string("a\0b", 3)), "a?b");
}

TEST(Printable, LeavesTextAsItIs) {
  for (const char* text : {"", "two\nlines\tand a tab", "Herz, c\xc5\x93ur, \xc2\xa0\xc2\xb5m, \xe5\xbf\x83", "\xc2"}) {
    EXPECT_EQ(printable(text), text);
    EXPECT_TRUE(is_printable(text));
  }
  EXPECT_FALSE(is_printable("\x1b"));
}

}  // namespace
}  // namespace heartgen
