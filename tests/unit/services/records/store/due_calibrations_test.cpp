#include "services/records/store/due_calibrations.hpp"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "services/records/store/document_register.hpp"
#include "services/records/store/sensor_library.hpp"
#include "services/records/store/store.hpp"
#include "tests/unit/services/records/store/example_results.hpp"
#include "tests/unit/services/records/store/store_places.hpp"

namespace dyncal::inline records {
namespace {

using testing::SizeIs;

class DueCalibrationsTest : public tests::StorePlaces {
protected:
  void add_sensor(const std::string& serial, int interval_months) const {
    auto library = SensorLibrary::open(place_);
    ASSERT_TRUE(library) << library.error().message;
    const std::string interval =
        interval_months == 0 ? "" : "interval_months = " + std::to_string(interval_months) + "\n";
    const auto added = (*library)->add({{"[sensor]\nname = \"a\"\nmanufacturer = \"Works\"\n"
                                         "model = \"MPU\"\nserial = \"" +
                                             serial + "\"\n" + interval,
                                         "s.toml"}},
                                       false);
    ASSERT_TRUE(added) << added.error().message;
  }
  // Of a result in the store whose run ended in November 2023.
  void add_result_with_document(const std::string& serial, const std::string& number) {
    auto store = Store::open(place_);
    ASSERT_TRUE(store) << store.error().message;
    RunOutcome outcome = tests::outcome_of({});
    outcome.ended_utc_ns = outcome.began_utc_ns + 60'000'000'000;
    ASSERT_TRUE((*store)->add(folder_.write("result.json", tests::text_of(outcome))));
    const auto runs = (*store)->runs({});
    ASSERT_TRUE(runs && runs->size() == 1);
    auto documents = DocumentRegister::open(place_);
    ASSERT_TRUE(documents) << documents.error().message;
    ASSERT_TRUE((*documents)
                    ->enter({.sha256 = number,
                             .number = number,
                             .kind = "DCC",
                             .replaces = {},
                             .result_sha256 = runs->front().result_sha256,
                             .bench = "acc-1",
                             .run = "r1",
                             .serial = serial,
                             .file = "c.xml"}));
  }
};

TEST_P(DueCalibrationsTest, CountFromTheRunOfTheNewestDocument) {
  add_sensor("S-1", 12);
  add_sensor("never", 6);
  add_sensor("without interval", 0);
  add_result_with_document("S-1", "2023-7");
  const auto dates = calibration_dates(place_);
  ASSERT_TRUE(dates) << dates.error().message;
  ASSERT_THAT(*dates, SizeIs(2));
  EXPECT_EQ((*dates)[0].serial, "never");
  EXPECT_EQ((*dates)[0].due, "");
  EXPECT_TRUE((*dates)[0].is_due_by("2000-01-01"));
  const CalibrationDate& known = (*dates)[1];
  EXPECT_EQ(known.serial, "S-1");
  EXPECT_EQ(known.name, "Works MPU");
  EXPECT_EQ(known.last, "2023-11-14");
  EXPECT_EQ(known.due, "2024-11-14");
  EXPECT_EQ(known.certificate, "2023-7");
  EXPECT_FALSE(known.is_due_by("2024-11-14"));
  EXPECT_TRUE(known.is_due_by("2024-11-15"));
}

TEST(CalibrationDates, AreThoseOfTheNewestCertificateOfADevice) {
  const auto device = [](const char* name, const char* serial, const char* valid_until) {
    CalibratedDevice one;
    one.name = name;
    one.serial = serial;
    one.valid_until = valid_until;
    return one;
  };
  const auto dates = newest_of_each(
      dates_of_devices({device("8305", "1", "2028-01-01"), device("8305", "1", "2026-01-01"),
                        device("exciter", "2", ""), device("amplifier", "1", "2027-01-01")},
                       "reference"));
  ASSERT_THAT(dates, SizeIs(2));
  EXPECT_EQ(dates[0].name, "amplifier");
  EXPECT_EQ(dates[1].due, "2028-01-01");
  const auto json = calibration_dates_json(dates, "2027-06-01");
  EXPECT_TRUE(json[0]["overdue"].get<bool>());
  EXPECT_FALSE(json[1]["overdue"].get<bool>());
}

INSTANTIATE_TEST_SUITE_P(Databases, DueCalibrationsTest,
                         testing::Values(tests::StoreKind::sqlite, tests::StoreKind::postgres),
                         tests::kind_name);

} // namespace
} // namespace dyncal::inline records
