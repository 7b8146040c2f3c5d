#include "services/contract/excitation_quantity.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline contract {
namespace {

drivers::SourceDescription described(const char* unit, bool is_interferometer) {
  drivers::SourceDescription source;
  source.channels = {{.name = "reference", .quantity = "", .unit = unit}};
  if (is_interferometer) {
    source.quadrature_signals.emplace_back().channel = "reference";
  }
  return source;
}

TEST(ExcitationQuantity, IsAnAccelerationOfAnInterferometer) {
  const auto source = described(R"(\metre)", true);
  EXPECT_EQ(excitation_unit(source, "reference"), R"(\metre\second\tothe{-2})");
  EXPECT_EQ(acceleration_factor(source, "reference", 10.0), 100.0);
  EXPECT_NE(quadrature_signals_of(source, "reference"), nullptr);
}

TEST(ExcitationQuantity, IsWhatTheChannelReadsOtherwise) {
  const auto acceleration = described(R"(\metre\second\tothe{-2})", false);
  EXPECT_EQ(excitation_unit(acceleration, "reference"), R"(\metre\second\tothe{-2})");
  EXPECT_EQ(acceleration_factor(acceleration, "reference", 10.0), 1.0);
  const auto displacement = described(R"(\metre)", false);
  EXPECT_EQ(excitation_unit(displacement, "reference"), R"(\metre)");
  EXPECT_FALSE(acceleration_factor(displacement, "reference", 10.0));
  EXPECT_EQ(excitation_unit(displacement, "another"), "");
  EXPECT_EQ(quadrature_signals_of(displacement, "reference"), nullptr);
}

} // namespace
} // namespace dyncal::inline contract
