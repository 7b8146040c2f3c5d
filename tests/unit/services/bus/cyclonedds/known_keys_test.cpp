// How many keys are held, and which.
#include "services/bus/cyclonedds/known_keys.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

namespace dyncal::bus {
namespace {

KeyHash hash_of(std::size_t number) {
  KeyHash hash{};
  for (std::size_t i = 0; i < sizeof number; ++i) {
    hash[i] = static_cast<unsigned char>(number >> (8 * i));
  }
  return hash;
}

Key key_of(std::size_t number) {
  return {{"bench", fmt::format("run {}", number)}, {1, 2}};
}

TEST(KnownKeys, HoldsTheNewestOfMoreThanThereIsRoomFor) {
  KnownKeys keys;
  constexpr std::size_t seen = 3 * KnownKeys::max_keys;
  for (std::size_t i = 0; i < seen; ++i) {
    keys.remember(hash_of(i), key_of(i));
    keys.remember(hash_of(i), key_of(i)); // each message of an instance has it
    EXPECT_EQ(keys.recall(hash_of(i)), key_of(i));
  }
  EXPECT_EQ(keys.size(), KnownKeys::max_keys);
  EXPECT_EQ(keys.recall(hash_of(seen - KnownKeys::max_keys)), key_of(seen - KnownKeys::max_keys));
  EXPECT_EQ(keys.recall(hash_of(seen - KnownKeys::max_keys - 1)), std::nullopt);
}

} // namespace
} // namespace dyncal::bus
