#include "services/views/live/run_figures.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "services/bus/memory/stepped_clock.hpp"
#include "services/contract/source_description.hpp"
#include "services/evaluation/result/result_messages.hpp"
#include "services/network/bus_state.hpp"
#include "services/views/report/picture_json.hpp"
#include "services/views/report/run_figures.hpp"
#include "tests/unit/services/views/report/example_outcome.hpp"

namespace dyncal::inline views::live {
namespace {

using figures::ErrorBars;
using Json = nlohmann::ordered_json;

constexpr const char* channel = "dau/acceleration_z";

ClockReport clock_of(const std::string& source) {
  ClockReport report{.source = source, .clock = {}};
  report.clock.intervals = 1000;
  report.clock.mean_interval_s = 1e-3;
  report.clock.sd_s = 2e-7;
  report.clock.tick_s = 1e-8;
  for (std::int64_t i = 0; i < 40; ++i) {
    const double interval_ns = 1e6 + 10.0 * static_cast<double>(i);
    report.clock.histogram.push_back({100'000 + i, interval_ns, 25});
    analysis::IntervalBucket bucket;
    bucket.time_s = static_cast<double>(i);
    bucket.minimum_ns = interval_ns - 30;
    bucket.mean_ns = interval_ns;
    bucket.maximum_ns = interval_ns + 30;
    report.clock.over_time.push_back(bucket);
    report.clock.close_up_ns.push_back(interval_ns);
    report.clock.scatter_temperature_degc.push_back(23.0 + 0.1 * static_cast<double>(i));
    report.clock.scatter_interval_ns.push_back(interval_ns);
  }
  return report;
}

// Two repetitions at two frequencies, one of them flagged, on two channels.
RunOutcome finished_run() {
  RunOutcome outcome = tests::example_outcome();
  const std::vector<StepResult> one{outcome.results[0]};
  outcome.results.clear();
  for (std::uint32_t step = 1; step <= 4; ++step) {
    StepResult result = one[0];
    result.step = step;
    result.repetition = (step + 1) / 2;
    result.frequency_text_hz = step % 2 == 1 ? "10" : "20";
    result.frequency_hz = step % 2 == 1 ? 10.0 : 20.0;
    result.magnitude = 1.0 + 1e-4 * step;
    result.u_magnitude = 1e-3 / 3;
    result.unit = R"(\one)";
    result.phase_rad = 3.0 + 0.1 / step;
    result.flags.resize(step == 2 ? 1 : 0);
    result.signals = {{.channel = channel, .residual = 1e-3 / 7 * step}};
    outcome.results.push_back(result);
    result.channel = "dau/angular_velocity_x";
    outcome.results.push_back(result);
  }
  outcome.clock_reports = {clock_of("dau"), clock_of("other")};
  sort_outcome(outcome);
  return outcome;
}

class RunFigures : public testing::Test {
protected:
  void take_results(const RunOutcome& outcome) {
    for (const StepResult& result : outcome.results) {
      laboratory_.take(to_message(*outcome.recipe, result));
    }
  }
  void take_all(const RunOutcome& outcome) {
    take_results(outcome);
    for (const TransferFunction& function : outcome.transfer_functions) {
      laboratory_.take(to_message(*outcome.recipe, function));
    }
    for (const ClockReport& report : outcome.clock_reports) {
      laboratory_.take(to_message(*outcome.recipe, report));
    }
  }
  std::vector<figures::Figure> figures(ErrorBars bars, const std::string& of = channel) {
    const network::Bench& bench = *laboratory_.bench("acc-1");
    return run_figures(bench, bench.runs.at("r1"), of, bars);
  }

  bus::SteppedClock clock_;
  network::BusState laboratory_{clock_};
};

TEST_F(RunFigures, AreThoseOfTheFilesOnceTheRunIsOver) {
  const RunOutcome outcome = finished_run();
  take_all(outcome);
  for (const ErrorBars bars : {ErrorBars::standard, ErrorBars::expanded, ErrorBars::none}) {
    std::vector<figures::Figure> of_files = views::run_figures(outcome, bars);
    std::erase_if(of_files, [](const figures::Figure& figure) {
      return figure.name.ends_with("angular_velocity_x") || figure.name.ends_with("other");
    });
    const std::vector<figures::Figure> live = figures(bars);
    ASSERT_EQ(live.size(), 5U);
    ASSERT_EQ(of_files.size(), 5U);
    for (std::size_t i = 0; i < live.size(); ++i) {
      const std::string text = picture_json(live[i]).dump();
      EXPECT_EQ(text, picture_json(of_files[i]).dump());
      EXPECT_GT(text.size(), 500U) << live[i].name;
      EXPECT_EQ(live[i].svg(), of_files[i].svg());
      EXPECT_EQ(live[i].csv, of_files[i].csv);
    }
  }
}

TEST_F(RunFigures, ShowPlainMeansAndBarsOfRepetitionsWhileTheRunLasts) {
  take_results(finished_run());
  const auto drawn = figures(ErrorBars::expanded);
  ASSERT_EQ(drawn.size(), 2U); // no clock yet
  const auto& magnitudes = drawn[0].picture.panels.at(0).series;
  ASSERT_EQ(magnitudes.size(), 4U); // mean, two repetitions, rings
  EXPECT_EQ(magnitudes[0].label, "mean so far");
  EXPECT_EQ(magnitudes[0].points.at(0).half_bar, 0.0);
  EXPECT_EQ(magnitudes[1].label, "#1 ± U");
  EXPECT_GT(magnitudes[1].points.at(0).half_bar, 1e-3 / 3);
  EXPECT_EQ(magnitudes[2].points.at(1).step, 4U);
  EXPECT_EQ(magnitudes[3].label, "flagged, see below");
  EXPECT_EQ(magnitudes[3].points.at(0).x, 20.0);
  const auto& deviations = drawn[1].picture.panels;
  ASSERT_EQ(deviations.size(), 3U); // with the residuals
  EXPECT_TRUE(deviations[0].band.empty());
  EXPECT_GT(deviations[0].series.at(0).points.at(0).half_bar, 0.0);
  EXPECT_EQ(deviations[2].series.at(1).points.at(0).step, 3U);

  const auto without = figures(ErrorBars::none);
  EXPECT_EQ(without[0].picture.panels[0].series[1].label, "#1");
  EXPECT_EQ(without[0].picture.panels[0].series[1].points[0].half_bar, 0.0);
  EXPECT_EQ(without[1].picture.panels[0].series[0].points[0].half_bar, 0.0);
}

// As the source tells it now: of an earlier run nobody knows it any more.
TEST_F(RunFigures, HaveTheEllipseOfTheCurrentRun) {
  take_all(finished_run());
  drivers::SourceDescription acs;
  acs.quadrature_signals.push_back({.channel = "displacement",
                                    .displacement_per_turn_m = 316e-9,
                                    .radius_u1 = 0.64,
                                    .ellipse_from = "the running signals",
                                    .u_ellipse_rad = {1e-4, 1e-4},
                                    .periodic_error_rad = {1e-4, 1e-4, 1e-4, 1e-3},
                                    .radius_deviation_rel = {1e-3, -1e-3}});
  wire::SourceDescription message = to_message(acs);
  message.bench("acc-1");
  message.source("acs");
  laboratory_.take(message);
  const auto drawn = figures(ErrorBars::standard);
  ASSERT_EQ(drawn.size(), 6U);
  EXPECT_EQ(drawn.back().name, "ellipse-acs-displacement");
  EXPECT_EQ(drawn.back().picture.title.title, "Interferometer of acs/displacement");
  EXPECT_EQ(drawn.back().picture.panels.at(0).series.size(), 4U);
  EXPECT_EQ(drawn.back().picture.panels.at(1).series.back().points.size(), 2U);
  const network::Bench& bench = *laboratory_.bench("acc-1");
  const network::Run earlier = bench.runs.at("r1");
  EXPECT_EQ(run_figures(bench, earlier, channel, ErrorBars::standard).size(), 5U);
}

TEST_F(RunFigures, AreThoseOfAChannelAlsoIfItDoesNotRespond) {
  const RunOutcome outcome = finished_run();
  take_all(outcome);
  const auto drawn = figures(ErrorBars::standard, "dau/angular_velocity_x");
  ASSERT_EQ(drawn.size(), 5U);
  EXPECT_EQ(drawn[0].picture.panels[0].series[0].label, "mean ± u");
  EXPECT_TRUE(figures(ErrorBars::standard, "dau/nothing").empty());
}

} // namespace
} // namespace dyncal::inline views::live
