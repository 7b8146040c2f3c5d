// What the report on a sample clock says where stamps of the source are not trusted.
#include "services/evaluation/clock_report_builder.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "services/contract/source_block.hpp"
#include "services/contract/source_description.hpp"
#include "tests/unit/services/evaluation/synthetic_run.hpp"

namespace dyncal::inline evaluation {
namespace {

// Of the samples of every block, the first `not_trusted` are not.
ClockReport report_with(std::size_t not_trusted) {
  const tests::SyntheticRun run;
  ClockReportBuilder builder("dau", {});
  builder.describe(from_message(run.dau_description()));
  for (wire::SampleBlock& block : run.dau_blocks()) {
    block.stamp_flags().assign(block.sample_count(), 0);
    std::fill_n(block.stamp_flags().begin(), std::min(not_trusted, block.stamp_flags().size()), 1);
    builder.add(view_block(block));
  }
  const auto reports = builder.reports(0);
  EXPECT_EQ(reports.size(), 1U);
  return reports.empty() ? ClockReport{} : reports.front();
}

bool says_that_stamps_are_not_trusted(const ClockReport& report) {
  return std::any_of(report.flags.begin(), report.flags.end(),
                     [](const Flag& flag) { return flag.kind == ResultFlag::stamps_not_trusted; });
}

TEST(ClockReportBuilder, SaysWhenMostStampsAreNotTrusted) {
  const ClockReport report = report_with(40); // of 50
  EXPECT_NEAR(report.clock.mean_interval_s, 997e-6, 1e-7) << "of those that are trusted";
  EXPECT_TRUE(says_that_stamps_are_not_trusted(report));
}

TEST(ClockReportBuilder, SaysNothingOfFew) {
  EXPECT_FALSE(says_that_stamps_are_not_trusted(report_with(0)));
  EXPECT_FALSE(says_that_stamps_are_not_trusted(report_with(5)));
}

} // namespace
} // namespace dyncal::inline evaluation
