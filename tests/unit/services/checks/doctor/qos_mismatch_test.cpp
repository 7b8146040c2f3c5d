#include "services/checks/doctor/qos_mismatch.hpp"

#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::inline checks::doctor {
namespace {

using bus::AccessScope;
using bus::DestinationOrder;
using bus::DiscoveredEndpoint;
using bus::Liveliness;
using testing::ElementsAre;
using testing::IsEmpty;

struct Policy {
  std::string sentence;
  std::function<void(DiscoveredEndpoint& writer, DiscoveredEndpoint& reader)> set;
  bool both_ways = false; // also the other way round they do not match
};

class QosMismatch : public testing::TestWithParam<Policy> {};

TEST(QosMismatches, AreNoneOfDefaults) {
  EXPECT_THAT(qos_mismatches({}, {}), IsEmpty());
}

TEST(QosMismatches, AreNamedAll) {
  DiscoveredEndpoint reader;
  reader.reliable = true;
  reader.deadline_s = 1.0;
  EXPECT_EQ(qos_mismatches({}, reader).size(), 2U);
}

TEST(QosMismatches, LetAReaderTakeOneRepresentationOfSeveral) {
  DiscoveredEndpoint writer;
  DiscoveredEndpoint reader;
  reader.representations = {2, 0};
  EXPECT_THAT(qos_mismatches(writer, reader), IsEmpty()) << "nothing said is XCDR1";
  writer.representations = {2, 0};
  reader.representations = {0};
  EXPECT_EQ(qos_mismatches(writer, reader).size(), 1U) << "a writer sends in its first one";
}

TEST_P(QosMismatch, IsNamedWithBothValues) {
  DiscoveredEndpoint writer;
  DiscoveredEndpoint reader;
  GetParam().set(writer, reader);
  EXPECT_THAT(qos_mismatches(writer, reader), ElementsAre(GetParam().sentence));
  EXPECT_THAT(qos_mismatches(writer, writer), IsEmpty());
  EXPECT_THAT(qos_mismatches(reader, reader), IsEmpty());
  EXPECT_EQ(qos_mismatches(reader, writer).empty(), !GetParam().both_ways)
      << "a writer may offer more";
}

std::vector<Policy> policies() {
  const auto asks = [](const std::string& policy, const std::string& asked,
                       const std::string& offered) {
    return policy + ": the reader asks for " + asked + ", the writer offers " + offered;
  };
  return {
      {asks("reliability", "RELIABLE", "BEST_EFFORT"),
       [](auto& /*writer*/, auto& reader) { reader.reliable = true; }},
      {asks("durability", "TRANSIENT_LOCAL", "VOLATILE"),
       [](auto& /*writer*/, auto& reader) { reader.transient_local = true; }},
      {asks("ownership", "EXCLUSIVE", "SHARED"),
       [](auto& /*writer*/, auto& reader) { reader.exclusive_ownership = true; }, true},
      {asks("ownership", "SHARED", "EXCLUSIVE"),
       [](auto& writer, auto& /*reader*/) { writer.exclusive_ownership = true; }, true},
      {asks("deadline", "at most 0.5 s", "infinite"),
       [](auto& /*writer*/, auto& reader) { reader.deadline_s = 0.5; }},
      {asks("deadline", "at most 0.5 s", "2 s"),
       [](auto& writer, auto& reader) {
         writer.deadline_s = 2.0;
         reader.deadline_s = 0.5;
       }},
      {asks("latency budget", "at most 0 s", "1 s"),
       [](auto& writer, auto& /*reader*/) { writer.latency_budget_s = 1.0; }},
      {asks("liveliness", "MANUAL_BY_TOPIC", "AUTOMATIC"),
       [](auto& /*writer*/, auto& reader) { reader.liveliness = Liveliness::manual_by_topic; }},
      {asks("liveliness", "MANUAL_BY_TOPIC", "MANUAL_BY_PARTICIPANT"),
       [](auto& writer, auto& reader) {
         writer.liveliness = Liveliness::manual_by_participant;
         reader.liveliness = Liveliness::manual_by_topic;
       }},
      {asks("lease of liveliness", "at most 3 s", "infinite"),
       [](auto& /*writer*/, auto& reader) { reader.lease_s = 3.0; }},
      {asks("presentation", "GROUP", "INSTANCE"),
       [](auto& /*writer*/, auto& reader) { reader.access_scope = AccessScope::group; }},
      {asks("presentation", "coherent access", "none"),
       [](auto& /*writer*/, auto& reader) { reader.coherent_access = true; }},
      {asks("presentation", "ordered access", "none"),
       [](auto& /*writer*/, auto& reader) { reader.ordered_access = true; }},
      {asks("destination order", "BY_SOURCE_TIMESTAMP", "BY_RECEPTION_TIMESTAMP"),
       [](auto& /*writer*/, auto& reader) {
         reader.destination_order = DestinationOrder::by_source;
       }},
      {asks("data representation", "XCDR2", "XCDR1"),
       [](auto& /*writer*/, auto& reader) { reader.representations = {2}; }, true},
  };
}
INSTANTIATE_TEST_SUITE_P(Policies, QosMismatch, testing::ValuesIn(policies()));

} // namespace
} // namespace dyncal::inline checks::doctor
