#include "drivers/interferometer/signal_complaints.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/drivers/collecting_sink.hpp"
#include "tests/unit/drivers/interferometer/simulated_device.hpp"

namespace dyncal::tests {
namespace {

using drivers::interferometer::InterferometerSettings;
using drivers::interferometer::QuadratureDemodulator;
using drivers::interferometer::SignalComplaints;
using drivers::interferometer::StatedEllipse;
using testing::HasSubstr;

struct Course {
  DeviceSettings device;
  InterferometerSettings settings{.u1 = "u1", .u2 = "u2"};
  CollectingSink sink{};

  Course() {
    device.rate_hz = 100e3;
    device.seconds = 2.0;
    settings.ellipse = StatedEllipse{.ellipse = device.ellipse, .from = "a test"};
  }

  // In blocks of 10 ms; `fault` changes the pairs.
  template <class Fault>
  void run(Fault fault) {
    drivers::SampleBlock record = record_of(device);
    for (std::size_t i = 0; i < record.samples; ++i) {
      fault(static_cast<double>(i) / device.rate_hz, record.values[i],
            record.values[record.samples + i]);
    }
    QuadratureDemodulator demodulator(settings, {}, device.rate_hz);
    SignalComplaints complaints("u1 and u2", device.rate_hz);
    const std::vector<double> u1 = column_of(record, 0);
    const std::vector<double> u2 = column_of(record, 1);
    std::vector<double> turns;
    for (std::size_t at = 0; at + 1000 <= u1.size(); at += 1000) {
      demodulator.push(std::span(u1).subspan(at, 1000), std::span(u2).subspan(at, 1000), turns);
      complaints.look(demodulator, 1000, sink);
    }
  }
};

TEST(SignalComplaints, AreNoneOfSoundSignals) {
  Course course;
  course.run([](double, double&, double&) {});
  EXPECT_TRUE(course.sink.warnings.empty()) << course.sink.warnings.front();
}

TEST(SignalComplaints, NameARadiusThatFalls) {
  Course course;
  const auto& e = course.device.ellipse;
  course.run([&](double t, double& u1, double& u2) {
    const double part = 1.0 - 0.3 * std::pow(std::sin(30.0 * t), 2);
    u1 = e.p + part * (u1 - e.p);
    u2 = e.q + part * (u2 - e.q);
  });
  ASSERT_EQ(course.sink.warnings.size(), 1U);
  EXPECT_THAT(course.sink.warnings.front(), HasSubstr("detectors too slow"));
}

TEST(SignalComplaints, NameAnEllipseOfAnotherAdjustment) {
  Course course;
  course.settings.ellipse->ellipse.radius *= 1.5;
  course.run([](double, double&, double&) {});
  ASSERT_EQ(course.sink.warnings.size(), 1U);
  EXPECT_THAT(course.sink.warnings.front(), HasSubstr("0.67 of that of their ellipse"));
}

TEST(SignalComplaints, AreSaidOnceAsLongAsTheyLast) {
  Course course;
  course.device.seconds = 30.0;
  course.device.rate_hz = 50e3;
  const auto& e = course.device.ellipse;
  course.run([&](double t, double& u1, double& u2) {
    if (t < 5.0 || t > 25.0) {
      u1 = e.p;
      u2 = e.q;
    }
  });
  ASSERT_EQ(course.sink.warnings.size(), 2U);
  EXPECT_THAT(course.sink.warnings.front(), HasSubstr("beam"));
}

} // namespace
} // namespace dyncal::tests
