#include "analysis/uncertainty/common_contributions.hpp"

#include <set>

#include <gtest/gtest.h>

#include "analysis/uncertainty/contribution_identifier.hpp"

namespace dyncal::analysis {
namespace {

TEST(CommonContributions, AreThoseOfCalibrationsAlone) {
  std::set<std::string_view> common;
  for (int i = 0; i <= static_cast<int>(ContributionKind::other); ++i) {
    const auto kind = static_cast<ContributionKind>(i);
    if (is_common_to_results(kind)) {
      common.insert(identifier_of(kind));
      // What each repetition draws anew, no two results share.
      EXPECT_NE(repeats_of(kind), Repeats::anew) << identifier_of(kind);
    }
  }
  const std::set<std::string_view> expected{
      "adc_phase",   "channel_delay",     "detector_bandwidth", "detector_skew", "reference",
      "trace_clock", "transverse_motion", "trigger_delay",      "wavelength"};
  EXPECT_EQ(common, expected);
}

} // namespace
} // namespace dyncal::analysis
