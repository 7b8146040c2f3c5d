// A sensor on a shared bus, simulated bit for bit in time, through SensorStream and the evaluation
// by absolute time, against the truth.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "analysis/method/analogue_comparison.hpp"
#include "drivers/can/sensor_stream.hpp"
#include "drivers/can/time/frame_duration.hpp"

namespace dyncal::drivers::can {
namespace {

constexpr std::int64_t epoch_ns = 1'700'000'000'000'000'000;
constexpr double duration_s = 6.0;

struct Bus {
  const char* name;
  BitRates rates;
  bool fd;
};

// What the sensor does: y = magnitude * a(t - delay), sampled, quantised to 0.001 m/s^2, put on the
// bus at once.
struct Truth {
  double magnitude = 0.97;
  double delay_s = 1.25e-3;
  double rate_hz = 1000.0 * (1.0 + 80e-6); // its own clock
  double minimum_latency_s = 8e-6;         // from the end of a frame to the kernel's stamp
};

class Simulation {
public:
  Simulation(const Bus& bus, const Truth& truth, double frequency_hz)
      : bus_(bus), truth_(truth), omega_(2 * std::numbers::pi * frequency_hz) {}

  [[nodiscard]] double excitation(double t_s) const { return 10.0 * std::sin(omega_ * t_s); }

  [[nodiscard]] CanFrame next_frame() {
    const double sampled_s = static_cast<double>(k_) / truth_.rate_hz;
    const double value = truth_.magnitude * excitation(sampled_s - truth_.delay_s) +
                         std::normal_distribution<>(0.0, 0.01)(random_);
    CanFrame frame;
    frame.id = 0x100;
    frame.fd = frame.bit_rate_switch = bus_.fd;
    frame.length = bus_.fd ? 24 : 8;
    const auto raw = static_cast<std::int16_t>(std::lround(value / 0.001));
    frame.data[0] = static_cast<std::uint8_t>(raw);
    frame.data[1] = static_cast<std::uint8_t>(raw >> 8);
    frame.data[2] = static_cast<std::uint8_t>(k_);
    frame.data[3] = static_cast<std::uint8_t>(k_ >> 8);
    // Frames of others take a quarter of the bus: the sensor's frame waits until the one that is
    // being sent has ended.
    const double foreign_s = max_frame_s(bus_.fd, bus_.fd, bus_.fd ? 64 : 8, bus_.rates);
    const bool occupied = std::bernoulli_distribution(0.25)(random_);
    const double start_s =
        sampled_s + (occupied ? std::uniform_real_distribution<>(0.0, foreign_s)(random_) : 0.0);
    const double latency_s =
        truth_.minimum_latency_s + std::exponential_distribution<>(1.0 / 15e-6)(random_);
    frame.kernel_ns =
        epoch_ns + std::llround((start_s + frame_duration_s(frame, bus_.rates) + latency_s) * 1e9);
    ++k_;
    return frame;
  }

private:
  Bus bus_;
  Truth truth_;
  double omega_;
  std::mt19937 random_{11};
  int k_ = 0;
};

struct Samples : SampleSink {
  SourceDescription description;
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> values;

  void describe(const SourceDescription& now) override { description = now; }
  void begin_session() override { ADD_FAILURE() << "the sensor did not restart"; }
  void count(const SampleCounts&) override {}
  void warn(const std::string&) override {}
  void take(SampleBlock block) override {
    stamps_ns.insert(stamps_ns.end(), block.stamps_ns.begin(), block.stamps_ns.end());
    values.insert(values.end(), block.values.begin(), block.values.end());
  }
};

struct Outcome {
  double magnitude_error_in_u;
  double phase_error_in_u;
  double phase_error_rad;
};

Outcome calibrate(const Bus& bus, const std::string& frequency_hz, bool correct_frame_duration) {
  const Truth truth;
  const auto frequency = *analysis::Frequency::parse(frequency_hz);
  Simulation simulation(bus, truth, frequency.hz());

  StreamSettings settings;
  settings.counter = "counter";
  settings.nominal_rate_hz = 1000.0;
  settings.bit_rates = bus.rates;
  settings.correct_frame_duration = correct_frame_duration;
  settings.latency_s = truth.minimum_latency_s;
  settings.u_latency_s = 2e-6;
  settings.u_utc_s = 0.2e-6;
  auto stream = *SensorStream::create(
      settings, *parse_dbc("BO_ 256 Sample: 64 S\n SG_ x : 0|16@1- (0.001,0) [0|0] \"m/s^2\" S\n"
                           " SG_ counter : 16|16@1+ (1,0) [0|0] \"\" S\n",
                           "sensor.dbc"));
  LinkState link;
  link.name = "can0";
  link.present = link.up = true;
  Samples samples;
  EXPECT_TRUE(stream->begin(link, samples));
  for (int k = 0; k < static_cast<int>(duration_s * truth.rate_hz); ++k) {
    EXPECT_TRUE(stream->take(simulation.next_frame(), samples));
  }
  stream->finish(samples);

  std::vector<std::int64_t> reference_stamps_ns;
  std::vector<double> reference;
  std::mt19937 random(5);
  for (int i = 0; i < static_cast<int>(duration_s * 10e3); ++i) {
    reference_stamps_ns.push_back(epoch_ns + i * 100'000LL);
    reference.push_back(simulation.excitation(i * 1e-4) +
                        std::normal_distribution<>(0.0, 0.01)(random));
  }
  analysis::AbsoluteTimeInput input{.frequency = frequency};
  input.reference_stamps_ns = reference_stamps_ns;
  input.reference = {"reference", reference, 0.0};
  input.dut_stamps_ns = samples.stamps_ns;
  input.dut = {{"x", samples.values, samples.description.channels.at(0).resolution}};
  input.systematic.clock_offset_s = samples.description.stamp_uncertainty_s;
  const auto result = analysis::evaluate_absolute_time(input);
  if (!result) {
    ADD_FAILURE() << result.error().message;
    return {};
  }
  const analysis::TransferPoint& point = result->points.at(0);
  const double phase_error =
      std::remainder(point.phase_rad + 2 * std::numbers::pi * frequency.hz() * truth.delay_s,
                     2 * std::numbers::pi);
  return {(point.magnitude - truth.magnitude) / point.u_magnitude, phase_error / point.u_phase_rad,
          phase_error};
}

const Bus buses[] = {{"500 kbit/s", {500e3, 0.0}, false},
                     {"1 Mbit/s", {1e6, 0.0}, false},
                     {"5 Mbit/s FD", {1e6, 5e6}, true}};

TEST(CanCalibrationChain, MeetsTheTruthWithin4uOnEveryBusWithForeignTraffic) {
  for (const Bus& bus : buses) {
    for (const char* frequency_hz : {"10", "80", "103.7"}) {
      SCOPED_TRACE(std::string(bus.name) + ", " + frequency_hz + " Hz");
      const Outcome outcome = calibrate(bus, frequency_hz, true);
      EXPECT_LT(std::abs(outcome.magnitude_error_in_u), 4.0);
      EXPECT_LT(std::abs(outcome.phase_error_in_u), 4.0);
      std::printf("%s %s Hz: magnitude %+.2f u, phase %+.2f u (%+.1f urad)\n", bus.name,
                  frequency_hz, outcome.magnitude_error_in_u, outcome.phase_error_in_u,
                  outcome.phase_error_rad * 1e6);
    }
  }
}

TEST(CanCalibrationChain, IsWrongByTheFrameDurationWithoutItsCorrection) {
  // Frames of eight bytes last 108 ... 121 us at 1 Mbit/s: some 73 mrad at 103.7 Hz, 7 mrad at 10
  // Hz. Stamps that are late make the sensor seem to lag by as much.
  const double at_104 = calibrate(buses[1], "103.7", false).phase_error_rad;
  const double at_10 = calibrate(buses[1], "10", false).phase_error_rad;
  EXPECT_NEAR(std::abs(at_104), 74e-3, 5e-3);
  EXPECT_NEAR(std::abs(at_10), 7.1e-3, 0.5e-3);
  std::printf("uncorrected at 1 Mbit/s: %+.2f mrad at 103.7 Hz, %+.3f mrad at 10 Hz\n",
              at_104 * 1e3, at_10 * 1e3);
}

} // namespace
} // namespace dyncal::drivers::can
