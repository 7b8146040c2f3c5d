#include "services/contract/source_description.hpp"

#include <set>

#include <gtest/gtest.h>

#include "idl/dyncal.h"

namespace dyncal::inline contract {
namespace {

drivers::SourceDescription instrument(const std::string& device, const std::string& serial) {
  drivers::SourceDescription description;
  description.device = device;
  description.serial = serial;
  return description;
}

TEST(SourceDescription, NamesBothInstrumentsWhereTheyAreNotTheSame) {
  const auto first = instrument("MPU-9250", "0xbccb0100");
  EXPECT_EQ(device_difference("dau", first, instrument("MPU-9250", "0xbccb0200")),
            "source 'dau' is another instrument than the run began with: now MPU-9250, serial "
            "number 0xbccb0200, then MPU-9250, serial number 0xbccb0100; put that one back, or "
            "begin a new run");
  EXPECT_NE(device_difference("dau", first, instrument("BMA280", "0xbccb0100")), "");
  EXPECT_NE(device_difference("dau", first, instrument("MPU-9250", "\x1b[2J\n")).find("?[2J?"),
            std::string::npos); // what it says of itself steers no terminal
}

TEST(SourceDescription, TakesWhatIsNotKnownForNoDifference) {
  const auto first = instrument("MPU-9250", "0xbccb0100");
  EXPECT_EQ(device_difference("dau", first, first), "");
  EXPECT_EQ(device_difference("dau", first, instrument("", "0xbccb0100")), "");
  EXPECT_EQ(device_difference("dau", first, instrument("MPU-9250", "")), "");
  EXPECT_EQ(device_difference("dau", instrument("", ""), first), "");
  auto renewed = first;
  renewed.firmware = "2";
  renewed.nominal_rate_hz = 1000.0;
  EXPECT_EQ(device_difference("dau", first, renewed), "");
}

TEST(SourceDescription, ComesBackFromItsMessageAsItWasSent) {
  drivers::SourceDescription sent = instrument("MPU-9250", "0xbccb0100");
  sent.firmware = "2.1";
  sent.driver = "smartup";
  sent.channels = {{"acceleration_x", "Acceleration", "unit 1", -10.0, 20.0, 0.5},
                   {"temperature", "Temperature", "unit 2", -40.0, 85.0, 0.25}};
  sent.nominal_rate_hz = 1000.0;
  sent.tick_s = 1e-8;
  sent.stamp_uncertainty_s = 2e-7;
  sent.quadrature_signals = {{.channel = "temperature",
                              .displacement_per_turn_m = -316e-9,
                              .u_wavelength_rel = 2e-6,
                              .centre_u1 = 0.02,
                              .centre_u2 = -0.01,
                              .radius_u1 = 0.6,
                              .radius_ratio = 1.05,
                              .quadrature_error_rad = 0.09,
                              .turns_covered = 17.5,
                              .ellipse_from = "a test",
                              .u_ellipse_rad = {1e-3, 2e-3},
                              .periodic_error_rad = {0.0, 0.1, 0.2, 0.3},
                              .detector_bandwidth_hz = 1e6,
                              .u_skew_s = 1e-9,
                              .radius_deviation_rel = {1e-4, -1e-4}}};
  std::set<wire::StampInstant> instants;
  for (int i = 0; i <= static_cast<int>(drivers::StampInstant::frame_end); ++i) {
    sent.stamp_instant = static_cast<drivers::StampInstant>(i);
    sent.time_base = i % 2 == 0 ? drivers::TimeBase::utc : drivers::TimeBase::local;
    const wire::SourceDescription message = to_message(sent);
    EXPECT_TRUE(instants.insert(message.stamp_instant()).second) << i;
    const drivers::SourceDescription read = from_message(message);
    EXPECT_EQ(read.stamp_instant, sent.stamp_instant);
    EXPECT_EQ(read.time_base, sent.time_base);
    EXPECT_EQ(read.quadrature_signals, sent.quadrature_signals);
    EXPECT_EQ(read.device, "MPU-9250");
    EXPECT_EQ(read.serial, "0xbccb0100");
    EXPECT_EQ(read.firmware, "2.1");
    EXPECT_EQ(read.driver, "smartup");
    EXPECT_EQ(read.nominal_rate_hz, 1000.0);
    EXPECT_EQ(read.tick_s, 1e-8);
    EXPECT_EQ(read.stamp_uncertainty_s, 2e-7);
    ASSERT_EQ(read.channels.size(), 2U);
    EXPECT_EQ(read.channels[0].name, "acceleration_x");
    EXPECT_EQ(read.channels[1].quantity, "Temperature");
    EXPECT_EQ(read.channels[1].unit, "unit 2");
    EXPECT_EQ(read.channels[0].minimum, -10.0);
    EXPECT_EQ(read.channels[0].maximum, 20.0);
    EXPECT_EQ(read.channels[1].resolution, 0.25);
  }
}

} // namespace
} // namespace dyncal::inline contract
