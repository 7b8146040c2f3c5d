#include "services/contract/topic_access.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

std::set<std::string> topics_of(const std::vector<TopicGroup>& groups) {
  std::set<std::string> topics;
  for (const TopicGroup& group : groups) {
    topics.insert(group.topics.begin(), group.topics.end());
  }
  return topics;
}

std::set<std::string> partitions_of(const std::vector<TopicGroup>& groups,
                                    const std::string& topic) {
  for (const TopicGroup& group : groups) {
    if (std::ranges::find(group.topics, topic) != group.topics.end()) {
      return {group.partitions.begin(), group.partitions.end()};
    }
  }
  return {};
}

TEST(TopicAccess, HasAWriterAndAReaderForEveryTopic) {
  std::set<std::string> topics;
  for (const TopicAccess& row : topic_access()) {
    EXPECT_TRUE(topics.insert(row.topic).second) << row.topic;
    EXPECT_THAT(row.writers, Not(IsEmpty())) << row.topic;
    EXPECT_THAT(row.readers, Not(IsEmpty())) << row.topic;
  }
  EXPECT_GE(topics.size(), 21U);
}

TEST(TopicAccess, LetsASourceWriteInItsBenchAlone) {
  const RoleAccess source = access_of(SecurityRole::source, {"acc-1"});
  EXPECT_THAT(partitions_of(source.written, "DauSamples"), ElementsAre("acc-1", "acc-1/*"));
  EXPECT_THAT(partitions_of(source.read, "Command"), ElementsAre("acc-1", "acc-1/*"));
  EXPECT_THAT(partitions_of(source.written, "CatchUpSamples"), ElementsAre("acc-1", "acc-1/*"));
  EXPECT_THAT(topics_of(source.written), Not(Contains("Measurement")));
  EXPECT_THAT(topics_of(source.written), Not(Contains("CalibrationResult")));
}

TEST(TopicAccess, LetsTheAnalysisAloneWriteResults) {
  for (const SecurityRole role : security_roles()) {
    const auto written = topics_of(access_of(role, {"acc-1"}).written);
    EXPECT_EQ(written.contains("CalibrationResult"), role == SecurityRole::analysis);
    EXPECT_EQ(written.contains("TransferFunction"), role == SecurityRole::analysis);
    EXPECT_EQ(written.contains("ServiceStatus"),
              role == SecurityRole::analysis || role == SecurityRole::guard);
    EXPECT_EQ(written.contains("Excitation"), role == SecurityRole::conductor);
    EXPECT_EQ(written.contains("DauSamples"), role == SecurityRole::source);
  }
}

TEST(TopicAccess, LetsAWatcherWriteNothingThatABenchReads) {
  const RoleAccess watcher = access_of(SecurityRole::watcher, {});
  EXPECT_THAT(topics_of(watcher.written), ElementsAre("ClockRequest", "LinkProbe"));
  EXPECT_THAT(partitions_of(watcher.written, "ClockRequest"), ElementsAre("all-benches"));
  EXPECT_THAT(partitions_of(watcher.read, "Measurement"), ElementsAre("*"));
}

std::string names_of(const std::vector<SecurityRole>& roles) {
  std::string names;
  for (const SecurityRole role : roles) {
    names += (names.empty() ? "" : ", ") + std::string(to_string(role));
  }
  return names;
}

// As the page has them: who reads all benches, in a word.
std::string readers_of(const TopicAccess& row) {
  const std::string watching = "analysis, operator, recorder, web, watcher";
  std::string names = names_of(row.readers);
  if (names.starts_with(watching)) {
    names.replace(0, watching.size(), "watching");
  }
  return names;
}

TEST(TopicAccess, IsTheTableOnThePageOfTheContract) {
  std::string table = "| topic | partition | written by | read by |\n|---|---|---|---|\n";
  for (const TopicAccess& row : topic_access()) {
    const char* place = row.place == TopicPlace::bench ? "bench" : "laboratory";
    table += "| `" + std::string(row.topic) + "` | " + place + " | " + names_of(row.writers) +
             " | " + readers_of(row) + " |\n";
  }
  std::ifstream page(DYNCAL_SOURCE "/idl/README.md");
  const std::string text{std::istreambuf_iterator<char>(page), std::istreambuf_iterator<char>()};
  EXPECT_THAT(text, HasSubstr(table + "\n"));
  // Each topic of the contract has a row.
  std::ifstream code(DYNCAL_SOURCE "/services/contract/topics.hpp");
  std::size_t topics = 0;
  for (std::string line; std::getline(code, line);) {
    topics += line.find("constexpr Topic<") != std::string::npos ? 1 : 0;
  }
  EXPECT_EQ(topic_access().size(), topics);
}

TEST(TopicAccess, KnowsItsRolesByName) {
  for (const SecurityRole role : security_roles()) {
    EXPECT_EQ(parse_security_role(to_string(role)), role);
  }
  EXPECT_EQ(parse_security_role("conductor"), std::nullopt);
}

} // namespace
} // namespace dyncal
