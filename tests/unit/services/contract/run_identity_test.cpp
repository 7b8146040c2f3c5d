#include "services/contract/run_identity.hpp"

#include <gtest/gtest.h>

#include "services/contract/time_name.hpp"

namespace dyncal::inline contract {
namespace {

constexpr std::int64_t now_ns = 1'795'342'530'125'000'000;

TEST(RunIdentity, OfOneNameAndInstantIsUniqueAndFitsTheKey) {
  const std::string name(max_run_name, 'x');
  const auto one = RunIdentity::begin(name, now_ns);
  const auto other = RunIdentity::begin(name, now_ns);
  ASSERT_TRUE(one && other);
  EXPECT_NE(one->text(), other->text());
  EXPECT_EQ(one->text().size(), 64U);
  EXPECT_TRUE(one->text().starts_with(name + "." + time_name(now_ns) + "."));
}

TEST(RunIdentity, IsReadFromItsText) {
  for (const char* name :
       {"R1", "a.b", "", "20261122T101530.125Z", "20261122T101530.125Z.4f2a91c0"}) {
    const auto run = RunIdentity::begin(name, now_ns);
    ASSERT_TRUE(run) << name;
    const RunIdentity read = RunIdentity::parse(run->text());
    EXPECT_EQ(read.name, run->name);
    EXPECT_EQ(read.start, run->start);
    EXPECT_EQ(read.conductor, run->conductor);
    EXPECT_EQ(read.text(), run->text());
  }
}

TEST(RunIdentity, OfAnOlderProgramIsItsName) {
  for (const char* text : {"R1", "20261122T101530.125Z", "R1.20261122T101530.125Z.4f2a91cg",
                           "R1-20261122T101530.125Z.4f2a91c0", ".20261122T101530.125Z.4f2a91c0"}) {
    const RunIdentity run = RunIdentity::parse(text);
    EXPECT_EQ(run.name, text);
    EXPECT_EQ(run.text(), text);
    EXPECT_TRUE(run.conductor.empty());
  }
}

TEST(RunIdentity, IsCalledByNameOrText) {
  const auto run = RunIdentity::begin("mpu 7/z", now_ns);
  ASSERT_TRUE(run);
  EXPECT_EQ(run->name, "mpu_7_z");
  EXPECT_TRUE(run->is_called("mpu 7/z"));
  EXPECT_TRUE(run->is_called(run->text()));
  EXPECT_FALSE(run->is_called("mpu"));
  EXPECT_FALSE(RunIdentity::parse("a/b").is_called("a_b"));
}

TEST(RunIdentity, RefusesALongNameWithTheNumber) {
  const auto run = RunIdentity::begin(std::string(max_run_name + 1, 'x'), now_ns);
  ASSERT_FALSE(run);
  EXPECT_EQ(run.error().code, ErrorCode::bad_argument);
  EXPECT_NE(run.error().message.find("35 characters, and may have 34"), std::string::npos);
}

TEST(RunIdentity, SaysSinceWhen) {
  EXPECT_EQ(RunIdentity::parse("R1.20261122T101530.125Z.4f2a91c0").since(),
            "2026-11-22 10:15:30 UTC");
  EXPECT_EQ(RunIdentity::parse("R1").since(), "");
}

} // namespace
} // namespace dyncal::inline contract
