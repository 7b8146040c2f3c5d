#include "services/views/objections/subject_objections.hpp"

#include <functional>

#include <gmock/gmock.h>

namespace dyncal::inline views {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct Subject {
  StoredResult result;
  SensorFile sensor;
  ReferenceStandard reference;
};

Subject whole_subject() {
  Subject subject;
  subject.result.began_utc = "2026-03-01T12:00:05.000000000Z";
  subject.result.ended_utc = "2026-03-01T13:00:05.000000000Z";
  RunSource source;
  source.source = "dau";
  source.description.device = "MPU 9250";
  source.description.serial = "0xbccb0100";
  subject.result.sources = {source};
  subject.sensor.model = "MPU-9250";
  subject.sensor.serial = "0xBCCB0100";
  subject.sensor.received = "2026-02-20";
  subject.reference.issued = "2026-02-03";
  subject.reference.valid_until = "2028-02-03";
  return subject;
}

std::vector<std::string> objections(const std::function<void(Subject&)>& change) {
  Subject subject = whole_subject();
  change(subject);
  return objections_to_subject({.result = subject.result,
                                .channels = {"dau/z"},
                                .sensor = subject.sensor,
                                .reference = subject.reference,
                                .began = "2026-03-01",
                                .ended = "2026-03-01"});
}

TEST(SubjectObjections, HasNoneOfWhatFits) {
  EXPECT_THAT(objections([](Subject&) {}), IsEmpty());
  EXPECT_THAT(objections([](Subject& one) { one.sensor.model = "InvenSense MPU 9250"; }),
              IsEmpty());
  EXPECT_THAT(objections([](Subject& one) { one.sensor.received = "2026-03-01"; }), IsEmpty());
  EXPECT_THAT(objections([](Subject& one) { one.reference.issued = "2026-03-01"; }), IsEmpty());
  EXPECT_THAT(objections([](Subject& one) { one.reference.valid_until = "2026-03-01"; }),
              IsEmpty());
  EXPECT_THAT(objections([](Subject& one) { one.sensor.received.clear(); }), IsEmpty());
}

TEST(SubjectObjections, NamesAnotherSensor) {
  EXPECT_THAT(objections([](Subject& one) { one.sensor.serial = "0xdeadbeef"; }),
              ElementsAre(HasSubstr("electronic_serial = \"0xbccb0100\"")));
  EXPECT_THAT(objections([](Subject& one) { one.sensor.model = "BMA280"; }),
              ElementsAre(HasSubstr("electronic_model = \"MPU 9250\"")));
}

// What is on the label, and what the device calls itself.
TEST(SubjectObjections, TakesTheSensorsOwnNames) {
  EXPECT_THAT(objections([](Subject& one) {
                one.sensor.serial = "SN-777";
                one.sensor.electronic_serial = "0xbccb0100";
                one.sensor.model = "DigiSens 3";
                one.sensor.electronic_model = "MPU9250";
              }),
              IsEmpty());
  EXPECT_THAT(objections([](Subject& one) { one.sensor.electronic_serial = "0xbccb0101"; }),
              ElementsAre(HasSubstr("0xbccb0101")));
}

TEST(SubjectObjections, SaysNothingOfWhatASourceDoesNotState) {
  EXPECT_THAT(objections([](Subject& one) {
                one.result.sources.front().description = {};
                one.sensor.serial = "SN-777";
              }),
              IsEmpty());
}

TEST(SubjectObjections, NamesDaysThatContradictTheMeasurement) {
  EXPECT_THAT(objections([](Subject& one) { one.sensor.received = "2026-03-03"; }),
              ElementsAre(HasSubstr("was received on 2026-03-03")));
  EXPECT_THAT(objections([](Subject& one) { one.reference.issued = "2031-02-03"; }),
              ElementsAre(HasSubstr("2031-02-03, after the measurement")));
  EXPECT_THAT(objections([](Subject& one) { one.reference.valid_until = "2026-02-27"; }),
              ElementsAre(HasSubstr("calibrated again by 2026-02-27")));
  EXPECT_THAT(objections([](Subject& one) {
                one.reference.issued.clear();
                one.reference.valid_until.clear();
              }),
              ElementsAre(HasSubstr("reference.issued"), HasSubstr("reference.interval_months")));
}

} // namespace
} // namespace dyncal::inline views
