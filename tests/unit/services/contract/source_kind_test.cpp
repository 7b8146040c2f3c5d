#include "services/contract/source_kind.hpp"

#include <set>
#include <string>

#include <gtest/gtest.h>

namespace dyncal::inline contract {
namespace {

constexpr SourceKind kinds[] = {SourceKind::dau, SourceKind::acs, SourceKind::dso, SourceKind::tss,
                                SourceKind::can};

TEST(SourceKind, EveryKindHasAMemberOfTheContractAndATopicOfItsOwn) {
  std::set<wire::SourceKind> members;
  std::set<std::string> topics;
  for (const SourceKind kind : kinds) {
    EXPECT_EQ(from_wire(to_wire(kind)), kind);
    members.insert(to_wire(kind));
    topics.insert(sample_topic(kind));
    EXPECT_EQ(is_triggered(kind), std::string(sample_topic(kind)).ends_with("Record"));
  }
  EXPECT_EQ(members.size(), 5U);
  EXPECT_EQ(topics.size(), 5U);
}

} // namespace
} // namespace dyncal::inline contract
