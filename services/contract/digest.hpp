// SHA-256 of what a result was made from: recipe and samples, as hexadecimal text. Each object
// belongs to one thread.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace dyncal::inline contract {

class Digest {
public:
  Digest();
  ~Digest();
  Digest(const Digest&) = delete;
  Digest& operator=(const Digest&) = delete;

  void add(const void* data, std::size_t bytes);
  // 64 hexadecimal digits; the object is spent afterwards.
  [[nodiscard]] std::string hex();

private:
  struct Context;
  std::unique_ptr<Context> context_;
};

[[nodiscard]] std::string sha256_hex(std::string_view text);

} // namespace dyncal::inline contract
