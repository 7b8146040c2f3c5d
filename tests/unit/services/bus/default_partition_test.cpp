#include "services/bus/default_partition.hpp"

#include <gtest/gtest.h>

#include "tests/unit/services/bus/bus_pair.hpp"

namespace dyncal::bus {
namespace {

constexpr int messages = 20;

class DefaultPartition : public BusPair {
protected:
  // Each with a key of its own, so that a reader of the newest keeps them all.
  void write_all(Writer<wire::SourceStatus>& writer) {
    wire::SourceStatus status;
    status.bench(bench_);
    for (int i = 0; i < messages; ++i) {
      status.source("source " + std::to_string(i));
      ASSERT_EQ(writer.write(status), WriteOutcome::written);
    }
  }
  static int take(Reader<wire::SourceStatus>& reader) {
    return static_cast<int>(reader.take([](const wire::SourceStatus&) {}));
  }
};

INSTANTIATE_TEST_SUITE_P(AllBuses, DefaultPartition, testing::ValuesIn(carrier_pairs()), pair_name);

TEST_P(DefaultPartition, HasResultsAndStateOnceForEveryReader) {
  for (const Profile profile : {Profile::results, Profile::state}) {
    auto writer = this->writer<wire::SourceStatus>(topics::source_status, profile);
    std::vector<Reader<wire::SourceStatus>> readers;
    for (const std::string& partition : {std::string(), bench_, std::string("*")}) {
      readers.push_back(
          reading_.reader<wire::SourceStatus>(topics::source_status, profile, partition, bell_)
              .value());
    }
    write_all(writer);
    std::vector<int> taken(readers.size());
    ASSERT_TRUE(wait_for([&] {
      for (std::size_t i = 0; i < readers.size(); ++i) {
        taken[i] += take(readers[i]);
      }
      return std::ranges::all_of(taken, [](int count) { return count >= messages; });
    })) << taken[0]
        << ", " << taken[1] << ", " << taken[2];
    EXPECT_TRUE(writer.wait_for_acknowledgments(tests::patience));
    for (std::size_t i = 0; i < readers.size(); ++i) {
      EXPECT_EQ(taken[i] + take(readers[i]), messages) << "reader " << i;
    }
  }
}

TEST_P(DefaultPartition, HasSamplesOnceTheyAreAskedFor) {
  publish_samples_in_default_partition(false);
  const auto nameless =
      reading_.reader<wire::SampleBlock>(topics::dau_samples, Profile::live_samples, "", bell_)
          .value();
  const auto of_bench = this->reader<wire::SampleBlock>(topics::dau_samples, Profile::live_samples);
  {
    const auto writer = this->writer<wire::SampleBlock>(topics::dau_samples, Profile::live_samples);
    ASSERT_TRUE(wait_for([&] { return of_bench.matched_writers() == 1; }));
    EXPECT_EQ(nameless.matched_writers(), 0);
  }
  publish_samples_in_default_partition(true);
  const auto writer = this->writer<wire::SampleBlock>(topics::dau_samples, Profile::live_samples);
  EXPECT_TRUE(wait_for([&] { return nameless.matched_writers() == 1; }));
}

TEST(DefaultPartitionOf, HasNothingOfASecuredLaboratoryAndNoCommands) {
  publish_samples_in_default_partition(true);
  const std::vector<std::string> bench{"bench"};
  for (const Profile profile :
       {Profile::results, Profile::state, Profile::samples, Profile::live_samples,
        Profile::live_records, Profile::paced_samples}) {
    EXPECT_EQ(partitions_of_writer(profile, true, bench), bench);
    EXPECT_EQ(partitions_of_writer(profile, false, bench), (std::vector<std::string>{"bench", ""}));
  }
  for (const Profile profile : {Profile::command, Profile::catch_up, Profile::probe}) {
    EXPECT_EQ(partitions_of_writer(profile, false, bench), bench);
  }
}

} // namespace
} // namespace dyncal::bus
