#include "services/instruments/listening_plan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/services/programs/dau/bench_text.hpp"

namespace dyncal::inline instruments {
namespace {

using testing::HasSubstr;

BenchFile bench(const std::string& name, const std::string& sources,
                const std::string& dau = "dau") {
  auto file = parse_bench_file(tests::bench_text(name, sources, dau), "/tmp/" + name + ".toml");
  EXPECT_TRUE(file) << file.error().message;
  return std::move(*file);
}

TEST(ListeningPlan, SourcesOfSeveralBenchesShareAnAddress) {
  const auto plan = plan_listening(
      {bench("a", tests::smartup_source("dau", "0.0.0.0:7654", "0xbccb0100")),
       bench("b", tests::smartup_source("dau", "0.0.0.0:7654", "0x1fe40100") +
                      tests::smartup_source("other", "0.0.0.0:7000", "0x1fe40200"))});
  ASSERT_TRUE(plan) << plan.error().message;
  ASSERT_EQ(plan->size(), 2U);
  EXPECT_EQ((*plan)[0].listen, "0.0.0.0:7654");
  ASSERT_EQ((*plan)[0].sources.size(), 2U);
  EXPECT_EQ((*plan)[0].sources[1].bench, "b");
  EXPECT_EQ((*plan)[0].sources[1].settings.sensor, 0x1fe40100U);
  EXPECT_EQ((*plan)[0].sources[0].settings.naming.names.at("Data_11"), "sync");
  EXPECT_EQ((*plan)[1].sources[0].source, "other");
}

TEST(ListeningPlan, TheSameIdAtAnotherAddressIsAnotherSensor) {
  EXPECT_TRUE(
      plan_listening({bench("a", tests::smartup_source("dau", "0.0.0.0:7654", "0xbccb0100")),
                      bench("b", tests::smartup_source("dau", "0.0.0.0:7655", "0xbccb0100"))}));
}

TEST(ListeningPlan, ASensorBelongsToOneBench) {
  const auto plan =
      plan_listening({bench("a", tests::smartup_source("dau", "0.0.0.0:7654", "0xbccb0100")),
                      bench("b", tests::smartup_source("dau", "0.0.0.0:7654", "0xbccb0100"))});
  ASSERT_FALSE(plan);
  EXPECT_EQ(plan.error().code, ErrorCode::bad_file);
  EXPECT_THAT(
      plan.error().message,
      HasSubstr("sensor 0xbccb0100 at 0.0.0.0:7654 already belongs to source 'dau' of bench 'a'"));
}

TEST(ListeningPlan, ABenchWithoutSmartUpSourceHasNothingToReceive) {
  const auto plan = plan_listening(
      {bench("a", "[sources.dau]\ndriver = \"socket\"\naddress = \"127.0.0.1:5027\"\n")});
  ASSERT_FALSE(plan);
  EXPECT_THAT(plan.error().message, HasSubstr("no source has driver = \"smartup\""));
}

} // namespace
} // namespace dyncal::inline instruments
