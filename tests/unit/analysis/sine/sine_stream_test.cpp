#include "analysis/sine/sine_stream.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/analysis/sine/sine_signal.hpp"

namespace dyncal::analysis {
namespace {

struct Record {
  std::vector<std::int64_t> stamps;
  std::vector<std::vector<double>> values;

  Record(std::size_t n, const char* frequency_hz, double noise) : stamps(uneven_stamps(n)) {
    Signal signal;
    signal.frequency_hz = frequency_hz;
    values.push_back(noisy(values_of(signal, stamps), noise, 1));
    signal.amplitude = 300.0;
    signal.phase_rad = -2.0;
    signal.offset = -77.0;
    values.push_back(noisy(values_of(signal, stamps), 300.0 * noise, 2));
  }
  [[nodiscard]] std::vector<std::span<const double>> part(std::size_t first, std::size_t n) const {
    std::vector<std::span<const double>> channels;
    for (const auto& one : values) {
      channels.emplace_back(one.data() + first, n);
    }
    return channels;
  }
};

SineStream stream_of(const Record& record, const char* frequency_hz,
                     const std::vector<std::size_t>& cuts) {
  SineStream stream(*Frequency::parse(frequency_hz), record.values.size());
  std::size_t first = 0;
  for (std::size_t i = 0; first < record.stamps.size(); ++i) {
    const std::size_t n = std::min(cuts[i % cuts.size()], record.stamps.size() - first);
    const auto pushed = stream.push({record.stamps.data() + first, n}, record.part(first, n));
    EXPECT_TRUE(pushed) << pushed.error().message;
    first += n;
  }
  return stream;
}

TEST(SineStream, GivesTheSameBitsHoweverTheSamplesAreCut) {
  const Record record(3001, "80.004", 0.05);
  const auto whole = stream_of(record, "80", {3001});
  const auto fit = whole.fit(epoch_ns);
  const auto refined = whole.fit_with_frequency(1e-3, epoch_ns);
  ASSERT_TRUE(fit && refined);
  for (const std::vector<std::size_t>& cuts :
       std::vector<std::vector<std::size_t>>{{1}, {64}, {63, 2}, {100, 1, 7}, {1000}}) {
    const auto stream = stream_of(record, "80", cuts);
    const auto again = stream.fit(epoch_ns);
    const auto again_refined = stream.fit_with_frequency(1e-3, epoch_ns);
    ASSERT_TRUE(again && again_refined);
    for (std::size_t j = 0; j < 2; ++j) {
      EXPECT_EQ((*again)[j].sine, (*fit)[j].sine);
      EXPECT_EQ((*again)[j].cosine, (*fit)[j].cosine);
      EXPECT_EQ((*again)[j].offset, (*fit)[j].offset);
      EXPECT_EQ((*again)[j].rss, (*fit)[j].rss);
      EXPECT_EQ((*again)[j].covariance, (*fit)[j].covariance);
      EXPECT_EQ(again_refined->channels[j].sine, refined->channels[j].sine);
    }
    EXPECT_EQ(again_refined->frequency.hz(), refined->frequency.hz());
    EXPECT_EQ(again_refined->u_frequency_hz, refined->u_frequency_hz);
  }
}

TEST(SineStream, DoesNotDependOnResultsTakenBetween) {
  const Record record(1000, "80", 0.05);
  SineStream stream(*Frequency::parse("80"), 2);
  for (std::size_t i = 0; i < 1000; ++i) {
    ASSERT_TRUE(stream.push({record.stamps.data() + i, 1}, record.part(i, 1)));
    if (i > 20 && i % 37 == 0) {
      ASSERT_TRUE(stream.fit(epoch_ns));
    }
  }
  EXPECT_EQ(stream.samples(), 1000U);
  EXPECT_EQ(stream.fit(epoch_ns)->front().sine,
            stream_of(record, "80", {1000}).fit(epoch_ns)->front().sine);
}

TEST(SineStream, AgreesWithTheFitOfTheWholeRecord) {
  for (const std::size_t n : {5U, 63U, 64U, 65U, 700U, 20'000U}) {
    const Record record(n, "80", 0.01);
    const auto streamed = stream_of(record, "80", {n}).fit(epoch_ns);
    const auto whole =
        fit_sine(*Frequency::parse("80"), epoch_ns, record.stamps, record.part(0, n));
    ASSERT_TRUE(streamed && whole) << n;
    for (std::size_t j = 0; j < 2; ++j) {
      const double size = (*whole)[j].amplitude();
      EXPECT_NEAR((*streamed)[j].sine, (*whole)[j].sine, 1e-13 * size) << n;
      EXPECT_NEAR((*streamed)[j].cosine, (*whole)[j].cosine, 1e-13 * size) << n;
      EXPECT_NEAR((*streamed)[j].offset, (*whole)[j].offset, 1e-13 * size) << n;
      EXPECT_NEAR((*streamed)[j].rss / (*whole)[j].rss, 1.0, 1e-10) << n;
      EXPECT_NEAR((*streamed)[j].u_phase_rad() / (*whole)[j].u_phase_rad(), 1.0, 1e-9) << n;
    }
  }
}

TEST(SineStream, RefinesTheFrequencyAsTheFitOfTheWholeRecordDoes) {
  for (const char* frequency_hz : {"80.0001", "80.02", "80.2432"}) {
    const Record record(10'000, frequency_hz, 0.05);
    const auto streamed = stream_of(record, "80", {777}).fit_with_frequency(5e-3, epoch_ns);
    const auto whole = fit_sine_and_frequency(*Frequency::parse("80"), 5e-3, epoch_ns,
                                              record.stamps, record.part(0, 10'000));
    ASSERT_TRUE(streamed) << streamed.error().message;
    ASSERT_TRUE(whole) << whole.error().message;
    EXPECT_NEAR((streamed->frequency.hz() - whole->frequency.hz()) * 2.0 * std::numbers::pi * 10.0,
                0.0, 1e-10)
        << frequency_hz;
    EXPECT_NEAR(streamed->u_frequency_hz / whole->u_frequency_hz, 1.0, 1e-9);
    for (std::size_t j = 0; j < 2; ++j) {
      EXPECT_NEAR(streamed->channels[j].amplitude() / whole->channels[j].amplitude(), 1.0, 1e-11)
          << frequency_hz;
      EXPECT_NEAR(streamed->channels[j].phase_rad(), whole->channels[j].phase_rad(), 1e-10)
          << frequency_hz;
      EXPECT_NEAR(streamed->channels[j].u_phase_rad() / whole->channels[j].u_phase_rad(), 1.0, 1e-9)
          << frequency_hz;
      EXPECT_NEAR(streamed->channels[j].rss / whole->channels[j].rss, 1.0, 1e-9) << frequency_hz;
    }
  }
}

TEST(SineStream, EndsBlocksAtGaps) {
  Record record(10'000, "80.05", 0.05);
  for (std::size_t i = 3333; i < record.stamps.size(); ++i) {
    record.stamps[i] += 11'000'000'000;
  }
  Signal signal;
  signal.frequency_hz = "80.05";
  record.values[0] = noisy(values_of(signal, record.stamps), 0.05, 3);
  record.values[1] = record.values[0];
  const auto fit = stream_of(record, "80", {500}).fit_with_frequency(1e-3, epoch_ns);
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_NEAR(fit->frequency.hz(), 80.05, 5.0 * fit->u_frequency_hz);
}

TEST(SineStream, SaysWhenTheFrequencyIsTooFarForItsSeries) {
  Signal signal;
  signal.frequency_hz = "3.5";
  const auto stamps = uneven_stamps(6400);
  const auto values = values_of(signal, stamps);
  const std::span<const double> channels[] = {values};
  SineStream stream(*Frequency::parse("2"), 1);
  ASSERT_TRUE(stream.push(stamps, channels));
  const auto fit = stream.fit_with_frequency(0.9, epoch_ns);
  ASSERT_FALSE(fit);
  EXPECT_EQ(fit.error().code, ErrorCode::not_converged);
}

TEST(SineStream, RefusesBadSamplesAndStaysAsItWas) {
  const Record record(1000, "80", 0.05);
  const auto clean = stream_of(record, "80", {1000}).fit(epoch_ns);
  SineStream stream(*Frequency::parse("80"), 2);
  ASSERT_TRUE(stream.push({record.stamps.data(), 500}, record.part(0, 500)));

  Record bad = record;
  bad.values[1][700] = std::nan("");
  EXPECT_EQ(stream.push({bad.stamps.data() + 500, 500}, bad.part(500, 500)).error().code,
            ErrorCode::not_finite);
  bad = record;
  bad.stamps[800] = bad.stamps[799];
  EXPECT_EQ(stream.push({bad.stamps.data() + 500, 500}, bad.part(500, 500)).error().code,
            ErrorCode::stamps_not_increasing);
  EXPECT_EQ(stream.push({record.stamps.data() + 499, 1}, record.part(499, 1)).error().code,
            ErrorCode::stamps_not_increasing);
  EXPECT_EQ(stream.push({record.stamps.data() + 500, 2}, record.part(500, 1)).error().code,
            ErrorCode::invalid_argument);

  ASSERT_TRUE(stream.push({record.stamps.data() + 500, 500}, record.part(500, 500)));
  EXPECT_EQ(stream.fit(epoch_ns)->front().sine, clean->front().sine);
}

TEST(SineStream, NamesWhatIsMissing) {
  SineStream stream(*Frequency::parse("80"), 1);
  EXPECT_EQ(stream.fit(epoch_ns).error().code, ErrorCode::too_few_samples);
  const auto stamps = uneven_stamps(500);
  const std::vector<double> level(500, 2.0);
  const std::span<const double> channels[] = {level};
  ASSERT_TRUE(stream.push(stamps, channels));
  EXPECT_EQ(stream.fit(epoch_ns).error().code, ErrorCode::no_excitation);
  SineStream fast(*Frequency::parse("600"), 1);
  ASSERT_TRUE(fast.push(stamps, channels));
  EXPECT_EQ(fast.fit(epoch_ns).error().code, ErrorCode::frequency_out_of_range);
}

} // namespace
} // namespace dyncal::analysis
