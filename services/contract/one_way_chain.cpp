#include "services/contract/one_way_chain.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <stdexcept>

#include <fmt/core.h>
#include <openssl/evp.h>
#include <sys/random.h>

namespace dyncal::inline contract {
namespace {

// One for many links: to look SHA-256 up takes longer than to use it.
class Hash {
public:
  Hash()
      : digest_(EVP_MD_fetch(nullptr, "SHA256", nullptr), EVP_MD_free),
        context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
    if (!digest_ || !context_ || EVP_DigestInit_ex2(context_.get(), digest_.get(), nullptr) != 1) {
      throw std::runtime_error("SHA-256 is not available in this system's OpenSSL");
    }
  }
  [[nodiscard]] ChainLink operator()(const ChainLink& link) {
    ChainLink hash;
    EVP_DigestInit_ex2(context_.get(), nullptr, nullptr);
    EVP_DigestUpdate(context_.get(), link.data(), link.size());
    EVP_DigestFinal_ex(context_.get(), hash.data(), nullptr);
    return hash;
  }

private:
  std::unique_ptr<EVP_MD, void (*)(EVP_MD*)> digest_;
  std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context_;
};

} // namespace

std::string to_string(const ChainLink& link) {
  std::string text;
  for (const unsigned char byte : link) {
    text += fmt::format("{:02x}", byte);
  }
  return text;
}

std::optional<ChainLink> parse_chain_link(std::string_view text) {
  ChainLink link{};
  if (text.size() != 2 * link.size()) {
    return std::nullopt;
  }
  for (std::size_t i = 0; i < link.size(); ++i) {
    const char* digits = text.data() + 2 * i;
    if (std::from_chars(digits, digits + 2, link[i], 16).ptr != digits + 2) {
      return std::nullopt;
    }
  }
  return link;
}

Expected<OneWayChain> OneWayChain::draw(std::uint64_t length) {
  ChainLink last;
  if (getrandom(last.data(), last.size(), 0) != static_cast<ssize_t>(last.size())) {
    return fail(ErrorCode::device, "this system gives no random numbers (getrandom)");
  }
  return OneWayChain(last, length);
}

OneWayChain::OneWayChain(const ChainLink& last, std::uint64_t length)
    : length_(length), spacing_(std::max<std::uint64_t>(
                           1, static_cast<std::uint64_t>(std::sqrt(static_cast<double>(length))))) {
  Hash hash;
  ChainLink link = last;
  every_.push_back(link);
  for (std::uint64_t number = length; number > 0;) {
    link = hash(link);
    if (--number % spacing_ == 0) {
      every_.push_back(link);
    }
  }
  std::reverse(every_.begin(), every_.end());
}

std::optional<NumberedLink> OneWayChain::next() {
  if (shown_ == length_) {
    return std::nullopt;
  }
  if (between_.empty()) {
    Hash hash;
    // The next one stands last.
    const std::uint64_t block = shown_ / spacing_;
    const std::uint64_t end = std::min((block + 1) * spacing_, length_);
    between_.push_back(every_[block + 1]);
    while (between_.size() < end - shown_) {
      between_.push_back(hash(between_.back()));
    }
  }
  const NumberedLink shown{++shown_, between_.back()};
  between_.pop_back();
  return shown;
}

bool ChainFollower::accept(const NumberedLink& shown, std::uint64_t most_links) {
  if (shown.number <= latest_.number || shown.number - latest_.number > most_links) {
    return false;
  }
  Hash hash;
  ChainLink link = shown.link;
  for (std::uint64_t number = shown.number; number > latest_.number; --number) {
    link = hash(link);
  }
  if (link != latest_.link) {
    return false;
  }
  latest_ = shown;
  return true;
}

} // namespace dyncal::inline contract
