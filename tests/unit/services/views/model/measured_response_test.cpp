#include "services/views/model/measured_response.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/result_text.hpp"
#include "tests/temporary_folder.hpp"

namespace dyncal::inline views {
namespace {

using tests::BudgetRow;
using tests::ResultText;

class MeasuredResponseFile : public testing::Test {
protected:
  tests::TemporaryFolder folder;
  ResultText text{"dau/acceleration"};

  MeasuredResponse read(const ResponseSelection& selection = {}) {
    auto responses = read_responses({text.write(folder.path() / "r.json")}, selection);
    EXPECT_TRUE(responses.has_value()) << responses.error().message;
    return responses ? responses->front() : MeasuredResponse{};
  }
  std::string error() {
    const auto responses = read_responses({text.write(folder.path() / "r.json")}, {});
    return responses ? "" : responses.error().message;
  }
};

BudgetRow reference(double u_magnitude_rel, double u_phase_rad) {
  return {"reference", "common", u_magnitude_rel, u_phase_rad};
}

// What all frequencies have of the reference is common; what one has beyond that is its own.
TEST_F(MeasuredResponseFile, DividesUByTheRowsOfTheBudget) {
  text.add("10", 1.0, {BudgetRow{}, reference(5e-3, 2e-3)});
  text.add("100", {0.0, -2.0}, {BudgetRow{}, reference(5e-3, 2e-3)});
  text.add("200", {0.0, -2.0}, {BudgetRow{}, reference(13e-3, 2e-3)});
  const MeasuredResponse response = read();
  ASSERT_EQ(response.values.size(), 3U);
  EXPECT_TRUE(response.has_budgets);
  EXPECT_NEAR(response.common.gain_rel, 5e-3, 1e-15);
  EXPECT_NEAR(response.common.phase_rad, 2e-3, 1e-12);
  EXPECT_NEAR(response.values[0].point.u_magnitude_rel, 1e-3, 1e-9);
  EXPECT_NEAR(response.values[2].point.u_magnitude_rel, std::hypot(1e-3, 12e-3), 1e-9);
  EXPECT_NEAR(response.values[0].u_magnitude_rel, std::hypot(1e-3, 5e-3), 1e-12);
  EXPECT_NEAR(response.values[1].point.u_phase_rad, 1e-3, 1e-12);
  EXPECT_NEAR(std::arg(response.values[1].point.h), -0.5 * M_PI, 1e-12);
  EXPECT_EQ(response.sample_rate_hz, 1003.0);
}

TEST_F(MeasuredResponseFile, TakesARowThatIsADelayAsOneDelayOfAllFrequencies) {
  for (const char* frequency : {"10", "50", "250"}) {
    const double w = 2.0 * M_PI * std::stod(frequency);
    text.add(frequency, 1.0, {BudgetRow{}, {"adc_phase", "common delay", 0.0, 3e-6 * w}});
  }
  const MeasuredResponse response = read();
  EXPECT_NEAR(response.common.delay_s, 3e-6, 1e-15);
  EXPECT_EQ(response.common.gain_rel, 0.0);
  for (const MeasuredValue& value : response.values) {
    EXPECT_NEAR(value.point.u_phase_rad, 1e-3, 1e-9);
  }
}

TEST_F(MeasuredResponseFile, CountsAllOfUAsItsOwnWithoutBudgets) {
  text.add("10", 1.0, {BudgetRow{}, reference(5e-3, 2e-3)});
  text.add("20", 1.0, {BudgetRow{}, reference(5e-3, 2e-3)});
  text.json()["points"][1]["budget"] = nlohmann::json::array();
  const MeasuredResponse response = read();
  EXPECT_FALSE(response.has_budgets);
  EXPECT_EQ(response.common.gain_rel, 0.0);
  EXPECT_NEAR(response.values[0].point.u_magnitude_rel, std::hypot(1e-3, 5e-3), 1e-12);
  EXPECT_NEAR(response.values[0].point.u_phase_rad, std::hypot(1e-3, 2e-3), 1e-12);
}

TEST_F(MeasuredResponseFile, LeavesOutWhatIsNotKnownOrMayBeWrong) {
  text.add("10", 1.0, {BudgetRow{}}, {"over_range"});
  text.add("20", 1.0, {BudgetRow{}}, {"samples_lost", "adc_not_calibrated"});
  text.add("30", 1.0, {BudgetRow{.u_phase_rad = 0.6}});
  text.add("40", 1.0, {BudgetRow{.u_magnitude_rel = 0.4}});
  text.add("50", 1.0, {BudgetRow{}}, {"not_known_to_this_version"});
  const MeasuredResponse response = read();
  ASSERT_EQ(response.values.size(), 1U);
  EXPECT_EQ(response.values[0].frequency_text_hz, "20");
  ASSERT_EQ(response.left_out.size(), 4U);
  EXPECT_EQ(response.left_out[0].reason, "flag over_range");
  EXPECT_EQ(response.left_out[1].reason, "its u is too large to be of use");
  EXPECT_EQ(response.left_out[3].reason, "flag not_known_to_this_version");
  EXPECT_EQ(read({.channels = {}, .include_flagged = true}).values.size(), 3U);
}

TEST_F(MeasuredResponseFile, NamesTheKeyThatIsWrong) {
  text.add("10", 1.0, {BudgetRow{}});
  text.json()["points"][0]["budget"][0]["u_phase_rad"] = "1";
  EXPECT_NE(error().find("points[0].budget[0].u_phase_rad is a text, not a number or null"),
            std::string::npos);
  text.json()["points"][0]["budget"][0]["u_phase_rad"] = 1e-3;
  text.json()["points"][0]["budget"][0]["repeats"] = "now and then";
  EXPECT_NE(error().find("repeats is \"now and then\", which this version does not know"),
            std::string::npos);
  text.json()["points"][0]["budget"][0]["repeats"] = "anew";
  text.json()["transfer_function"][0]["flag_names"] = {1};
  EXPECT_NE(error().find("transfer_function[0].flag_names[0] is 1, not a text"), std::string::npos);
  text.json()["transfer_function"] = 1;
  EXPECT_NE(error().find("transfer_function is 1, not a list"), std::string::npos);
  text.json() = nlohmann::json::array();
  EXPECT_NE(error().find("there is no 'schema' in it"), std::string::npos);
}

TEST_F(MeasuredResponseFile, NeedsAChannelThatResponds) {
  text.add("10", 1.0, {BudgetRow{}});
  text.json()["channels"][0]["responds"] = false;
  EXPECT_NE(error().find("no channel responds"), std::string::npos);
  EXPECT_EQ(read({.channels = {"dau/acceleration"}}).values.size(), 1U);
}

} // namespace
} // namespace dyncal::inline views
