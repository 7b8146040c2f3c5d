// The virtual interferometer behind its socket, demodulated by the drivers that demodulate real
// ones: what reaches the bus must be the motion of the table.
#include <cmath>
#include <complex>
#include <memory>
#include <optional>
#include <thread>

#include <gtest/gtest.h>

#include "analysis/interferometer/reference_motion.hpp"
#include "analysis/sine/sine_fit.hpp"
#include "drivers/acs/socket_acs.hpp"
#include "drivers/generator/scpi_generator.hpp"
#include "drivers/interferometer/interferometer_source.hpp"
#include "drivers/virtual_bench/wire/bench_server.hpp"
#include "tests/unit/drivers/collecting_sink.hpp"

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr double wavelength_m = 632.82e-9;
constexpr double amplitude_v = 0.5;
constexpr double duration_s = 4.0;

BenchSettings bench_settings() {
  BenchSettings settings;
  settings.preset = *preset_by_name("mpu9250-ptb");
  settings.seed = 3;
  settings.acs_rate_hz = 500'000;
  settings.interferometer = InterferometerSettings{.wavelength_m = wavelength_m};
  return settings;
}

// 80 Hz from the first second on.
void drive(std::uint16_t port) {
  auto connected = generator::ScpiGenerator::connect("127.0.0.1:" + std::to_string(port));
  ASSERT_TRUE(connected) << connected.error().message;
  generator::Generator& source = **connected;
  static_cast<void>(source.wait_until_s(1.0, {}));
  ASSERT_TRUE(source.set_frequency("80"));
  ASSERT_TRUE(source.set_amplitude_v(amplitude_v));
  ASSERT_TRUE(source.set_output(true));
  static_cast<void>(source.wait_until_s(duration_s, {}));
}

tests::CollectingSink play(VirtualBench& bench) {
  ServerSettings settings;
  settings.dau = {"127.0.0.1", 9};
  settings.acs_listen = {"127.0.0.1", 0};
  settings.generator_listen = {"127.0.0.1", 0};
  settings.speed = 0.0;
  settings.duration_s = duration_s;
  BenchServer server(bench, settings);
  EXPECT_TRUE(server.open());
  const StopSignal stop;
  std::jthread serving([&] { server.run(stop); });
  interferometer::InterferometerSource source(
      {.u1 = "u1",
       .u2 = "u2",
       .displacement_per_turn_m = wavelength_m / 2.0,
       .u_wavelength_rel = 5e-6,
       .output_rate_hz = 50'000.0},
      std::make_unique<acs::SocketAcs>(
          acs::SocketSettings{.address = "127.0.0.1:" + std::to_string(server.acs_port())}));
  const auto description = source.describe();
  EXPECT_TRUE(description) << description.error().message;
  tests::CollectingSink sink;
  std::jthread reading([&] { EXPECT_TRUE(source.run(sink)); });
  drive(server.generator_port());
  reading.join();
  return sink;
}

std::complex<double> fitted(const tests::CollectingSink& sink, std::size_t channel, double& u_rel) {
  const analysis::Frequency frequency = *analysis::Frequency::parse("80");
  const std::vector<double> all = sink.channel(channel);
  const std::size_t first = all.size() / 2; // settled
  const std::span<const double> values(all.data() + first, all.size() - first - 100);
  const std::span<const std::int64_t> stamps(sink.stamps_ns.data() + first, values.size());
  const auto motion =
      analysis::motion_of_step(analysis::MotionQuantity::displacement, frequency, stamps, values);
  EXPECT_TRUE(motion);
  const std::span<const double> channels[] = {motion->values};
  const auto fits = analysis::fit_sine(frequency, stamps.front(), motion->stamps_ns, channels);
  EXPECT_TRUE(fits);
  u_rel = fits->front().u_amplitude() / fits->front().amplitude();
  return std::polar(fits->front().amplitude(), fits->front().phase_rad());
}

TEST(LaserStream, BecomesTheMotionOfTheTable) {
  VirtualBench bench(bench_settings());
  const tests::CollectingSink sink = play(bench);
  ASSERT_FALSE(sink.descriptions.empty());
  const SourceDescription& described = sink.descriptions.back();
  ASSERT_EQ(described.quadrature_signals.size(), 1U);
  const QuadratureSignals& signals = described.quadrature_signals.front();
  const InterferometerTruth& truth = bench.acs().interferometer()->truth();
  EXPECT_NEAR(signals.centre_u1, truth.p_v, 1e-4);
  EXPECT_NEAR(signals.centre_u2, truth.q_v, 1e-4);
  EXPECT_NEAR(signals.radius_u1, truth.radius_v, 1e-4);
  EXPECT_NEAR(signals.radius_ratio, truth.r, 2e-4);
  EXPECT_NEAR(signals.quadrature_error_rad, truth.alpha_rad, 2e-4);
  for (const double error_rad : signals.periodic_error_rad) {
    EXPECT_LT(error_rad, 1e-3); // the model has none
  }
  EXPECT_TRUE(sink.warnings.empty()) << sink.warnings.front();
  EXPECT_EQ(described.nominal_rate_hz, 50'000.0);
  ASSERT_EQ(described.channels.size(), 2U);
  double u_sync_rel = 0.0;
  double u_rel = 0.0;
  const std::complex<double> sync = fitted(sink, 0, u_sync_rel);
  const std::complex<double> moved = fitted(sink, 1, u_rel);
  const std::complex<double> seen =
      std::polar(1.0 + bench.acs().reference_gain_error(), bench.acs().reference_phase_error_rad());
  const double w = 2.0 * 3.141592653589793 * 80.0;
  const std::complex<double> deviation = -w * w * moved / sync * VirtualBench::sync_amplitude_v /
                                         (seen * amplitude_v * bench.exciter().at(80.0));
  EXPECT_NEAR(std::abs(deviation), 1.0, 4.0 * std::hypot(u_rel, 5e-6));
  EXPECT_NEAR(std::arg(deviation), -w * truth.detector_delay_s, 4.0 * u_rel);
  EXPECT_LT(u_rel, 1e-4);
}

} // namespace
} // namespace dyncal::drivers::virtual_bench
