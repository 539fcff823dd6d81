// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/printable.hpp"

namespace heartgen {

std::string printable(std::string_view text) {
  constexpr unsigned char space = 0x20, del = 0x7f, c1_lead = 0xc2, c1_end = 0xa0;
  std::string result;
  result.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    const auto next = static_cast<unsigned char>(i + 1 < text.size() ? text[i + 1] : ' ');
    const bool is_c1 = c == c1_lead && next >= 0x80 && next < c1_end;
    const bool is_control = (c < space && c != '\n' && c != '\t') || c == del || is_c1;
    result += is_control ? '?' : text[i];
    i += is_c1;
  }
  return result;
}

bool is_printable(std::string_view text) { return printable(text) == text; }

}  // namespace heartgen
