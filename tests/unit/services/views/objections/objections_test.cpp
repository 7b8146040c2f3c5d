#include "services/views/objections/objections.hpp"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>

#include "services/views/language/translated_texts.hpp"

namespace dyncal::inline views {
namespace {

using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const std::string channel = "dau/acceleration_z";

std::vector<std::string> objections_in(Language language, const StoredResult& result,
                                       const std::vector<std::string>& channels = {channel}) {
  return texts_in(language, objections_to(result, channels));
}

std::vector<std::string> english(const StoredResult& result,
                                 const std::vector<std::string>& channels = {channel}) {
  return objections_in(Language::english, result, channels);
}

StoredValue value_at(const std::string& frequency) {
  StoredValue value;
  value.channel = channel;
  value.frequency_text_hz = frequency;
  value.frequency_hz = std::stod(frequency);
  value.magnitude = 1.0;
  value.of_magnitude = {.u = 0.001, .k = 2.0, .expanded = 0.002};
  value.of_phase = {.u = 0.001, .k = 2.0, .expanded = 0.002};
  value.coverage_probability = 0.9545;
  value.unit = R"(\one)";
  return value;
}

StoredPoint point_at(const std::string& frequency, unsigned step) {
  StoredPoint point;
  point.channel = channel;
  point.frequency_text_hz = frequency;
  point.frequency_hz = std::stod(frequency);
  point.step = step;
  point.repetition = 1;
  point.valid = true;
  return point;
}

StoredResult whole_run() {
  StoredResult result;
  result.planned_steps = 2;
  result.channels.push_back({channel, R"(\one)", true, 0, {}, {}, {}});
  result.values = {value_at("10"), value_at("20")};
  result.points = {point_at("10", 1), point_at("20", 2)};
  return result;
}

TEST(Objections, NoneToAWholeRun) {
  EXPECT_THAT(english(whole_run()), IsEmpty());
  EXPECT_THAT(stated_flags(whole_run(), {channel}), IsEmpty());
}

TEST(Objections, ToLossThatNothingExplains) {
  StoredResult result = whole_run();
  result.points[1].lost = 7;
  EXPECT_THAT(english(result),
              ElementsAre(HasSubstr("at 20 Hz, repetition 1: 7 samples were lost")));
  result.points[1].flag_names = {"shots_missing"};
  EXPECT_THAT(english(result), IsEmpty());
  result.points[1].flag_names = {"samples_lost"};
  EXPECT_THAT(english(result), ElementsAre(HasSubstr("flag samples_lost")));
}

TEST(Objections, ToFlagsOfValuesResultsAndChannels) {
  StoredResult result = whole_run();
  result.values[0].flag_names = {"over_range"};
  result.points[1].flag_names = {"over_range", "shots_missing"};
  EXPECT_THAT(english(result), ElementsAre(HasSubstr("at 10 Hz, 20 Hz: flag over_range")));
  EXPECT_THAT(stated_flags(result, {channel}),
              ElementsAre(Field(&TranslatedText::english, HasSubstr("shots_missing"))));
  result.channels[0].flag_names = {"over_range"};
  EXPECT_THAT(english(result), ElementsAre(HasSubstr("at all frequencies")));
  EXPECT_THAT(english(result, {"dau/other"}), SizeIs(1)); // which has no value at all
}

// A result of `dyncal run` on that bench says when the check was, or why it was left out.
TEST(Objections, ToAResultWithoutTheCheckThatItsBenchDemands) {
  StoredResult result = whole_run();
  result.recipe = "bench = \"b\"\n[check]\nsensor = \"SN-1\"\nmax_age_h = 24\n";
  EXPECT_THAT(english(result), ElementsAre(HasSubstr("demands a check with sensor 'SN-1'")));
  result.check = DailyCheck{
      .sensor = "SN-1", .run = {}, .began_utc = {}, .state = {}, .left_out = "it is away"};
  EXPECT_THAT(english(result), IsEmpty());
}

TEST(Objections, ToRunsThatAreNotWhole) {
  StoredResult result = whole_run();
  result.interrupted = true;
  result.problem = "the cable was pulled";
  result.points[1].valid = false;
  result.points[1].problem = "no steady sine";
  result.values[1].of_phase.expanded = 0.0;
  EXPECT_THAT(english(result),
              ElementsAre("the run was interrupted", HasSubstr("the cable was pulled"),
                          HasSubstr("no steady sine"), HasSubstr("1 of 2 planned steps"),
                          HasSubstr("20 Hz: the result has no value with a usable U")));
}

// What the evaluation says stands in the result file alone; what is known beside it, in German.
TEST(Objections, AreInGermanAsWell) {
  StoredResult result = whole_run();
  result.problem = "the cable was pulled";
  result.points[1].valid = false;
  result.points[1].problem = "dau/acceleration_z is over its range";
  const std::string first = "dau/acceleration_z: 1 Einzelergebnisse haben keinen Wert; das erste "
                            "bei 20 Hz, Wiederholung 1: ";
  const std::string steps = "dau/acceleration_z: 1 von 2 geplanten Schritten haben einen Wert";
  EXPECT_THAT(objections_in(Language::german, result),
              ElementsAre("der Messlauf endete vorzeitig: den Grund nennt die Ergebnisdatei",
                          first + "den Grund nennt die Ergebnisdatei", steps));
  result.points[1].flag_names = {"over_range", "adc_not_calibrated"};
  EXPECT_THAT(objections_in(Language::german, result),
              ElementsAre(HasSubstr("vorzeitig"),
                          first + "Abtastwerte liegen an einem Ende des Messbereichs, wo der Sinus "
                                  "abgeschnitten wird.",
                          steps));
}

TEST(Objections, NameWhatIsOpenWithItsNumbers) {
  StoredResult result = whole_run();
  result.channels[0].closures.push_back({.kind = ClosureKind::phase_at_zero,
                                         .subject = channel,
                                         .verdict = Verdict::open,
                                         .value = 0.25,
                                         .u = 0.01,
                                         .limit = 0.1,
                                         .unit = "rad",
                                         .sentence = "the phase is far from 0"});
  EXPECT_THAT(english(result), ElementsAre("closure open: dau/acceleration_z: phase towards 0 Hz: "
                                           "the phase is far from 0"));
  EXPECT_THAT(objections_in(Language::german, result),
              ElementsAre("Gegenprobe stimmt nicht: dau/acceleration_z: Phase gegen 0 Hz: gefunden "
                          "0,25 rad, Grenze 0,1 rad"));
}

} // namespace
} // namespace dyncal::inline views
