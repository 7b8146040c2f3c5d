#include "services/programs/web/access_token.hpp"

#include <fstream>

#include <gtest/gtest.h>

#include "services/bus/memory/stepped_clock.hpp"
#include "tests/temporary_folder.hpp"

namespace dyncal::inline programs::web {
namespace {

using namespace std::chrono_literals;

constexpr const char* secret = "0123456789abcdef0123";

TEST(IsSameSecret, ComparesWholeTexts) {
  EXPECT_TRUE(is_same_secret(secret, secret));
  EXPECT_FALSE(is_same_secret(secret, "0123456789abcdef0124"));
  EXPECT_FALSE(is_same_secret(secret, "0123456789abcdef012"));
  EXPECT_FALSE(is_same_secret(secret, "0123456789abcdef01230123456789abcdef0123"));
  EXPECT_FALSE(is_same_secret(secret, ""));
}

constexpr const char* right_header = "Bearer 0123456789abcdef0123";

TEST(AccessToken, TakesTheRightOneWithItsScheme) {
  bus::SteppedClock clock;
  AccessToken token(secret, clock);
  for (const char* scheme : {"Bearer ", "bearer ", "BEARER "}) {
    EXPECT_EQ(token.check(scheme + std::string(secret), "192.0.2.7"), TokenAnswer::right) << scheme;
  }
  for (const std::string& header : {std::string(secret), std::string(), std::string("Bearer"),
                                    std::string("Bearer "), std::string("Basic ") + secret}) {
    AccessToken other(secret, clock);
    EXPECT_EQ(other.check(header, "192.0.2.7"), TokenAnswer::wrong) << header;
  }
}

void guess(AccessToken& token, const std::string& address, TokenUse use = TokenUse::ordinary) {
  for (std::size_t i = 0; i < AccessToken::max_wrong; ++i) {
    EXPECT_EQ(token.check("Bearer wrong", address, use), TokenAnswer::wrong) << i;
  }
  EXPECT_EQ(token.check("Bearer wrong", address, use), TokenAnswer::too_many);
}

TEST(AccessToken, IsGuessedAtFiveTimesAMinuteFromOneAddress) {
  bus::SteppedClock clock;
  AccessToken token(secret, clock);
  guess(token, "192.0.2.7");
  EXPECT_EQ(token.check(right_header, "192.0.2.7"), TokenAnswer::too_many);
  EXPECT_EQ(token.check(right_header, "192.0.2.8"), TokenAnswer::right) << "another's guesses";
  clock.advance(AccessToken::wrong_period - 1s);
  EXPECT_EQ(token.check(right_header, "192.0.2.7"), TokenAnswer::too_many);
  clock.advance(1s);
  EXPECT_EQ(token.check(right_header, "192.0.2.7"), TokenAnswer::right);
}

TEST(AccessToken, NeverLocksWhatStopsTheExciterForTheRightOne) {
  bus::SteppedClock clock;
  AccessToken token(secret, clock);
  guess(token, "192.0.2.7", TokenUse::stops_the_exciter);
  for (const char* address : {"192.0.2.7", "192.0.2.8", "::1"}) {
    EXPECT_EQ(token.check(right_header, address, TokenUse::stops_the_exciter), TokenAnswer::right);
  }
  EXPECT_EQ(token.check("Bearer wrong", "192.0.2.7", TokenUse::stops_the_exciter),
            TokenAnswer::too_many);
  EXPECT_EQ(token.check(right_header, "192.0.2.7"), TokenAnswer::too_many)
      << "what does not stop it stays locked";
}

TEST(AccessToken, HoldsAsManyAddressesAsItHasRoomFor) {
  bus::SteppedClock clock;
  AccessToken token(secret, clock);
  guess(token, "192.0.2.7");
  for (std::size_t i = 0; i < 2 * AccessToken::max_addresses; ++i) {
    clock.advance(1ms);
    const std::string address = "10.0." + std::to_string(i / 256) + "." + std::to_string(i % 256);
    EXPECT_EQ(token.check("Bearer wrong", address), TokenAnswer::wrong) << address;
  }
  EXPECT_EQ(token.counted_addresses(), AccessToken::max_addresses);
  clock.advance(AccessToken::wrong_period);
  EXPECT_EQ(token.check(right_header, "192.0.2.7"), TokenAnswer::right);
  EXPECT_EQ(token.counted_addresses(), 0U);
}

TEST(CountedAddress, IsTheNetworkThatOneComputerHas) {
  EXPECT_EQ(counted_address("192.0.2.7"), "192.0.2.7");
  EXPECT_EQ(counted_address("::ffff:192.0.2.7"), "192.0.2.7");
  EXPECT_EQ(counted_address("2001:db8:0:1:a::7"), counted_address("2001:db8:0:1::8"));
  EXPECT_NE(counted_address("2001:db8:0:1::7"), counted_address("2001:db8:0:2::7"));
  EXPECT_EQ(counted_address("2001:db8:0:1::7"), "2001:db8:0:1::/64");
}

class ReadToken : public testing::Test {
protected:
  Expected<std::string> read(const std::string& text, std::filesystem::perms permissions) {
    const auto path = folder_.path() / "token";
    std::ofstream(path) << text;
    std::filesystem::permissions(path, permissions);
    return read_token(path);
  }
  tests::TemporaryFolder folder_;
};

TEST_F(ReadToken, TakesALongLineThatOthersCannotRead) {
  using std::filesystem::perms;
  EXPECT_EQ(read(std::string(secret) + "\n", perms::owner_read).value(), secret);
  EXPECT_NE(read(secret, perms::owner_read | perms::others_read).error().message.find("chmod"),
            std::string::npos);
  EXPECT_NE(read("short", perms::owner_read).error().message.find("too short"), std::string::npos);
  EXPECT_FALSE(read_token("/no/such/token"));
}

} // namespace
} // namespace dyncal::inline programs::web
