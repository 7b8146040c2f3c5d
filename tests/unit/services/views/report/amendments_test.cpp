#include "services/views/report/amendments.hpp"

#include <random>

#include <gmock/gmock.h>

namespace dyncal::inline views {
namespace {

using testing::HasSubstr;
using testing::SizeIs;

StoredResult run_of(const std::vector<std::string>& sources) {
  StoredResult result;
  for (const std::string& name : sources) {
    RunSource source;
    source.source = name;
    source.description.serial = "0x1";
    source.description.device = "MPU 9250";
    result.sources.push_back(source);
    StoredChannel channel;
    channel.channel = name + "/z";
    result.channels.push_back(channel);
  }
  RunSource acs;
  acs.source = "acs";
  acs.description.serial = "5";
  result.sources.push_back(acs);
  result.conducted_by = ActingPerson{"", "meter", "lab3"};
  return result;
}

JournalEntry entry_of(const AmendedValue& change, const std::string& utc) {
  return {JournalKind::amendment, utc, {"A. Meter", "meter", "lab3"}, "typing error", {change}};
}

std::string refusal(const StoredResult& result, const std::string& assignment) {
  const auto change = amended_value(result, assignment);
  return change ? "" : change.error().message;
}

TEST(Amendments, KnowWhatIsThereNow) {
  const StoredResult result = run_of({"dau"});
  const auto serial = amended_value(result, "serial=SN-7=8");
  ASSERT_TRUE(serial) << serial.error().message;
  EXPECT_EQ(serial->key, "dau/serial");
  EXPECT_EQ(serial->before, "0x1");
  EXPECT_EQ(serial->after, "SN-7=8");
  EXPECT_EQ(amended_value(result, "operator=A. Meter")->before, "meter");
  EXPECT_EQ(amended_value(result, "acs/serial=6")->before, "5");
  EXPECT_EQ(amended_value(result, "customer=M")->before, "");
}

TEST(Amendments, RefuseNumbersOfTheMeasurementAndWhatIsNotMeant) {
  const StoredResult result = run_of({"dau"});
  for (const char* key :
       {"magnitude", "began_utc", "U", "dau/magnitude", "flags", "acs/operator"}) {
    EXPECT_THAT(refusal(result, std::string(key) + "=1"), HasSubstr("cannot be amended")) << key;
  }
  EXPECT_THAT(refusal(result, "serial"), HasSubstr("KEY=VALUE"));
  EXPECT_THAT(refusal(result, "=x"), HasSubstr("KEY=VALUE"));
  EXPECT_THAT(refusal(result, "serial="), HasSubstr("no value"));
  EXPECT_THAT(refusal(result, "serial=0x1"), HasSubstr("already"));
  EXPECT_THAT(refusal(result, "temperature_degc=23,1"), HasSubstr("decimal point"));
  EXPECT_THAT(refusal(result, "tss/serial=1"), HasSubstr("no source 'tss'"));
  EXPECT_THAT(refusal(run_of({"dau", "can"}), "serial=1"), HasSubstr("several sources (can, dau)"));
}

TEST(Amendments, TakeTheNewestInWhateverOrderTheyCome) {
  std::vector<JournalEntry> journal;
  for (int i = 1; i <= 9; ++i) {
    journal.push_back(entry_of({"dau/serial", "", "SN-" + std::to_string(i)},
                               "2026-03-0" + std::to_string(i) + "T00:00:00.000000000Z"));
  }
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    std::mt19937 draw(seed);
    std::vector<JournalEntry> shuffled = journal;
    std::ranges::shuffle(shuffled, draw);
    StoredResult result = run_of({"dau"});
    add_journal(shuffled, result);
    EXPECT_EQ(result.sources[0].description.serial, "SN-9") << "seed " << seed;
    EXPECT_EQ(result.sources[1].description.serial, "5");
    EXPECT_THAT(amendment_sentences(result.journal), SizeIs(9));
  }
}

TEST(Amendments, OfThePersonKeepFromWhere) {
  StoredResult result = run_of({"dau"});
  add_journal({entry_of({"operator", "meter", "B. Other"}, "2026-03-01T00:00:00.000000000Z"),
               entry_of({"comment", "", "third"}, "2026-03-01T00:00:00.000000000Z")},
              result);
  EXPECT_EQ(text_of(*result.conducted_by), "B. Other (meter on lab3)");
  EXPECT_EQ(result.comment, "third");
}

} // namespace
} // namespace dyncal::inline views
