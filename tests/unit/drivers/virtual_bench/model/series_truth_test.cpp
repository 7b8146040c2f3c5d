// Series time stamping against the truth of the virtual bench: models of ACS, oscilloscope and time
// series sensor, without sockets.
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/instrument/trigger_delay.hpp"
#include "analysis/method/series_stamping.hpp"
#include "analysis/method/start_latency.hpp"
#include "drivers/virtual_bench/model/acs_instrument.hpp"
#include "drivers/virtual_bench/model/oscilloscope_model.hpp"
#include "drivers/virtual_bench/model/series_sensor.hpp"

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;
constexpr double reference_magnitude_rel = 1e-3;
constexpr double reference_phase_rad = 1.7e-3;

class BenchOfModels {
public:
  explicit BenchOfModels(const char* frequency_text, bool free_running = false)
      : frequency_(*analysis::Frequency::parse(frequency_text)), excitation_(ExciterModel{}),
        acs_(acs_settings()), scope_(TriggerSettings{}), sensor_(sensor_settings(free_running)) {
    excitation_.change(0.0, {frequency_.hz(), 0.4, true, false});
    scope_.setting.inputs = {ScopeInput{5.0, 0.0, true}, ScopeInput{1.0, -1.5, true}};
    scope_.setting.seconds_per_division = 0.2 / frequency_.hz();
    scope_.setting.points = 10'000;
    advance_to(0.5);
    acs_samples_ = {}; // settled
  }

  void take_shots(std::size_t shots) {
    while (series_.size() < shots) {
      scope_.single();
      series_pending_ = true;
      while (series_pending_ || scope_.state() != OscilloscopeModel::State::stopped) {
        advance_to(now_s_ + 0.01);
      }
      traces_.push_back(volts(*scope_.record()));
    }
  }

  // `corrected` false: as if every trigger came at the zero crossing.
  analysis::SeriesStampingResult evaluate(bool corrected, double start_latency_s = 0.0,
                                          double start_scatter_s = 0.0) {
    std::vector<std::int64_t> stamps;
    std::vector<double> reference;
    std::vector<double> sync;
    const std::size_t count = std::min<std::size_t>(acs_samples_.samples(), 60'000);
    for (std::size_t i = 0; i < count; ++i) {
      stamps.push_back(acs_.stamp_ns(acs_samples_.first_sample + i));
      reference.push_back(acs_samples_.counts[2 * i] * acs_.reference_scale());
      sync.push_back(acs_samples_.counts[2 * i + 1] * acs_.sync_scale());
    }
    const double first_s = scope_.setting.origin_s();
    const double interval_s = scope_.setting.interval_s();
    analysis::SeriesStampingInput input{.frequency = frequency_,
                                        .acs_stamps_ns = stamps,
                                        .reference = {"reference", reference, 0.0},
                                        .sync_acs = {"sync", sync, 0.0},
                                        .channels = {"acceleration_z"},
                                        .nominal_rate_hz = sensor_.settings().nominal_rate_hz,
                                        .shots = {},
                                        .dso_delay_s = 236e-9,
                                        .u_dso_delay_s = 1e-9,
                                        .start_latency_s = start_latency_s,
                                        .start_scatter_s = start_scatter_s,
                                        .reference_magnitude_rel = reference_magnitude_rel,
                                        .reference_phase_rad = reference_phase_rad,
                                        .correct_trigger_phase = corrected};
    for (std::size_t j = 0; j < series_.size(); ++j) {
      input.shots.push_back({first_s, interval_s, traces_[j], {series_[j]}});
    }
    auto result = analysis::evaluate_series_stamping(input);
    EXPECT_TRUE(result.has_value()) << result.error().message;
    return result.value();
  }

  [[nodiscard]] std::complex<double> truth() const {
    return sensor_.settings().response.at(frequency_.hz());
  }
  [[nodiscard]] double real_rate_hz() const { return sensor_.real_rate_hz(); }
  [[nodiscard]] double angular_hz() const { return two_pi * frequency_.hz(); }

private:
  static AcsSettings acs_settings() {
    AcsSettings settings;
    settings.origin_ns = 123'456'789;
    settings.reference_magnitude_rel = reference_magnitude_rel;
    settings.reference_phase_rad = reference_phase_rad;
    return settings;
  }
  static SeriesSensorSettings sensor_settings(bool free_running) {
    SeriesSensorSettings settings = series_sensor_of(*preset_by_name("tss"), 1, 157.0);
    settings.start.free_running = free_running;
    return settings;
  }
  static std::vector<double> volts(const OscilloscopeModel::Record& record) {
    std::vector<double> result;
    for (const char code : record.codes[0]) {
      result.push_back((static_cast<double>(static_cast<unsigned char>(code)) - 128.0) * 0.2);
    }
    return result;
  }
  void advance_to(double time_s) {
    acs_.sample_until(time_s, excitation_, acs_samples_);
    if (const auto event = scope_.advance_to(time_s, excitation_)) {
      sensor_.trigger(event->output_edge_s);
    }
    if (const auto recorded = sensor_.advance_to(time_s, excitation_)) {
      std::vector<double> values;
      for (const std::int16_t count : recorded->counts) {
        values.push_back(count * sensor_.settings().step_m_s2);
      }
      series_.push_back(std::move(values));
      series_pending_ = false;
    }
    now_s_ = time_s;
  }

  analysis::Frequency frequency_;
  Excitation excitation_;
  AcsInstrument acs_;
  OscilloscopeModel scope_;
  SeriesSensor sensor_;
  AcsSamples acs_samples_;
  std::vector<std::vector<double>> traces_;
  std::vector<std::vector<double>> series_;
  bool series_pending_ = false;
  double now_s_ = 0.0;
};

class SeriesTruthTest : public testing::TestWithParam<const char*> {};

TEST_P(SeriesTruthTest, MagnitudePhaseAndRateMeetTheTruthWithinFourStandardUncertainties) {
  BenchOfModels bench(GetParam());
  bench.take_shots(5);
  const auto result = bench.evaluate(true);
  const analysis::RepetitionMean& mean = result.channels.at(0).mean;
  EXPECT_LT(std::abs(mean.magnitude - std::abs(bench.truth())), 4.0 * mean.u_magnitude);
  EXPECT_LT(std::abs(std::remainder(mean.phase_rad - std::arg(bench.truth()), two_pi)),
            4.0 * mean.u_phase_rad);
  EXPECT_LT(std::abs(result.rate.real_rate_hz - bench.real_rate_hz()),
            4.0 * result.rate.u_real_rate_hz);
  EXPECT_LT(mean.u_phase_rad, 4e-3);
}

TEST_P(SeriesTruthTest, WithoutTheCorrectionOfEveryShotThePhaseIsWrongByMoreThanTenMilliradians) {
  BenchOfModels bench(GetParam());
  bench.take_shots(5);
  const double phase_rad = bench.evaluate(false).channels.at(0).mean.phase_rad;
  EXPECT_GT(std::abs(std::remainder(phase_rad - std::arg(bench.truth()), two_pi)), 0.010);
}

INSTANTIATE_TEST_SUITE_P(Frequencies, SeriesTruthTest, testing::Values("10", "40", "80", "200"),
                         [](const auto& frequency) { return std::string(frequency.param) + "Hz"; });

TEST(SeriesStart, IsFoundToBeFixedOrUniform) {
  for (const bool free_running : {false, true}) {
    BenchOfModels bench("80", free_running);
    bench.take_shots(8);
    const auto result = bench.evaluate(true);
    std::vector<double> offsets_s;
    double u_s = 0.0;
    for (const analysis::Repetition& shot : result.channels.at(0).shots) {
      offsets_s.push_back(std::arg(shot.h / result.channels.at(0).mean.h) / bench.angular_hz());
      u_s = shot.u_random_phase_rad / bench.angular_hz();
    }
    const auto start =
        analysis::judge_start_latency(offsets_s, u_s, 1.0 / result.rate.real_rate_hz);
    EXPECT_EQ(start.kind, free_running ? analysis::StartKind::uniform : analysis::StartKind::fixed)
        << start.scatter_s << " s, u " << u_s;
  }
}

TEST(SeriesStart, HalfASampleIsCorrectedForASensorThatRunsFree) {
  BenchOfModels bench("80", true);
  bench.take_shots(16);
  const double sample_s = 1.0 / bench.real_rate_hz();
  const auto mean =
      bench.evaluate(true, 0.5 * sample_s, sample_s / std::sqrt(12.0)).channels.at(0).mean;
  EXPECT_LT(std::abs(std::remainder(mean.phase_rad - std::arg(bench.truth()), two_pi)),
            4.0 * mean.u_phase_rad);
  EXPECT_GT(mean.u_phase_rad, 0.02); // 16 shots of a uniform start
}

// One trace of both inputs with the delays of the model.
std::vector<analysis::ShotDelay> delays(OscilloscopeModel& scope, Excitation& excitation,
                                        double frequency_hz, bool rectangle, int shots) {
  excitation.change(0.0, {frequency_hz, 0.05, true, rectangle});
  scope.setting.inputs = {ScopeInput{5.0, 0.0, true}, ScopeInput{1.0, -1.5, true}};
  scope.setting.seconds_per_division = rectangle ? 100e-9 : 0.1 / frequency_hz;
  scope.setting.centre_s = rectangle ? 0.2e-6 : 0.0;
  scope.setting.points = rectangle ? 1000 : 1'000'000;
  std::vector<analysis::ShotDelay> found;
  double now_s = 0.1;
  static_cast<void>(scope.advance_to(now_s, excitation));
  for (int shot = 0; shot < shots; ++shot) {
    scope.single();
    while (scope.state() != OscilloscopeModel::State::stopped) {
      now_s += 0.0013;
      static_cast<void>(scope.advance_to(now_s, excitation));
    }
    std::array<std::vector<double>, 2> volts;
    for (std::size_t input = 0; input < 2; ++input) {
      for (const char code : scope.record()->codes[input]) {
        volts[input].push_back((static_cast<double>(static_cast<unsigned char>(code)) - 128.0) /
                                   25.0 * scope.setting.inputs[input].volts_per_division -
                               scope.setting.inputs[input].offset_v);
      }
    }
    const analysis::DelayTrace trace{scope.setting.origin_s(), scope.setting.interval_s(), volts[0],
                                     volts[1]};
    const auto delay =
        rectangle ? analysis::delay_by_rectangle(trace)
                  : analysis::delay_by_sine(trace, analysis::Frequency::from_hz(frequency_hz));
    EXPECT_TRUE(delay.has_value()) << delay.error().message;
    found.push_back(delay.value_or(analysis::ShotDelay{}));
  }
  return found;
}

TEST(TriggerDelayOfTheModel, IsFoundWithinANanosecondByTheRectangle) {
  OscilloscopeModel scope{TriggerSettings{}};
  Excitation excitation{ExciterModel{}};
  const auto mean = analysis::mean_trigger_delay(delays(scope, excitation, 1000.0, true, 50), 1e-9);
  ASSERT_TRUE(mean.has_value());
  EXPECT_LE(mean->of_delay.u, 1e-9);
  EXPECT_LT(std::abs(mean->delay_s - scope.output_delay_s()), 1e-9) << mean->delay_s;
}

TEST(TriggerDelayOfTheModel, IsFoundWithinANanosecondByTheSine) {
  OscilloscopeModel scope{TriggerSettings{}};
  Excitation excitation{ExciterModel{}};
  const auto shots = delays(scope, excitation, 5000.0, false, 10);
  const auto mean = analysis::mean_trigger_delay(shots, scope.setting.interval_s());
  ASSERT_TRUE(mean.has_value());
  EXPECT_LE(mean->of_delay.u, 1e-9);
  EXPECT_LT(std::abs(mean->delay_s - scope.output_delay_s()), 1e-9) << mean->delay_s;
  EXPECT_GT(mean->scatter_from_zero_crossing_s,
            50.0 * mean->scatter_s); // noise of the trigger is in the one, not in the other
}

} // namespace
} // namespace dyncal::drivers::virtual_bench
