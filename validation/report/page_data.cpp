// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/report/page_data.hpp"

#include <zlib.h>

#include <stdexcept>

#include "validation/report/html_text.hpp"

namespace heartgen::report {

std::vector<std::uint8_t> deflated(const std::vector<std::uint8_t>& bytes) {
  constexpr int level = 3;  // level 6 takes three times as long for a twentieth of the size
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::vector<std::uint8_t> packed(size);
  if (compress2(packed.data(), &size, bytes.data(), static_cast<uLong>(bytes.size()), level) != Z_OK)
    throw std::runtime_error("zlib cannot compress the report's data");
  packed.resize(size);
  return packed;
}

std::string deflated_base64(const std::vector<std::uint8_t>& bytes) {
  const auto packed = deflated(bytes);
  return base64(packed.data(), packed.size());
}

}  // namespace heartgen::report
