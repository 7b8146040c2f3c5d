#include "services/views/objections/subject_objections.hpp"

#include <functional>

#include <gmock/gmock.h>

#include "services/views/language/translated_texts.hpp"
#include "services/views/report/amendments.hpp"

namespace dyncal::inline views {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct Subject {
  StoredResult result;
  SensorFile sensor;
  LaboratoryFile laboratory;
  ReferenceStandard reference;

  CalibratedDevice& device() { return reference.devices.front(); }
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
  subject.reference = {.devices = {{.name = "reference",
                                    .manufacturer = {},
                                    .model = {},
                                    .serial = "1842876",
                                    .certificate = "PTB-17042",
                                    .issued_by = "PTB",
                                    .issued = "2026-02-03",
                                    .valid_until = "2028-02-03"}},
                       .standard = "ISO 16063-21",
                       .traceability = "SI",
                       .file = "ref.toml",
                       .file_sha256 = {}};
  return subject;
}

std::vector<std::string> objections(const std::function<void(Subject&)>& change,
                                    Language language = Language::english) {
  Subject subject = whole_subject();
  change(subject);
  return texts_in(language, objections_to_subject({.result = subject.result,
                                                   .channels = {"dau/z"},
                                                   .sensor = subject.sensor,
                                                   .laboratory = subject.laboratory,
                                                   .reference = subject.reference,
                                                   .began = "2026-03-01",
                                                   .ended = "2026-03-01"}));
}

TEST(SubjectObjections, HasNoneOfWhatFits) {
  EXPECT_THAT(objections([](Subject&) {}), IsEmpty());
  EXPECT_THAT(objections([](Subject& one) { one.sensor.model = "InvenSense MPU 9250"; }),
              IsEmpty());
  EXPECT_THAT(objections([](Subject& one) { one.sensor.received = "2026-03-01"; }), IsEmpty());
  EXPECT_THAT(objections([](Subject& one) { one.device().issued = "2026-03-01"; }), IsEmpty());
  EXPECT_THAT(objections([](Subject& one) { one.device().valid_until = "2026-03-01"; }), IsEmpty());
  EXPECT_THAT(objections([](Subject& one) { one.sensor.received.clear(); }), IsEmpty());
}

TEST(SubjectObjections, NamesAnotherSensor) {
  EXPECT_THAT(objections([](Subject& one) { one.sensor.serial = "0xdeadbeef"; }),
              ElementsAre(HasSubstr("electronic_serial = \"0xbccb0100\"")));
  EXPECT_THAT(objections([](Subject& one) { one.sensor.model = "BMA280"; }),
              ElementsAre(HasSubstr("electronic_model = \"MPU 9250\"")));
}

// An amendment is the stated override of what the source said of itself.
TEST(SubjectObjections, TakesTheAmendedSerialNumberAndNoOther) {
  const auto amended_to = [](Subject& one, const std::string& serial) {
    add_journal({{JournalKind::amendment,
                  "2026-03-02T00:00:00.000000000Z",
                  {"A. Meter", "meter", "lab3"},
                  "typing error",
                  {{"dau/serial", "0xbccb0100", serial}}}},
                one.result);
  };
  EXPECT_THAT(objections([&](Subject& one) {
                amended_to(one, "SN-777");
                one.sensor.serial = "SN-777";
                one.sensor.electronic_serial = "0xbccb0100";
              }),
              IsEmpty());
  EXPECT_THAT(objections([&](Subject& one) { amended_to(one, "SN-777"); }),
              ElementsAre(HasSubstr("'SN-777'"))); // the file has the old one still
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
  EXPECT_THAT(objections([](Subject& one) { one.device().issued = "2031-02-03"; }),
              ElementsAre(HasSubstr("2031-02-03, after the measurement")));
  EXPECT_THAT(objections([](Subject& one) { one.device().valid_until = "2026-02-27"; }),
              ElementsAre(HasSubstr("calibrated again by 2026-02-27")));
  EXPECT_THAT(objections([](Subject& one) {
                one.device().issued.clear();
                one.device().valid_until.clear();
              }),
              ElementsAre(HasSubstr("ref.toml does not say when"), HasSubstr("interval_months")));
}

TEST(SubjectObjections, WritesDaysAsTheLanguageDoes) {
  EXPECT_THAT(
      objections([](Subject& one) { one.sensor.received = "2026-03-03"; }, Language::german),
      ElementsAre("der Kalibriergegenstand ging am 03.03.2026 ein, nach der Messung vom "
                  "01.03.2026"));
  EXPECT_THAT(
      objections([](Subject& one) { one.device().valid_until = "2026-02-27"; }, Language::german),
      ElementsAre("„reference“ war bis 27.02.2026 neu zu kalibrieren, vor der Messung vom "
                  "01.03.2026"));
}

TEST(SubjectObjections, NamesWhatTheReferenceDoesNotState) {
  EXPECT_THAT(objections([](Subject& one) {
                one.device().certificate.clear();
                one.reference.traceability.clear();
              }),
              ElementsAre("ref.toml does not state reference.certificate",
                          "ref.toml does not state reference.traceability"));
}

// The amplifier has a certificate as well, and so may other equipment.
TEST(SubjectObjections, HoldsTheDaysOfAllThatIsCalibrated) {
  EXPECT_THAT(objections([](Subject& one) {
                one.reference.devices.push_back(one.device());
                one.reference.devices.back().name = "amplifier";
                one.reference.devices.back().valid_until = "2026-01-01";
              }),
              ElementsAre(HasSubstr("the amplifier was to be calibrated again by 2026-01-01")));
  EXPECT_THAT(objections([](Subject& one) {
                one.laboratory.equipment = {one.device()};
                one.laboratory.equipment.back().name = "thermometer";
                one.laboratory.equipment.back().valid_until = "2026-01-01";
              }),
              ElementsAre(HasSubstr("the thermometer was to be calibrated again")));
  EXPECT_THAT(objections([](Subject& one) {
                one.laboratory.equipment = {one.device()};
                one.laboratory.equipment.back().issued.clear();
                one.laboratory.equipment.back().valid_until.clear();
              }),
              IsEmpty()); // a table needs no certificate
}

TEST(SubjectObjections, NamesTwoReferences) {
  const auto with_laboratory = [](const std::string& serial, const std::string& file) {
    return objections([&](Subject& one) {
      one.laboratory.reference = one.reference;
      one.laboratory.reference->devices.front().serial = serial;
      one.reference.file = file;
    });
  };
  EXPECT_THAT(with_laboratory("1842876", "ref.toml"), IsEmpty());
  EXPECT_THAT(with_laboratory("77", "ref.toml"),
              ElementsAre(HasSubstr("leave its table [reference] out")));
  EXPECT_THAT(with_laboratory("77", ""), IsEmpty()); // it is the one of the laboratory file
}

} // namespace
} // namespace dyncal::inline views
