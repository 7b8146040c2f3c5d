#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/checks/doctor/checks.hpp"
#include "services/checks/doctor/laboratory_view.hpp"
#include "tests/unit/services/checks/doctor/findings.hpp"

namespace dyncal::inline checks::doctor {
namespace {

using bus::DiscoveredEndpoint;
using bus::EndpointKind;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::problems;
using tests::warnings;

constexpr const char* source_id = "01100000000000000000000a";
constexpr const char* other_id = "010f0000000000000000000b";

class CheckEndpoints : public testing::Test {
protected:
  CheckEndpoints() {
    view_.discovery.participants = {{source_id, "dyncal-acs", "Cyclone DDS"},
                                    {other_id, "my reader", "Fast DDS"}};
    view_.sources[{"acc-1", "acs"}];
    writer_ = {.participant = source_id,
               .kind = EndpointKind::writer,
               .topic = "AcsSamples",
               .type = "dyncal::wire::SampleBlock",
               .partitions = {"acc-1"},
               .reliable = true,
               .transient_local = true};
    reader_ = writer_;
    reader_.participant = other_id;
    reader_.kind = EndpointKind::reader;
  }
  Findings check() {
    view_.discovery.endpoints = {writer_, reader_};
    return check_endpoints(view_, {});
  }

  LaboratoryView view_;
  DiscoveredEndpoint writer_;
  DiscoveredEndpoint reader_;
};

TEST_F(CheckEndpoints, FindsNothingWhereTheyMatch) {
  const Findings findings = check();
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].severity, Severity::ok);
  EXPECT_THAT(findings[0].sentence, HasSubstr("2 writers and readers of 2 participants"));
}

TEST_F(CheckEndpoints, NamesWhoWritesSamplesAndDescribesNoSource) {
  view_.addresses[source_id] = "10.98.0.1";
  view_.discovery.endpoints = {writer_, reader_};
  EXPECT_THAT(problems(check_writers(view_)),
              ElementsAre(HasSubstr("dyncal-acs (Cyclone DDS, 10.98.0.1) writes samples of bench "
                                    "acc-1 (topic AcsSamples) and describes no source")));
  writer_.topic = "SourceDescription";
  view_.discovery.endpoints.push_back(writer_);
  EXPECT_THAT(check_writers(view_), IsEmpty());
}

TEST_F(CheckEndpoints, NamesReliability) {
  writer_.reliable = false;
  EXPECT_THAT(
      problems(check()),
      ElementsAre(AllOf(HasSubstr("topic AcsSamples"), HasSubstr("dyncal-acs (Cyclone DDS)"),
                        HasSubstr("my reader (Fast DDS)"),
                        HasSubstr("reliability: the reader asks for RELIABLE, the writer "
                                  "offers BEST_EFFORT"))));
}

TEST_F(CheckEndpoints, NamesDurability) {
  writer_.transient_local = false;
  EXPECT_THAT(problems(check()), ElementsAre(HasSubstr("durability")));
}

TEST_F(CheckEndpoints, NamesTheType) {
  reader_.type = "SampleBlock";
  EXPECT_THAT(problems(check()), ElementsAre(HasSubstr("'dyncal::wire::SampleBlock', the reader "
                                                       "'SampleBlock'")));
}

TEST_F(CheckEndpoints, LetsAReaderAskForLess) {
  reader_.reliable = false;
  reader_.transient_local = false;
  EXPECT_THAT(problems(check()), IsEmpty());
}

TEST_F(CheckEndpoints, NamesThePartitionOfAReaderThatForgotIt) {
  reader_.partitions = {""};
  EXPECT_THAT(warnings(check()),
              ElementsAre(AllOf(HasSubstr("my reader (Fast DDS) is in partition ''"),
                                HasSubstr("dyncal-acs (Cyclone DDS) is in 'acc-1'"),
                                HasSubstr("ask for the name of the bench"))));
}

TEST_F(CheckEndpoints, DoesNotMixUpBenches) {
  view_.sources[{"acc-2", "acs"}];
  reader_.partitions = {"acc-2"};
  EXPECT_THAT(warnings(check()), IsEmpty()) << "both are benches of the laboratory";
}

TEST_F(CheckEndpoints, KnowsTheRunsOfABench) {
  view_.sources[{"acc-2", "acs"}];
  reader_.partitions = {"acc-2/20261125T080000.000Z"};
  EXPECT_THAT(warnings(check()), IsEmpty()) << "its writers may come later";
}

TEST_F(CheckEndpoints, LeavesOtherTopicsAlone) {
  writer_.topic = reader_.topic = "rt/chatter";
  writer_.reliable = false;
  EXPECT_THAT(problems(check()), IsEmpty());
}

TEST_F(CheckEndpoints, SaysEachThingOnce) {
  writer_.reliable = false;
  view_.discovery.endpoints = {writer_, writer_, reader_, reader_};
  EXPECT_EQ(problems(check_endpoints(view_, {})).size(), 1U);
}

TEST(PartitionsMatch, AsDdsHasIt) {
  EXPECT_TRUE(partitions_match("acc-1", "acc-1"));
  EXPECT_TRUE(partitions_match("", ""));
  EXPECT_FALSE(partitions_match("acc-1", "acc-2"));
  EXPECT_TRUE(partitions_match("*", "acc-1"));
  EXPECT_TRUE(partitions_match("acc-1", "acc-?"));
  EXPECT_FALSE(partitions_match("*", "*")) << "two patterns";
  EXPECT_FALSE(partitions_match("acc-[12]", "acc-*"));
}

} // namespace
} // namespace dyncal::inline checks::doctor
