#include "services/programs/demo/vendor_assignment.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bus/bus.hpp"

namespace dyncal::inline programs {
namespace {

class VendorAssignment : public testing::Test {
protected:
  void SetUp() override {
    if (bus::vendors_in_this_build().size() < 2) {
      GTEST_SKIP() << "this build has only one DDS implementation";
    }
  }
};

TEST_F(VendorAssignment, OneWordIsForAll) {
  const auto words = parse_vendor_assignment("cyclonedds");
  ASSERT_TRUE(words) << words.error().message;
  for (const char* service : {"dau", "acs", "analysis", "run"}) {
    EXPECT_EQ(words->at(service), "cyclonedds") << service;
  }
}

TEST_F(VendorAssignment, NamedServicesGetTheirsAndTheOthersTheFirstOfTheBuild) {
  const auto words = parse_vendor_assignment("dau=cyclonedds,analysis=cyclonedds");
  ASSERT_TRUE(words) << words.error().message;
  EXPECT_EQ(words->at("dau"), "cyclonedds");
  EXPECT_EQ(words->at("acs"), bus::to_string(bus::vendors_in_this_build().front()));
}

TEST_F(VendorAssignment, RefusesWordsThatAreNone) {
  EXPECT_FALSE(parse_vendor_assignment("opendds"));
  EXPECT_THAT(
      parse_vendor_assignment("dso=fastdds").error().message,
      testing::HasSubstr("names the service 'dso', but a demo has: acs, analysis, dau, run"));
}

} // namespace
} // namespace dyncal::inline programs
