#include "services/views/lab_file/documented_conditions.hpp"

#include <gmock/gmock.h>

namespace dyncal::inline views {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Conditions typed() {
  Conditions conditions;
  conditions.temperature_degc = MeasuredCondition{20.0, 2.0};
  conditions.humidity_percent = MeasuredCondition{50.0, 10.0};
  conditions.mounting = "screwed";
  return conditions;
}

LoggedCondition temperature(std::uint64_t count) {
  return {.quantity = "temperature",
          .unit = "degC",
          .source = "file room.csv",
          .count = count,
          .minimum = 23.0,
          .mean = 23.1,
          .maximum = 23.0,
          .expanded = 0.3,
          .problem = count == 0 ? "no such file" : ""};
}

JournalEntry amendment(const std::string& key, const std::string& value) {
  return {JournalKind::amendment,
          "2026-03-02T00:00:00.000000000Z",
          {"A. Meter", "meter", "lab3"},
          "misread",
          {{key, "", value}}};
}

std::vector<std::string> english(const std::vector<TranslatedText>& texts) {
  std::vector<std::string> all;
  for (const TranslatedText& text : texts) {
    EXPECT_FALSE(text.german.empty());
    all.push_back(text.english);
  }
  return all;
}

TEST(DocumentedConditions, AreThoseThatWereTypedAndSaySo) {
  const auto documented = documented_conditions({}, typed());
  EXPECT_EQ(documented.conditions.temperature_degc->value, 20.0);
  EXPECT_THAT(english(documented.origins),
              ElementsAre("Entered by hand, not measured over the run: temperature, humidity."));
  EXPECT_THAT(english(documented_conditions({}, {}).origins), IsEmpty());
}

TEST(DocumentedConditions, AreMeasuredWhereALoggerDidSo) {
  StoredResult result;
  result.conditions = {temperature(12)};
  const auto documented = documented_conditions(result, typed());
  EXPECT_EQ(documented.conditions.temperature_degc->value, 23.1);
  EXPECT_EQ(documented.conditions.temperature_degc->expanded, 0.3);
  EXPECT_EQ(documented.conditions.humidity_percent->value, 50.0);
  EXPECT_THAT(english(documented.origins),
              ElementsAre(HasSubstr("measured over the run by file room.csv: 23 to 23 degC, mean "
                                    "23.1 degC, 12 readings"),
                          HasSubstr("not measured over the run: humidity.")));
}

TEST(DocumentedConditions, SayThatALoggerGaveNothing) {
  StoredResult result;
  result.conditions = {temperature(0)};
  const auto documented = documented_conditions(result, typed());
  EXPECT_EQ(documented.conditions.temperature_degc->value, 20.0);
  EXPECT_THAT(english(documented.origins),
              ElementsAre(HasSubstr("no such file"), HasSubstr("temperature, humidity.")));
}

TEST(DocumentedConditions, AreCorrectedByAmendments) {
  StoredResult result;
  result.conditions = {temperature(12)};
  result.journal = {amendment("temperature_degc", "22.5"), amendment("mounting", "glued")};
  const auto documented = documented_conditions(result, typed());
  EXPECT_EQ(documented.conditions.temperature_degc->value, 22.5);
  EXPECT_EQ(documented.conditions.temperature_degc->expanded, 0.3);
  EXPECT_EQ(documented.conditions.mounting, "glued");
  EXPECT_THAT(english(documented.origins),
              testing::Contains(HasSubstr("temperature is as it was corrected")));
  SensorFile sensor;
  amend({amendment("owner_identification", "7")}, sensor);
  EXPECT_EQ(sensor.owner_identification, "7");
  Contact customer;
  amend({amendment("customer", "Other")}, customer);
  EXPECT_EQ(customer.name, "Other");
}

} // namespace
} // namespace dyncal::inline views
