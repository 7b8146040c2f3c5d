#include "services/programs/web/access_tokens.hpp"

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

TokenAnswer answer_of(AccessTokens& tokens, const std::string& header, const std::string& address,
                      TokenUse use = TokenUse::ordinary) {
  return tokens.check(header, address, Role::operate, use).answer;
}

TEST(AccessTokens, TakesTheRightOneWithItsScheme) {
  bus::SteppedClock clock;
  AccessTokens token({{.token = secret}}, clock);
  for (const char* scheme : {"Bearer ", "bearer ", "BEARER "}) {
    EXPECT_EQ(answer_of(token, scheme + std::string(secret), "192.0.2.7"), TokenAnswer::right)
        << scheme;
  }
  EXPECT_EQ(answer_of(token, "", "192.0.2.7"), TokenAnswer::none);
  for (const std::string& header : {std::string(secret), std::string("Bearer"),
                                    std::string("Bearer "), std::string("Basic ") + secret}) {
    AccessTokens other({{.token = secret}}, clock);
    EXPECT_EQ(answer_of(other, header, "192.0.2.7"), TokenAnswer::wrong) << header;
  }
}

// "ada:0123456789abcdef0123" and "screen:fedcba98765432100000" as browsers send them.
constexpr const char* ada_header = "Basic YWRhOjAxMjM0NTY3ODlhYmNkZWYwMTIz";
constexpr const char* screen_header = "Basic c2NyZWVuOmZlZGNiYTk4NzY1NDMyMTAwMDAw";

TEST(AccessTokens, KnowsWhoShowsOneAndWhatHeMay) {
  bus::SteppedClock clock;
  AccessTokens tokens(
      {{Role::operate, "ada", secret}, {Role::watch, "screen", "fedcba98765432100000"}}, clock);
  EXPECT_TRUE(tokens.are_needed_to_watch());
  for (const char* header : {right_header, ada_header}) {
    const auto operates = tokens.check(header, "192.0.2.7", Role::operate);
    EXPECT_EQ(operates.answer, TokenAnswer::right);
    EXPECT_EQ(operates.name, "ada");
    EXPECT_EQ(tokens.check(header, "192.0.2.7", Role::watch).answer, TokenAnswer::right);
  }
  for (const char* header : {"Bearer fedcba98765432100000", screen_header}) {
    EXPECT_EQ(tokens.check(header, "192.0.2.7", Role::watch).answer, TokenAnswer::right);
    EXPECT_EQ(tokens.check(header, "192.0.2.7", Role::operate).answer, TokenAnswer::not_enough);
    EXPECT_EQ(tokens.check(header, "192.0.2.7", Role::operate, TokenUse::stops_the_exciter).answer,
              TokenAnswer::not_enough);
  }
  EXPECT_EQ(tokens.check("Basic YWRhOmZlZGNiYTk4NzY1NDMyMTAwMDAw", "192.0.2.7", Role::watch).answer,
            TokenAnswer::wrong)
      << "ada with the token of the screen";
}

void guess(AccessTokens& token, const std::string& address, TokenUse use = TokenUse::ordinary) {
  for (std::size_t i = 0; i < AccessTokens::max_wrong; ++i) {
    EXPECT_EQ(answer_of(token, "Bearer wrong", address, use), TokenAnswer::wrong) << i;
  }
  EXPECT_EQ(answer_of(token, "Bearer wrong", address, use), TokenAnswer::too_many);
}

TEST(AccessTokens, IsGuessedAtFiveTimesAMinuteFromOneAddress) {
  bus::SteppedClock clock;
  AccessTokens token({{.token = secret}}, clock);
  guess(token, "192.0.2.7");
  EXPECT_EQ(answer_of(token, right_header, "192.0.2.7"), TokenAnswer::too_many);
  EXPECT_EQ(answer_of(token, right_header, "192.0.2.8"), TokenAnswer::right) << "another's guesses";
  clock.advance(AccessTokens::wrong_period - 1s);
  EXPECT_EQ(answer_of(token, right_header, "192.0.2.7"), TokenAnswer::too_many);
  clock.advance(1s);
  EXPECT_EQ(answer_of(token, right_header, "192.0.2.7"), TokenAnswer::right);
}

TEST(AccessTokens, NeverLocksWhatStopsTheExciterForTheRightOne) {
  bus::SteppedClock clock;
  AccessTokens token({{.token = secret}}, clock);
  guess(token, "192.0.2.7", TokenUse::stops_the_exciter);
  for (const char* address : {"192.0.2.7", "192.0.2.8", "::1"}) {
    EXPECT_EQ(answer_of(token, right_header, address, TokenUse::stops_the_exciter),
              TokenAnswer::right);
  }
  EXPECT_EQ(answer_of(token, "Bearer wrong", "192.0.2.7", TokenUse::stops_the_exciter),
            TokenAnswer::too_many);
  EXPECT_EQ(answer_of(token, right_header, "192.0.2.7"), TokenAnswer::too_many)
      << "what does not stop it stays locked";
}

TEST(AccessTokens, HoldsAsManyAddressesAsItHasRoomFor) {
  bus::SteppedClock clock;
  AccessTokens token({{.token = secret}}, clock);
  guess(token, "192.0.2.7");
  for (std::size_t i = 0; i < 2 * AccessTokens::max_addresses; ++i) {
    clock.advance(1ms);
    const std::string address = "10.0." + std::to_string(i / 256) + "." + std::to_string(i % 256);
    EXPECT_EQ(answer_of(token, "Bearer wrong", address), TokenAnswer::wrong) << address;
  }
  EXPECT_EQ(token.counted_addresses(), AccessTokens::max_addresses);
  clock.advance(AccessTokens::wrong_period);
  EXPECT_EQ(answer_of(token, right_header, "192.0.2.7"), TokenAnswer::right);
  EXPECT_EQ(token.counted_addresses(), 0U);
}

TEST(CountedAddress, IsTheNetworkThatOneComputerHas) {
  EXPECT_EQ(counted_address("192.0.2.7"), "192.0.2.7");
  EXPECT_EQ(counted_address("::ffff:192.0.2.7"), "192.0.2.7");
  EXPECT_EQ(counted_address("2001:db8:0:1:a::7"), counted_address("2001:db8:0:1::8"));
  EXPECT_NE(counted_address("2001:db8:0:1::7"), counted_address("2001:db8:0:2::7"));
  EXPECT_EQ(counted_address("2001:db8:0:1::7"), "2001:db8:0:1::/64");
}

class ReadTokens : public testing::Test {
protected:
  Expected<std::vector<TokenHolder>> read(const std::string& text,
                                          std::filesystem::perms permissions) {
    const auto path = folder_.path() / "token";
    std::ofstream(path) << text;
    std::filesystem::permissions(path, permissions);
    return read_tokens(path);
  }
  tests::TemporaryFolder folder_;
};

TEST_F(ReadTokens, TakesALongLineThatOthersCannotRead) {
  using std::filesystem::perms;
  const auto one = read(std::string(secret) + "\n", perms::owner_read);
  ASSERT_TRUE(one) << one.error().message;
  ASSERT_EQ(one->size(), 1U);
  EXPECT_EQ(one->front().token, secret);
  EXPECT_EQ(one->front().role, Role::operate);
  EXPECT_EQ(read("a secret of the laboratory\n", perms::owner_read).value().front().token,
            "a secret of the laboratory");
  EXPECT_NE(read(secret, perms::owner_read | perms::others_read).error().message.find("chmod"),
            std::string::npos);
  EXPECT_NE(read("short", perms::owner_read).error().message.find("too short"), std::string::npos);
  EXPECT_FALSE(read_tokens("/no/such/token"));
}

TEST_F(ReadTokens, TakesLinesOfRoleNameAndToken) {
  using std::filesystem::perms;
  const std::string other = "fedcba98765432100000";
  const auto two = read("# who may do what\noperate ada " + std::string(secret) +
                            "\n\nwatch screen " + other + " # in the hall\n",
                        perms::owner_read);
  ASSERT_TRUE(two) << two.error().message;
  ASSERT_EQ(two->size(), 2U);
  EXPECT_EQ(two->front().name, "ada");
  EXPECT_EQ(two->back().role, Role::watch);
  EXPECT_EQ(two->back().token, other);
  for (const char* wrong : {"sign ada 0123456789abcdef0123", "operate 0123456789abcdef0123",
                            "operate ada b 0123456789abcdef0123"}) {
    const auto refused = read(wrong, perms::owner_read);
    ASSERT_FALSE(refused) << wrong;
    EXPECT_NE(refused.error().message.find("line 1"), std::string::npos);
  }
  EXPECT_NE(read("# nobody\n", perms::owner_read).error().message.find("no token"),
            std::string::npos);
}

} // namespace
} // namespace dyncal::inline programs::web
