#include "drivers/tables/table_phasor.hpp"

#include <numbers>

#include <gtest/gtest.h>

namespace dyncal::drivers::tables {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

const ReferenceTableRow row{.line = 7,
                            .loop = 0,
                            .frequency_hz = 80.0,
                            .amplitude_m_s2 = 10.0,
                            .amplitude_deviation_m_s2 = 0.002,
                            .phase_deg = 30.0,
                            .phase_deviation_deg = 0.04};

TEST(TablePhasor, DividesDeviationsByTheirCoverage) {
  const auto phasor = phasor_of(row, {.paths = {}, .coverage = 2.0}, "t");
  ASSERT_TRUE(phasor.has_value()) << phasor.error().message;
  EXPECT_EQ(phasor->amplitude_m_s2, 10.0);
  EXPECT_EQ(phasor->u_amplitude_m_s2, 0.001);
  EXPECT_DOUBLE_EQ(phasor->phase_rad, 30.0 * degree);
  EXPECT_DOUBLE_EQ(phasor->u_phase_rad, 0.02 * degree);
  EXPECT_EQ(phasor->coverage, 2.0);
}

TEST(TablePhasor, HasTheSignAndTheAmplitudeThatAreStated) {
  const auto phasor = phasor_of(row,
                                {.paths = {},
                                 .amplitude = TableAmplitude::rms,
                                 .phase = TablePhase::reference_minus_sync,
                                 .phase_offset_deg = 180.0,
                                 .coverage = 1.0},
                                "t");
  ASSERT_TRUE(phasor.has_value());
  EXPECT_DOUBLE_EQ(phasor->amplitude_m_s2, 10.0 * std::numbers::sqrt2);
  EXPECT_DOUBLE_EQ(phasor->u_amplitude_m_s2, 0.002 * std::numbers::sqrt2);
  EXPECT_DOUBLE_EQ(phasor->phase_rad, 150.0 * degree);
}

TEST(TablePhasor, TakesWhatTheBenchFileStatesInPlaceOfTheTable) {
  ReferenceTableRow bare = row;
  bare.amplitude_deviation_m_s2.reset();
  bare.phase_deviation_deg.reset();
  const TableSettings settings{.paths = {}, .u_amplitude_rel = 1e-3, .u_phase_deg = 0.1};
  for (const ReferenceTableRow& one : {bare, row}) {
    const auto phasor = phasor_of(one, settings, "t");
    ASSERT_TRUE(phasor.has_value());
    EXPECT_DOUBLE_EQ(phasor->u_amplitude_m_s2, 0.01);
    EXPECT_DOUBLE_EQ(phasor->u_phase_rad, 0.1 * degree);
    EXPECT_EQ(phasor->coverage, 1.0);
  }
}

TEST(TablePhasor, RefusesWhereNothingStatesAnUncertainty) {
  ReferenceTableRow bare = row;
  bare.amplitude_deviation_m_s2.reset();
  const auto missing = phasor_of(bare, {.paths = {}, .coverage = 2.0}, "t");
  ASSERT_FALSE(missing.has_value());
  EXPECT_EQ(missing.error().message, "t: line 7: the table states no uncertainty of the amplitude; "
                                     "state it with the source's key 'u_amplitude_rel'");
  ReferenceTableRow zero = row;
  zero.phase_deviation_deg = 0.0;
  EXPECT_EQ(phasor_of(zero, {.paths = {}, .coverage = 2.0}, "t").error().message,
            "t: line 7: the table states no uncertainty of the phase; state it with the source's "
            "key 'u_phase_deg'");
  EXPECT_EQ(phasor_of(row, {.paths = {}}, "t").error().message,
            "t: line 7: the table has a deviation of the amplitude, but nothing says how many "
            "standard uncertainties it is; state it with the source's key 'coverage' (2 for twice "
            "the standard uncertainty), or 'u_amplitude_rel'");
}

} // namespace
} // namespace dyncal::drivers::tables
