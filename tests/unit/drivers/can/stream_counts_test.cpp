#include "drivers/can/stream_counts.hpp"

#include <set>

#include <gtest/gtest.h>

namespace dyncal::drivers::can {
namespace {

// Every count of the stream has a number of its own, which must be found again.
TEST(StreamCounts, EveryCountIsInTheCommonAccount) {
  std::uint64_t next = 1;
  std::set<std::uint64_t> expected;
  const auto set = [&](auto& count) {
    count = next;
    expected.insert(next++);
  };
  StreamCounts stream;
  for (auto* count :
       {&stream.frames, &stream.samples, &stream.lost, &stream.dropped_frames, &stream.incomplete,
        &stream.repeated, &stream.late, &stream.rejected, &stream.short_frames, &stream.no_value,
        &stream.not_trusted, &stream.interruptions, &stream.restarts, &stream.clock_restarts,
        &stream.faults["bit error"], &stream.faults["bus-off"]}) {
    set(*count);
  }
  LinkState link;
  link.restarts = 95;
  link.transmit_errors = 96;
  link.receive_errors = 97;
  expected.insert({95, 96, 97});

  const SampleCounts counts = sample_counts(stream, link, 2e-6);
  std::set<std::uint64_t> found{counts.received, counts.lost_on_way, counts.duplicates,
                                counts.stamps_not_trusted};
  std::set<std::string> names;
  for (const NamedCount& cause : counts.causes) {
    found.insert(cause.value);
    EXPECT_TRUE(names.insert(cause.name).second) << cause.name << " stands for two counts";
  }
  EXPECT_EQ(found, expected);
  EXPECT_EQ(counts.rejected, stream.rejected + stream.incomplete);
  EXPECT_EQ(counts.lost_in_device, 0U);
  EXPECT_DOUBLE_EQ(counts.clock_uncertainty_s, 2e-6);
}

} // namespace
} // namespace dyncal::drivers::can
