// Shows that messages which follow each other are of one writer, without a key that readers hold: a
// chain of SHA-256 hashes, each link the hash of the next one (Lamport, 1981).
//
//   link 0 = SHA-256(link 1), link 1 = SHA-256(link 2), ...     the last link is drawn at random
//
// The writer announces link 0 and shows one link more with every message. Whoever knows a link
// finds that a later one hashes to it; whoever has seen links up to one cannot make the next, and
// the ones seen prove nothing any more. A link says that its writer was there, not what the message
// says: that comes from the DDS writer (services/bus/writer_id.hpp).
//
// A writer of n links keeps about 2 sqrt(n) of them: every sqrt(n)th, and those between the two
// that it is at. The chain ends after n links; another one is another chain. Each object belongs to
// one thread.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/base/error.hpp"

namespace dyncal::inline contract {

using ChainLink = std::array<unsigned char, 32>;

// 64 hexadecimal digits, small letters.
[[nodiscard]] std::string to_string(const ChainLink& link);
// Nothing where the text is none.
[[nodiscard]] std::optional<ChainLink> parse_chain_link(std::string_view text);

struct NumberedLink {
  std::uint64_t number = 0; // of the announced end; those after it count from 1
  ChainLink link{};

  friend bool operator==(const NumberedLink&, const NumberedLink&) = default;
};

// The writer's side.
class OneWayChain {
public:
  // From the system's random numbers. Fails (device) where it has none.
  [[nodiscard]] static Expected<OneWayChain> draw(std::uint64_t length);
  // `last`: the secret.
  OneWayChain(const ChainLink& last, std::uint64_t length);

  [[nodiscard]] const ChainLink& announced() const { return every_[0]; }
  // The next link to show; nothing when all have been shown.
  [[nodiscard]] std::optional<NumberedLink> next();

private:
  std::uint64_t length_;
  std::uint64_t spacing_;
  std::uint64_t shown_ = 0;
  std::vector<ChainLink> every_;   // the links 0, spacing, 2 spacing ... and the last
  std::vector<ChainLink> between_; // up to the next one kept; the next to show stands last
};

// The reader's side: the latest link that counts.
class ChainFollower {
public:
  explicit ChainFollower(NumberedLink latest) : latest_(latest) {}

  [[nodiscard]] const NumberedLink& latest() const { return latest_; }
  // Whether it comes after the latest one, by at most `most_links` (each takes a hash), and hashes
  // to it; then it is the latest.
  [[nodiscard]] bool accept(const NumberedLink& shown, std::uint64_t most_links);

private:
  NumberedLink latest_;
};

} // namespace dyncal::inline contract
