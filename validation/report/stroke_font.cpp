// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/report/stroke_font.hpp"

#include <array>

namespace heartgen::report {
namespace {

constexpr std::array<std::string_view, 26> capitals = {
    "0c408c|1878",                    // A
    "000c5c7b8987765606|0050717456",  // B
    "826020020a2c6c8a",               // C
    "000c5c8a825000",                 // D
    "70000c7c|0656",                  // E
    "70000c|0656",                    // F
    "826020020a2c6c8a8757",           // G
    "000c|808c|0686",                 // H
    "000c",                           // I
    "606a4c2c0a",                     // J
    "000c|8007|348c",                 // K
    "000c7c",                         // L
    "0c0047808c",                     // M
    "0c008c80",                       // N
    "2060828a6c2c0a0220",             // O
    "0c006082846606",                 // P
    "2060828a6c2c0a0220|598c",        // Q
    "0c006082846606|468c",            // R
    "82602002042666888a6c2c0a",       // S
    "0080|404c",                      // T
    "000a2c6c8a80",                   // U
    "004c80",                         // V
    "002c536c80",                     // W
    "008c|800c",                      // X
    "004680|464c",                    // Y
    "00800c8c",                       // Z
};

constexpr std::array<std::string_view, 26> smalls = {
    "755424060a2c5c7a|747c",        // a
    "000c|062454767a5c2c0a",        // b
    "755424060a2c5c7b",             // c
    "707c|765424060a2c5c7a",        // d
    "0878765424060a2c5c7b",         // e
    "5030222c|0454",                // f
    "747e5g2g0f|765424060a2c5c7a",  // g
    "000c|062454767c",              // h
    "040c|0001",                    // i
    "242e1g0g|2021",                // j
    "000c|6408|377c",               // k
    "000c",                         // l
    "040c|062444565c|567494b6bc",   // m
    "040c|062454767c",              // n
    "2454767a5c2c0a0624",           // o
    "040g|062454767a5c2c0a",        // p
    "747g|765424060a2c5c7a",        // q
    "040c|062444",                  // r
    "6544240628486a4c2c0b",         // s
    "202a4c5c|0454",                // t
    "040a2c5c7a|747c",              // u
    "043c64",                       // v
    "042c466c84",                   // w
    "046c|640c",                    // x
    "043b|641g",                    // y
    "04640c6c",                     // z
};

constexpr std::array<std::string_view, 10> digits = {
    "2050727a5c2c0a0220",                   // 0
    "03303c",                               // 1
    "02205072740c7c",                       // 2
    "01205072745636|56787a5c2c0b",          // 3
    "5c500878",                             // 4
    "7000062555777a5c2c0a",                 // 5
    "614020020a2c5c7a78562608",             // 6
    "00702c",                               // 7
    "205072745626040220|26080a2c5c7a7856",  // 8
    "1b3c5c7a7250200204265674",             // 9
};

}  // namespace

std::string_view glyph_strokes(unsigned char character) {
  if (character >= 'A' && character <= 'Z') return capitals[static_cast<std::size_t>(character - 'A')];
  if (character >= 'a' && character <= 'z') return smalls[static_cast<std::size_t>(character - 'a')];
  if (character >= '0' && character <= '9') return digits[static_cast<std::size_t>(character - '0')];
  switch (character) {
    case '-':
      return "0747";
    case '_':
      return "0d7d";
    case '.':
      return "0b0c";
    case ',':
      return "1b0e";
    case ':':
      return "0506|0b0c";
    case '/':
      return "0c60";
    case '(':
      return "2003092c";
    case ')':
      return "0023290c";
    case '+':
      return "0767|343a";
    case '%':
      return "0c80|0020230300|6989898c6c69";
    case 0xB0:
      return "102031322313020110";
    default:
      return "";
  }
}

}  // namespace heartgen::report
