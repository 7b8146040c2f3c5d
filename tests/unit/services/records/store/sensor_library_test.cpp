#include "services/records/store/sensor_library.hpp"

#include <gmock/gmock.h>

#include "services/records/store/audit_trail.hpp"
#include "tests/unit/services/records/store/store_places.hpp"

namespace dyncal::inline records {
namespace {

using testing::HasSubstr;
using testing::SizeIs;

std::string file_of(const std::string& serial, const std::string& more = "") {
  return "[sensor]\nname = \"accelerometer\"\nmanufacturer = \"Works\"\nmodel = \"MPU\"\nserial = "
         "\"" +
         serial + "\"\n" + more;
}

class SensorLibraryTest : public tests::StorePlaces {
protected:
  [[nodiscard]] std::unique_ptr<SensorLibrary> library() const {
    auto opened = SensorLibrary::open(place_);
    EXPECT_TRUE(opened) << opened.error().message;
    return std::move(*opened);
  }
};

TEST_P(SensorLibraryTest, KeepsASensorAsItsFileSays) {
  const std::string text = file_of("S-1", "interval_months = 12\n");
  EXPECT_EQ(library()->add({{text, "s.toml"}}, false).value().front(), SensorAddition::added);
  EXPECT_EQ(library()->add({{text, "s.toml"}}, false).value().front(),
            SensorAddition::already_there);
  const auto known = library()->find("S-1");
  ASSERT_TRUE(known && *known);
  EXPECT_EQ((*known)->sensor.interval_months, 12);
  EXPECT_EQ((*known)->text, text);
  EXPECT_EQ((*known)->version, 1);
  EXPECT_THAT((*known)->added_utc, HasSubstr("T"));
  const auto unknown = library()->find("S-2");
  ASSERT_TRUE(unknown);
  EXPECT_FALSE(*unknown);
}

TEST_P(SensorLibraryTest, ChangesASensorOnlyWhenAsked) {
  ASSERT_TRUE(library()->add({{file_of("S-1"), "s.toml"}}, false));
  const std::string changed = file_of("S-1", "firmware = \"2\"\n");
  const auto refused = library()->add({{changed, "s.toml"}}, false);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("is in the library with another file since"));
  EXPECT_EQ(library()->add({{changed, "s.toml"}}, true).value().front(), SensorAddition::changed);
  const auto versions = library()->versions("S-1");
  ASSERT_TRUE(versions);
  ASSERT_THAT(*versions, SizeIs(2));
  EXPECT_EQ((*versions)[0].sensor.firmware, "");
  EXPECT_EQ((*versions)[1].sensor.firmware, "2");
  const auto trail = audit_entries(*open());
  ASSERT_TRUE(trail);
  ASSERT_THAT(*trail, SizeIs(2));
  EXPECT_EQ((*trail)[1].subject, sensor_hash("S-1", 2, changed));
  EXPECT_THAT((*trail)[1].detail, HasSubstr("version 2"));
  ASSERT_TRUE(library()->add({{file_of("R-9"), "r.toml"}}, false));
  const auto all = library()->all();
  ASSERT_TRUE(all);
  ASSERT_THAT(*all, SizeIs(2));
  EXPECT_EQ((*all)[0].sensor.serial, "R-9");
  EXPECT_EQ((*all)[1].version, 2);
}

TEST_P(SensorLibraryTest, AddsAllOrNone) {
  const auto refused = library()->add(
      {{file_of("S-1"), "a.toml"}, {file_of("S-2", "received = 2026-03-01\n"), "b"}}, false);
  ASSERT_FALSE(refused);
  EXPECT_THAT(library()->all().value(), SizeIs(0));
  EXPECT_THAT(audit_entries(*open()).value(), SizeIs(0));
  ASSERT_TRUE(library()->add({{file_of("S-1"), "a.toml"}, {file_of("S-2"), "b"}}, false));
  EXPECT_THAT(library()->all().value(), SizeIs(2));
}

TEST_P(SensorLibraryTest, AChangeBehindTheTrailIsSeen) {
  ASSERT_TRUE(library()->add({{file_of("S-1"), "s.toml"}}, false));
  ASSERT_TRUE(library()->add({{file_of("S-1", "firmware = \"2\"\n"), "s.toml"}}, true));
  ASSERT_TRUE(library()->add({{file_of("S-1"), "s.toml"}}, true)); // as it was at first
  EXPECT_THAT(audit_problems(*open()).value(), SizeIs(0));
  ASSERT_TRUE(open()->execute("UPDATE sensors SET file = $1 WHERE version = 2",
                              {file_of("S-1", "firmware = \"3\"\n")}));
  EXPECT_THAT(audit_problems(*open()).value(), testing::Contains(HasSubstr("version 2")));
  ASSERT_TRUE(open()->execute("DELETE FROM sensors WHERE version = 2"));
  EXPECT_THAT(audit_problems(*open()).value(),
              testing::ElementsAre(HasSubstr("is not in the store any more")));
}

TEST_P(SensorLibraryTest, RefusesWhatBelongsToOneCalibration) {
  for (const char* part :
       {"received = 2026-03-01\n", "condition = \"no damage\"\n", "[certificate]\nnumber = \"1\"\n",
        "[conditions]\nmounting = \"M5\"\n"}) {
    const auto refused = library()->add({{file_of("S-1", part), "s.toml"}}, false);
    ASSERT_FALSE(refused) << part;
    EXPECT_THAT(refused.error().message, HasSubstr("belongs to one calibration"));
  }
  EXPECT_THAT(library()->all().value(), SizeIs(0));
}

INSTANTIATE_TEST_SUITE_P(Databases, SensorLibraryTest,
                         testing::Values(tests::StoreKind::sqlite, tests::StoreKind::postgres),
                         tests::kind_name);

} // namespace
} // namespace dyncal::inline records
