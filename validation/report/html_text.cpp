// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/report/html_text.hpp"

namespace heartgen::report {

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '\'':
        result += "&#39;";
        break;
      default:
        result += static_cast<unsigned char>(c) < 32 && c != '\n' && c != '\t' ? ' ' : c;
    }
  return result;
}

std::string base64(const void* data, std::size_t bytes) {
  constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const auto* in = static_cast<const std::uint8_t*>(data);
  std::string out;
  out.reserve((bytes + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes; i += 3) {
    const auto byte = [&](std::size_t k) { return i + k < bytes ? static_cast<std::uint32_t>(in[i + k]) : 0u; };
    const std::uint32_t triple = byte(0) << 16 | byte(1) << 8 | byte(2);
    out += digits[triple >> 18 & 63];
    out += digits[triple >> 12 & 63];
    out += i + 1 < bytes ? digits[triple >> 6 & 63] : '=';
    out += i + 2 < bytes ? digits[triple & 63] : '=';
  }
  return out;
}

std::string png_source(const std::vector<std::uint8_t>& png) {
  return "data:image/png;base64," + base64(png.data(), png.size());
}

}  // namespace heartgen::report
