#include "services/web/access_token.hpp"

#include <fstream>

#include <gtest/gtest.h>

#include "services/bus/memory/stepped_clock.hpp"
#include "tests/temporary_folder.hpp"

namespace dyncal::services::web {
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

TEST(AccessToken, TakesTheRightOneWithItsScheme) {
  bus::SteppedClock clock;
  AccessToken token(secret, clock);
  EXPECT_EQ(token.check(std::string("Bearer ") + secret), TokenAnswer::right);
  EXPECT_EQ(token.check(secret), TokenAnswer::wrong);
  EXPECT_EQ(token.check(""), TokenAnswer::wrong);
}

TEST(AccessToken, IsGuessedAtFiveTimesAMinute) {
  bus::SteppedClock clock;
  AccessToken token(secret, clock);
  for (std::size_t i = 0; i < AccessToken::max_wrong; ++i) {
    EXPECT_EQ(token.check("Bearer wrong"), TokenAnswer::wrong);
    clock.advance(1s);
  }
  EXPECT_EQ(token.check("Bearer wrong"), TokenAnswer::too_many);
  EXPECT_EQ(token.check(std::string("Bearer ") + secret), TokenAnswer::too_many);
  clock.advance(56s);
  EXPECT_EQ(token.check(std::string("Bearer ") + secret), TokenAnswer::right);
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
} // namespace dyncal::services::web
