// Whose messages count, by draws: the conductor's own, however many of them are lost, and nothing
// that others repeat, invent or announce.
#include "services/programs/guard/believed_conductor.hpp"

#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/services/programs/guard/played_conductor.hpp"

namespace dyncal::inline programs::guard_tests {
namespace {

using namespace std::chrono_literals;

constexpr int draws = 50;

bus::WriterId writer_of(unsigned char participant, unsigned char entity = 1) {
  bus::WriterId writer;
  writer.guid.front() = participant;
  writer.guid.back() = entity;
  return writer;
}
const bus::WriterId own = writer_of(1);
const bus::WriterId others = writer_of(2);
const bus::WriterId unknown{};

class BelievedConductorTest : public testing::Test {
protected:
  BelievedConductor::Instant now_{1h};
  BelievedConductor conductor_{{}, now_};

  template <class Message>
  bool believes(const Message& message, const bus::WriterId& writer, bool may_change = false) {
    return conductor_.believes(message, writer, may_change, now_);
  }
  void restart() { conductor_ = BelievedConductor(conductor_.conductor(), now_); }
};

TEST_F(BelievedConductorTest, TakesEveryMessageOfTheConductorOnce) {
  PlayedConductor played;
  ASSERT_TRUE(believes(played.measurement(), own, true));
  for (int i = 0; i < 1000; ++i) {
    now_ += 500ms;
    const auto excitation = played.excitation();
    EXPECT_TRUE(believes(excitation, own)) << i;
    EXPECT_FALSE(believes(excitation, own)) << "a replay of " << i;
    const auto measurement = played.measurement();
    EXPECT_TRUE(believes(measurement, own)) << i;
    EXPECT_FALSE(believes(measurement, own)) << "a replay of " << i;
  }
  EXPECT_EQ(conductor_.passed_over(), 2000U);
}

TEST_F(BelievedConductorTest, GoesOnWhateverIsLostAndHoweverTopicsOvertakeEachOther) {
  for (std::uint64_t seed = 1; seed <= draws; ++seed) {
    std::mt19937_64 random(seed);
    conductor_ = BelievedConductor({}, now_);
    PlayedConductor played;
    ASSERT_TRUE(believes(played.measurement(), own, true));
    for (int i = 0; i < 100; ++i) {
      for (std::uint64_t lost = random() % 8; lost > 0; --lost) {
        static_cast<void>(played.excitation());
        now_ += 500ms;
      }
      const auto measurement = played.measurement();
      EXPECT_TRUE(believes(played.excitation(), own)) << seed;
      EXPECT_TRUE(believes(measurement, own)) << seed;
    }
  }
}

// A link that was away for ten minutes.
TEST_F(BelievedConductorTest, GoesOnAfterALongSilence) {
  PlayedConductor played;
  ASSERT_TRUE(believes(played.measurement(), own, true));
  ASSERT_TRUE(believes(played.excitation(), own));
  for (int i = 0; i < 1200; ++i) {
    static_cast<void>(played.excitation());
  }
  now_ += 10min;
  EXPECT_TRUE(believes(played.measurement(), own)) << "which must not count for the other topic";
  EXPECT_TRUE(believes(played.excitation(), own));
}

TEST_F(BelievedConductorTest, PassesOverWhateverOthersSay) {
  for (std::uint64_t seed = 1; seed <= draws; ++seed) {
    std::mt19937_64 random(seed);
    conductor_ = BelievedConductor({}, now_);
    PlayedConductor played;
    PlayedConductor forger;
    std::vector<wire::Excitation> seen;
    ASSERT_TRUE(believes(played.measurement(), own, true));
    for (int i = 0; i < 50; ++i) {
      now_ += 500ms;
      const auto next = played.excitation();
      EXPECT_FALSE(believes(next, others)) << "a link that others have seen first";
      EXPECT_TRUE(believes(next, own)) << seed;
      seen.push_back(next);
      const auto& replayed = seen[random() % seen.size()];
      for (const bus::WriterId& writer : {own, others, unknown}) { // also with a copied GUID
        EXPECT_FALSE(believes(replayed, writer));
        EXPECT_FALSE(believes(forger.excitation(), writer));
        EXPECT_FALSE(believes(forger.measurement(), writer)) << "a new run of this name";
        wire::Excitation without_link = replayed;
        without_link.link("");
        without_link.link_number(0);
        EXPECT_FALSE(believes(without_link, writer));
      }
    }
  }
}

TEST_F(BelievedConductorTest, TellsOneThatHasEndedByItsLink) {
  PlayedConductor played;
  ASSERT_TRUE(believes(played.measurement(), own, true));
  ASSERT_TRUE(believes(played.excitation(), own));
  EXPECT_TRUE(believes(played.excitation(), unknown));
}

TEST_F(BelievedConductorTest, ChangesOnlyWhenItMay) {
  PlayedConductor played;
  PlayedConductor resumed;
  PlayedConductor next("r2");
  ASSERT_TRUE(believes(played.measurement(), own, true));
  EXPECT_FALSE(believes(resumed.measurement(), others));
  EXPECT_FALSE(believes(next.measurement(), others));
  EXPECT_FALSE(believes(next.measurement(), unknown, true)) << "nobody would be known again";
  EXPECT_TRUE(believes(resumed.measurement(), others, true));
  EXPECT_TRUE(believes(resumed.excitation(), others));
  EXPECT_FALSE(believes(played.measurement(), own));
  EXPECT_TRUE(believes(next.measurement(), own, true));
  EXPECT_EQ(conductor_.conductor().run, "r2");
}

TEST_F(BelievedConductorTest, GoesOnAfterARestartAndPassesOverWhatWasSaidBefore) {
  PlayedConductor played;
  ASSERT_TRUE(believes(played.measurement(), own, true));
  const auto first = played.excitation();
  ASSERT_TRUE(believes(first, own));
  for (int i = 0; i < 1000; ++i) {
    static_cast<void>(played.excitation());
  }
  restart();
  EXPECT_FALSE(believes(first, own));
  EXPECT_FALSE(believes(first, others));
  EXPECT_FALSE(believes(PlayedConductor().excitation(), own));
  EXPECT_TRUE(believes(played.excitation(), own)) << "any later link counts";
  EXPECT_TRUE(believes(played.measurement(), own));
}

TEST_F(BelievedConductorTest, BeginsInTheMiddleOfARun) {
  for (const bool by_measurement : {true, false}) {
    conductor_ = BelievedConductor({}, now_);
    PlayedConductor played;
    for (int i = 0; i < 2000; ++i) {
      static_cast<void>(played.excitation());
      static_cast<void>(played.measurement());
    }
    const auto before = played.excitation();
    if (by_measurement) {
      ASSERT_TRUE(believes(played.measurement(), own, true));
    } else {
      ASSERT_TRUE(believes(played.excitation(), own, true));
      ASSERT_TRUE(believes(played.measurement(), own));
    }
    EXPECT_TRUE(believes(played.excitation(), own));
    EXPECT_FALSE(believes(before, own));
  }
}

// Of contract 2.
TEST_F(BelievedConductorTest, TellsAConductorWithoutLinksByItsParticipant) {
  wire::Measurement measurement;
  measurement.run("r1");
  wire::Excitation excitation;
  excitation.run("r1");
  ASSERT_TRUE(believes(measurement, own, true));
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(believes(excitation, own));
    EXPECT_FALSE(believes(excitation, others));
    EXPECT_FALSE(believes(measurement, others));
    EXPECT_FALSE(believes(excitation, unknown));
  }
  restart();
  EXPECT_FALSE(believes(excitation, others));
  EXPECT_TRUE(believes(excitation, own));
}

TEST_F(BelievedConductorTest, SpendsNoMoreHashesThanItsLimitOnForgedLinks) {
  PlayedConductor played;
  ASSERT_TRUE(believes(played.measurement(), own, true));
  ASSERT_TRUE(believes(played.excitation(), own));
  restart();
  now_ += 24h;
  wire::Excitation forged = PlayedConductor().excitation();
  const auto before = std::chrono::steady_clock::now();
  for (std::uint64_t i = 0; i < 1'000'000; ++i) {
    forged.link_number(BelievedConductor::most_links_ever - i);
    ASSERT_FALSE(believes(forged, own));
  }
  EXPECT_LT(std::chrono::steady_clock::now() - before, 30s) << "of hours";
  now_ += 1s;
  EXPECT_TRUE(believes(played.excitation(), own)) << "as soon as the forger pauses";
}

} // namespace
} // namespace dyncal::inline programs::guard_tests
