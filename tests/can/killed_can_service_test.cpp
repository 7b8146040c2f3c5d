// dyncal-can is killed at a drawn instant of a run and started again, as systemd does: the run ends
// with every value, valid, without loss and without flag. DYNCAL_KILLS: how often (1); DYNCAL_SEED
// draws others.
#include <cstdlib>
#include <random>
#include <string>

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "tests/can/can_calibration.hpp"

namespace dyncal::tests {
namespace {

constexpr double run_s = 15.0; // about what an undisturbed run takes
constexpr double longest_away_s = 8.0;
constexpr double limit_in_u = 4.0;

unsigned number_of(const char* variable, unsigned otherwise) {
  const char* text = std::getenv(variable);
  return text == nullptr ? otherwise : static_cast<unsigned>(std::stoul(text));
}

void expect_a_whole_run(const SourceKill& kill) {
  CanCalibration calibration("killed_can_service", calibrated_buses().front());
  calibration.add_source("can", "vcan0",
                         "bit_rate_per_s = 500000\nlatency_s = 10e-6\nu_latency_s = 20e-6\n");
  const auto points =
      calibration.run({"can/acceleration_x", "can/acceleration_y", "can/acceleration_z"}, kill);
  if (points && !testing::Test::HasFailure()) {
    calibration.expect_whole(3);
    calibration.expect_truth(*points, "can", limit_in_u);
  }
}

TEST(KilledCanService, IsStartedAgainAndTheRunIsWhole) {
  const unsigned kills = number_of("DYNCAL_KILLS", 1);
  std::mt19937 random(number_of("DYNCAL_SEED", 12));
  std::uniform_real_distribution<double> after_s(0.0, run_s);
  std::uniform_real_distribution<double> away_s(0.1, longest_away_s);
  for (unsigned i = 0; i < kills && !HasFailure(); ++i) {
    const SourceKill kill{std::chrono::duration<double>(after_s(random)),
                          std::chrono::duration<double>(away_s(random))};
    SCOPED_TRACE(fmt::format("kill {}, {:.2f} s after the start, away {:.2f} s", i,
                             kill.after.count(), kill.away.count()));
    expect_a_whole_run(kill);
  }
}

} // namespace
} // namespace dyncal::tests
