// SPDX-License-Identifier: GPL-3.0-or-later
#include <openssl/evp.h>

#include <fstream>
#include <memory>
#include <vector>

#include "exporters/bundle.hpp"
#include "model/error.hpp"
#include "model/input_file.hpp"

namespace heartgen::exporters {
namespace {

class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new(), &EVP_MD_CTX_free) { EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr); }
  void add(const char* data, std::size_t bytes) { EVP_DigestUpdate(context_.get(), data, bytes); }
  std::string hex() {
    unsigned char digest[EVP_MAX_MD_SIZE];
    unsigned int length = 0;
    EVP_DigestFinal_ex(context_.get(), digest, &length);
    constexpr char digits[] = "0123456789abcdef";
    std::string text;
    for (unsigned int i = 0; i < length; ++i) {
      text += digits[digest[i] >> 4];
      text += digits[digest[i] & 15];
    }
    return text;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

}  // namespace

std::string sha256_of_file(const std::filesystem::path& path) {
  require_input_file(path);
  std::ifstream stream(path, std::ios::binary);
  Sha256 sha;
  std::vector<char> block(1 << 20);
  while (stream.read(block.data(), static_cast<std::streamsize>(block.size())) || stream.gcount() > 0)
    sha.add(block.data(), static_cast<std::size_t>(stream.gcount()));
  if (stream.bad()) throw UserError("reading failed halfway", path.string(), "");
  return sha.hex();
}

std::string sha256_of_text(const std::string& text) {
  Sha256 sha;
  sha.add(text.data(), text.size());
  return sha.hex();
}

}  // namespace heartgen::exporters
