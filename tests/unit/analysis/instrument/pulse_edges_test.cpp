#include "analysis/instrument/pulse_edges.hpp"

#include <random>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr std::uint64_t period = std::uint64_t{1} << 32;
constexpr std::int64_t second = 99'999'300;

// A unit's two inputs over `seconds`: GPS at the second, the reference 0.4 s later, both through a
// counter of 32 bits.
struct Recorder {
  std::vector<PulseEdge> record;
  std::uint64_t gps_number = 0;
  std::uint64_t reference_number = 0;
  std::int64_t start = 4'000'000'000;

  void gps(std::int64_t ticks) {
    record.push_back(
        {PulseInput::gps, gps_number++, static_cast<std::uint64_t>(start + ticks) % period});
  }
  void reference(std::int64_t ticks) {
    record.push_back({PulseInput::reference, reference_number++,
                      static_cast<std::uint64_t>(start + ticks) % period});
  }
  void both(std::int64_t from_s, std::int64_t to_s) {
    for (std::int64_t s = from_s; s < to_s; ++s) {
      gps(s * second);
      reference(s * second + 40'000'000);
    }
  }
};

PulseEvent only_event(const SortedPulses& sorted) {
  EXPECT_EQ(sorted.events.size(), 1U);
  return sorted.events.empty() ? PulseEvent{} : sorted.events.front();
}

TEST(PulseEdges, SecondsAreCountedAcrossWrapsOfTheCounter) {
  Recorder recorder;
  recorder.both(0, 200);
  const auto sorted = sort_pulse_edges(recorder.record);
  ASSERT_TRUE(sorted);
  EXPECT_TRUE(sorted->events.empty());
  ASSERT_EQ(sorted->sessions.size(), 1U);
  ASSERT_EQ(sorted->sessions[0].gps.size(), 200U);
  ASSERT_EQ(sorted->sessions[0].reference.size(), 200U);
  EXPECT_EQ(sorted->sessions[0].gps.back().ticks, 199 * second);
  EXPECT_EQ(sorted->sessions[0].gps.back().second, 199);
  EXPECT_EQ(sorted->sessions[0].reference.back().ticks, 199 * second + 40'000'000);
  EXPECT_DOUBLE_EQ(sorted->ticks_per_second, static_cast<double>(second));
}

TEST(PulseEdges, AnEdgeBetweenTheSecondsIsExtra) {
  Recorder recorder;
  recorder.both(0, 10);
  recorder.gps(9 * second + 71'000'000);
  recorder.both(10, 20);
  const auto sorted = sort_pulse_edges(recorder.record);
  ASSERT_TRUE(sorted);
  const PulseEvent event = only_event(*sorted);
  EXPECT_EQ(event.fault, PulseFault::extra);
  EXPECT_EQ(event.edge, 20U);
  EXPECT_EQ(sorted->sessions.size(), 1U);
  EXPECT_EQ(sorted->sessions[0].gps.size(), 20U);
}

TEST(PulseEdges, AnEdgeInPlaceOfASecondIsExtraAndTheSecondIsMissing) {
  Recorder recorder;
  recorder.both(0, 10);
  recorder.gps(9 * second + 20'000'000);
  recorder.reference(10 * second + 40'000'000);
  recorder.both(11, 20);
  const auto sorted = sort_pulse_edges(recorder.record);
  ASSERT_TRUE(sorted);
  EXPECT_EQ(sorted->count(PulseFault::extra, PulseInput::gps), 1U);
  EXPECT_EQ(sorted->count(PulseFault::missing, PulseInput::gps), 1U);
  EXPECT_EQ(sorted->count(PulseFault::missing, PulseInput::reference), 0U);
  EXPECT_EQ(sorted->sessions.size(), 1U);
  EXPECT_EQ(sorted->sessions[0].gps.back().second, 19);
}

TEST(PulseEdges, AGlitchAsFirstEdgeOfARecordIsExtra) {
  Recorder recorder;
  recorder.gps(-33'000'000);
  recorder.both(0, 10);
  const auto sorted = sort_pulse_edges(recorder.record);
  ASSERT_TRUE(sorted);
  EXPECT_EQ(only_event(*sorted).edge, 0U);
  EXPECT_EQ(sorted->sessions.size(), 1U);
}

TEST(PulseEdges, SecondsWithoutAnEdgeAreCountedAsMissing) {
  Recorder recorder;
  recorder.both(0, 10);
  for (std::int64_t s = 10; s < 31; ++s) {
    recorder.gps(s * second);
  }
  recorder.both(31, 40);
  const auto sorted = sort_pulse_edges(recorder.record);
  ASSERT_TRUE(sorted);
  EXPECT_EQ(only_event(*sorted).missing, 21U);
  EXPECT_EQ(sorted->count(PulseFault::missing, PulseInput::reference), 21U);
  EXPECT_EQ(sorted->sessions[0].reference.back().second, 39);
  EXPECT_EQ(sorted->sessions[0].reference.back().ticks, 39 * second + 40'000'000);
}

TEST(PulseEdges, ACounterThatBeginsAnewBeginsASession) {
  Recorder recorder;
  recorder.both(0, 10);
  recorder.start = 777'000'000;
  recorder.both(10, 20);
  const auto sorted = sort_pulse_edges(recorder.record);
  ASSERT_TRUE(sorted);
  EXPECT_EQ(only_event(*sorted).fault, PulseFault::session_restart);
  ASSERT_EQ(sorted->sessions.size(), 2U);
  EXPECT_EQ(sorted->sessions[1].gps.size(), 10U);
  EXPECT_EQ(sorted->sessions[1].reference.size(), 10U);
  EXPECT_EQ(sorted->sessions[1].reference[0].ticks, 40'000'000);
}

TEST(PulseEdges, ARunningNumberThatGoesBackBeginsASessionEvenWhenTheCounterSeemsToGoOn) {
  Recorder recorder;
  recorder.both(0, 10);
  recorder.gps_number = recorder.reference_number = 0;
  recorder.both(10, 20);
  const auto sorted = sort_pulse_edges(recorder.record);
  ASSERT_TRUE(sorted);
  EXPECT_EQ(only_event(*sorted).fault, PulseFault::session_restart);
  EXPECT_EQ(sorted->sessions.size(), 2U);
}

TEST(PulseEdges, PulsesThatMoveWhileTheOtherInputGoesOnAreNoRestart) {
  Recorder recorder;
  recorder.both(0, 10);
  for (std::int64_t s = 10; s < 20; ++s) {
    recorder.gps(s * second + 5'000'000);
    recorder.reference(s * second + 40'000'000);
  }
  const auto sorted = sort_pulse_edges(recorder.record);
  ASSERT_TRUE(sorted);
  EXPECT_EQ(only_event(*sorted).fault, PulseFault::pulse_step);
  ASSERT_EQ(sorted->sessions.size(), 1U);
  EXPECT_EQ(sorted->sessions[0].gps.back().second, 19);
}

TEST(PulseEdges, ARepeatedLineIsADuplicate) {
  Recorder recorder;
  recorder.both(0, 10);
  recorder.record.push_back(recorder.record[recorder.record.size() - 2]);
  recorder.both(10, 12);
  const auto sorted = sort_pulse_edges(recorder.record);
  ASSERT_TRUE(sorted);
  EXPECT_EQ(only_event(*sorted).fault, PulseFault::duplicate);
  EXPECT_EQ(sorted->sessions[0].gps.size(), 12U);
}

TEST(PulseEdges, ACounterOfSixtyFourBitsDoesNotWrap) {
  std::vector<PulseEdge> record;
  for (std::uint64_t n = 0; n < 50; ++n) {
    if (n < 10 || n > 20) {
      record.push_back({PulseInput::gps, n, period * 7 + n * 1'000'000'000});
    }
  }
  const auto sorted = sort_pulse_edges(record);
  ASSERT_TRUE(sorted);
  EXPECT_EQ(only_event(*sorted).missing, 11U);
}

TEST(PulseEdges, ARecordWithoutSecondsIsRefused) {
  std::mt19937_64 random(5);
  std::vector<PulseEdge> record;
  for (std::uint64_t n = 0; n < 40; ++n) {
    record.push_back({PulseInput::gps, n, random() % period});
  }
  const auto sorted = sort_pulse_edges(record);
  ASSERT_FALSE(sorted);
  EXPECT_EQ(sorted.error().code, ErrorCode::too_few_samples);
  EXPECT_FALSE(sort_pulse_edges({}));
  EXPECT_FALSE(sort_pulse_edges(record, {.tolerance_s = 0.0}));
}

TEST(PulseEdges, RandomFaultsNeverMakeAWrongSecond) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  for (int round = 0; round < 50; ++round) {
    Recorder recorder;
    std::vector<std::int64_t> truth; // ticks of the GPS seconds recorded
    for (std::int64_t s = 0; s < 300; ++s) {
      if (part(random) > 0.03) {
        truth.push_back(s * second);
        recorder.gps(s * second);
      }
      if (part(random) < 0.02) {
        recorder.gps(s * second + 1'000'000 + static_cast<std::int64_t>(part(random) * 38e6));
      }
      recorder.reference(s * second + 40'000'000);
    }
    const auto sorted = sort_pulse_edges(recorder.record);
    ASSERT_TRUE(sorted);
    ASSERT_EQ(sorted->sessions.size(), 1U);
    ASSERT_EQ(sorted->sessions[0].reference.size(), 300U);
    std::int64_t first = truth.front();
    ASSERT_EQ(sorted->sessions[0].gps.size(), truth.size());
    for (std::size_t i = 0; i < truth.size(); ++i) {
      EXPECT_EQ(sorted->sessions[0].gps[i].second, (truth[i] - first) / second);
    }
  }
}

} // namespace
} // namespace dyncal::analysis
