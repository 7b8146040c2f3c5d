#include "analysis/sine/multisine_lines.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "analysis/base/frequency.hpp"

namespace dyncal::analysis {
namespace {

const std::vector<std::string> demo_hz{"10",  "12.5", "16",  "20",   "25", "31.5",
                                       "40",  "46.7", "50",  "53.3", "63", "80",
                                       "100", "125",  "160", "200",  "250"};

std::string refusal(const std::vector<std::string>& lines_hz, double period_s = 10.0) {
  const auto checked = check_multisine_lines(lines_hz, period_s);
  return checked ? "" : checked.error().message;
}

TEST(MultisineLines, ProposesForTheDemoWhatItsOwnCheckTakes) {
  const auto lines = propose_multisine_lines(demo_hz, 10.0);
  ASSERT_TRUE(lines) << lines.error().message;
  ASSERT_EQ(lines->size(), demo_hz.size());
  EXPECT_EQ(lines->front(), "10.1");
  EXPECT_EQ(refusal(*lines), "");
  for (std::size_t i = 0; i < lines->size(); ++i) {
    const double wish = Frequency::parse(demo_hz[i])->hz();
    EXPECT_LE(std::abs(Frequency::parse((*lines)[i])->hz() - wish), 0.0301 * wish);
  }
}

// Every proposal, by arithmetic of its own: no product of second order or third harmonic on a line.
TEST(MultisineLines, ProposedLinesKeepApartWhateverIsWished) {
  std::mt19937_64 random(4711);
  for (int draw = 0; draw < 200; ++draw) {
    const double period_s = std::vector{5.0, 8.0, 10.0, 20.0}[draw % 4];
    std::vector<std::string> wishes;
    double hz = std::uniform_real_distribution(5.0, 20.0)(random);
    while (hz < 400.0) {
      wishes.push_back(std::to_string(hz));
      hz *= std::uniform_real_distribution(1.2, 1.6)(random);
      hz += 10.0 / period_s;
    }
    const auto lines = propose_multisine_lines(wishes, period_s);
    ASSERT_TRUE(lines) << lines.error().message;
    std::vector<long> k;
    for (const std::string& line : *lines) {
      const double turns = Frequency::parse(line)->hz() * period_s;
      EXPECT_NEAR(turns, std::round(turns), 1e-9) << line;
      k.push_back(std::lround(turns));
      EXPECT_EQ(k.back() % 2, 1);
      for (const double mains : {50.0, 60.0}) {
        const double hertz = turns / period_s;
        const double nearest = mains * std::max(1.0, std::round(hertz / mains));
        EXPECT_GE(std::abs(hertz - nearest), 0.004 * nearest) << line;
      }
    }
    for (const long a : k) {
      for (const long b : k) {
        EXPECT_NE(3 * a, b);
        EXPECT_TRUE(a == b || std::abs(a - b) >= 10);
      }
    }
    EXPECT_EQ(refusal(*lines, period_s), "");
  }
}

TEST(MultisineLines, RefusesByTheNamesOfWhatCollides) {
  EXPECT_NE(refusal({"10", "20", "33"}).find("2 times 10 Hz = 20 Hz"), std::string::npos);
  EXPECT_NE(refusal({"10.1", "30.3"}).find("3 times 10.1 Hz = 30.3 Hz"), std::string::npos);
  EXPECT_NE(refusal({"10.1", "13.2", "23.3"}).find("10.1 Hz + 13.2 Hz = 23.3 Hz"),
            std::string::npos);
  EXPECT_NE(refusal({"20.1", "49.9"}).find("49.9 Hz is beside the mains at 50 Hz"),
            std::string::npos);
  EXPECT_NE(refusal({"20.1", "20.9"}).find("nearer than 1 Hz"), std::string::npos);
  EXPECT_NE(refusal({"20.1", "33.25"}).find("33.25 Hz is no multiple of the 0.1 Hz"),
            std::string::npos);
  EXPECT_NE(refusal({"20.1", "33.2"}).find("33.2 Hz is an even multiple"), std::string::npos);
  EXPECT_NE(refusal({"20.1"}).find("two lines at least"), std::string::npos);
  EXPECT_NE(refusal({"20.1", "33.1"}, 3.0).find("whole number of millihertz"), std::string::npos);
}

TEST(MultisineLines, CountsWhatASentenceHasNoRoomFor) {
  EXPECT_NE(refusal(demo_hz).find(" more"), std::string::npos);
}

TEST(MultisineLines, HasNoLineWhereTheMainsLeaveNone) {
  const auto lines = propose_multisine_lines(std::vector<std::string>{"11", "50"}, 1.0);
  ASSERT_FALSE(lines);
  EXPECT_NE(lines.error().message.find("within 3 % of 50 Hz"), std::string::npos);
}

} // namespace
} // namespace dyncal::analysis
