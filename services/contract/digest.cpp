#include "services/contract/digest.hpp"

#include <array>
#include <stdexcept>

#include <fmt/core.h>
#include <openssl/evp.h>

namespace dyncal::inline contract {

struct Digest::Context {
  EVP_MD_CTX* evp = EVP_MD_CTX_new();
  Context() {
    if (evp == nullptr || EVP_DigestInit_ex(evp, EVP_sha256(), nullptr) != 1) {
      throw std::runtime_error("SHA-256 is not available in this system's OpenSSL");
    }
  }
  ~Context() { EVP_MD_CTX_free(evp); }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
};

Digest::Digest() : context_(std::make_unique<Context>()) {}
Digest::~Digest() = default;

void Digest::add(const void* data, std::size_t bytes) {
  EVP_DigestUpdate(context_->evp, data, bytes);
}

std::string Digest::hex() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> value{};
  unsigned length = 0;
  EVP_DigestFinal_ex(context_->evp, value.data(), &length);
  std::string text;
  for (unsigned i = 0; i < length; ++i) {
    text += fmt::format("{:02x}", value[i]);
  }
  return text;
}

std::string sha256_hex(std::string_view text) {
  Digest digest;
  digest.add(text.data(), text.size());
  return digest.hex();
}

} // namespace dyncal::inline contract
