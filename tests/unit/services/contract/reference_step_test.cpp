#include "services/contract/reference_step.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "idl/dyncal.h"

namespace dyncal::inline contract {
namespace {

const ReferenceStep step{.step = 3,
                         .repetition = 2,
                         .frequency_text_hz = "80",
                         .amplitude_m_s2 = 10.0,
                         .u_amplitude_m_s2 = 0.001,
                         .phase_rad = -2.5,
                         .u_phase_rad = 3e-4,
                         .window_begin_utc_ns = 5,
                         .window_end_utc_ns = 6,
                         .distortion_reference_rel = 0.01,
                         .distortion_sync_rel = 0.02,
                         .coverage = 2.0,
                         .origin = "t.csv: line 7 (80 Hz)"};

TEST(ReferenceStep, GoesThroughItsMessage) {
  const ReferenceStep read = from_message(to_message(step));
  EXPECT_EQ(read.step, 3U);
  EXPECT_EQ(read.repetition, 2U);
  EXPECT_EQ(read.frequency_text_hz, "80");
  EXPECT_DOUBLE_EQ(read.amplitude_m_s2, 10.0);
  EXPECT_DOUBLE_EQ(read.u_amplitude_m_s2, 0.001);
  EXPECT_DOUBLE_EQ(read.phase_rad, -2.5);
  EXPECT_DOUBLE_EQ(read.u_phase_rad, 3e-4);
  EXPECT_EQ(read.window_begin_utc_ns, 5);
  EXPECT_EQ(read.window_end_utc_ns, 6);
  EXPECT_EQ(read.distortion_sync_rel, 0.02);
  EXPECT_EQ(read.coverage, 2.0);
  EXPECT_EQ(read.origin, "t.csv: line 7 (80 Hz)");
  EXPECT_TRUE(read.problem.empty());
}

TEST(ReferenceStep, SaysWhyItHasNoValue) {
  ReferenceStep missing = step;
  missing.problem = "no row came";
  const ReferenceStep read = from_message(to_message(missing));
  EXPECT_EQ(read.step, 3U);
  EXPECT_EQ(read.problem, "no row came");
  EXPECT_TRUE(read.origin.empty());
  EXPECT_EQ(from_message(wire::AcsStep{}).problem,
            "the reference's system states no value for this step");
}

// Of a writer that gives both phasors against a clock of its own, with u of both.
TEST(ReferenceStep, IsTheRatioOfItsPhasors) {
  wire::AcsStep message;
  message.reference().cosine(2.0); // leads by a quarter of a turn
  message.reference().u_sine(0.002);
  message.reference().u_cosine(0.004);
  message.sync().sine(-3.0);
  message.sync().u_cosine(0.003);
  const ReferenceStep read = from_message(message);
  EXPECT_DOUBLE_EQ(read.amplitude_m_s2, 2.0);
  EXPECT_DOUBLE_EQ(read.u_amplitude_m_s2, 0.004);
  EXPECT_NEAR(read.phase_rad, std::acos(0.0), 1e-15);
  EXPECT_DOUBLE_EQ(read.u_phase_rad, std::hypot(0.001, 0.001));
}

} // namespace
} // namespace dyncal::inline contract
