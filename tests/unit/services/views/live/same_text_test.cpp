// Page, terminal, report, certificate and CSV show the same text for the same value and u: 10 000
// drawn pairs, half of them ties, which a second rule of rounding would send another way.
#include <cmath>
#include <cstdlib>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "services/base/rounding.hpp"
#include "services/views/figures/transfer_function.hpp"
#include "services/views/live/run_json.hpp"
#include "services/views/report/result_json.hpp"
#include "services/views/report/result_table.hpp"
#include "services/views/report/stated_value.hpp"
#include "services/views/report/transfer_data.hpp"

namespace dyncal::inline views::live {
namespace {

using Json = nlohmann::ordered_json;
using Texts = std::vector<std::string>; // value, u, phase, u of phase

constexpr int runs = 20;
constexpr unsigned values_of_a_run = 500;
const std::string channel = "dau/z";

unsigned seed() {
  const char* given = std::getenv("DYNCAL_TEST_SEED");
  return given == nullptr ? 20261126U : static_cast<unsigned>(std::atoi(given));
}

// u of two digits at some place, and a value of which half end in a five one place further.
struct Pair {
  double value = 0.0;
  double u = 0.0;
};

Pair draw(std::mt19937& random, int low_place, int high_place, int max_multiple) {
  const auto between = [&](int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random);
  };
  const double unit = std::pow(10.0, between(low_place, high_place));
  const int digits = between(10, 99);
  const double beyond =
      between(0, 1) == 0 ? 0.5 : std::uniform_real_distribution<double>(0.0, 1.0)(random);
  const double u_beyond = between(0, 1) == 0 ? 0.5 : 0.0;
  return {(between(4 * digits, max_multiple) + beyond) * unit, (digits + u_beyond) * unit};
}

struct Drawn {
  network::Run run;
  RunOutcome outcome;
};

Drawn drawn_run(std::mt19937& random) {
  Drawn drawn;
  TransferFunction function;
  function.channel = channel;
  for (unsigned i = 1; i <= values_of_a_run; ++i) {
    const Pair magnitude = draw(random, -9, 6, 9'999);
    const Pair phase = draw(random, -7, -4, 31'000);
    StepResult result;
    result.channel = channel;
    result.step = i;
    result.repetition = 1;
    result.frequency_hz = i;
    result.frequency_text_hz = std::to_string(i);
    result.valid = true;
    result.magnitude = magnitude.value;
    result.u_magnitude = magnitude.u;
    result.phase_rad = phase.value;
    result.u_phase_rad = phase.u;
    FrequencyPoint point{.frequency_text_hz = result.frequency_text_hz,
                         .frequency_hz = result.frequency_hz,
                         .level_m_s2 = 0.0,
                         .mean = {},
                         .unwrapped_phase_rad = phase.value - 6.283185307179586};
    point.mean.magnitude = magnitude.value;
    point.mean.u_magnitude = magnitude.u;
    point.mean.phase_rad = phase.value;
    point.mean.u_phase_rad = phase.u;
    function.points.push_back(point);
    drawn.run.results[{i, 1, channel}] = result;
    drawn.outcome.results.push_back(result);
  }
  drawn.run.name = "r1";
  drawn.run.transfer_functions[channel] = function;
  drawn.outcome.transfer_functions = {function};
  return drawn;
}

Texts of_page(const Json& text) {
  return {text["magnitude"]["value"], text["magnitude"]["u"], text["phase_rad"]["value"],
          text["phase_rad"]["u"]};
}

std::vector<std::string> split(const std::string& line, char separator) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, separator);) {
    if (separator != ' ' || !cell.empty()) {
      cells.push_back(cell);
    }
  }
  return cells;
}

// Of the lines whose first cell is `first`, or a number of the rows.
std::vector<Texts> rows_of(const std::string& text, char separator, std::size_t columns,
                           const std::string& first, std::size_t at) {
  std::vector<Texts> rows;
  for (const std::string& line : split(text, '\n')) {
    const auto cells = split(line, separator);
    const bool is_row = cells.size() >= columns &&
                        (first.empty() ? std::atoi(cells[0].c_str()) > 0 : cells[0] == first);
    if (is_row) {
      rows.emplace_back(cells.begin() + static_cast<std::ptrdiff_t>(at),
                        cells.begin() + static_cast<std::ptrdiff_t>(at) + 4);
    }
  }
  return rows;
}

TEST(SameText, OnPageTerminalReportCertificateAndInCsv) {
  std::mt19937 random(seed());
  std::size_t compared = 0;
  for (int i = 0; i < runs; ++i) {
    const Drawn drawn = drawn_run(random);
    const Json page = run_json(network::Bench{}, drawn.run);
    const StoredResult stored = stored_result_of(drawn.outcome);
    const auto terminal = rows_of(result_table(drawn.outcome), ' ', 6, "", 1);
    const auto csv = figures::transfer_function_figure(
                         transfer_data(drawn.outcome, drawn.outcome.transfer_functions.front()), "")
                         .csv;
    const auto repetitions = rows_of(csv, ',', 13, "1", 9);
    const auto means = rows_of(csv, ',', 13, "mean", 9);
    ASSERT_EQ(page["points"].size(), values_of_a_run);
    ASSERT_EQ(page["transfer_function"].size(), values_of_a_run);
    ASSERT_EQ(terminal.size(), values_of_a_run);
    ASSERT_EQ(repetitions.size(), values_of_a_run);
    ASSERT_EQ(means.size(), values_of_a_run);
    for (std::size_t j = 0; j < values_of_a_run; ++j) {
      const StepResult& result = drawn.outcome.results[j];
      const RoundedValue magnitude = round_by_uncertainty(result.magnitude, result.u_magnitude);
      const RoundedValue phase = round_phase(result.phase_rad, result.u_phase_rad).radians;
      const Texts by_u{magnitude.value, magnitude.u, phase.value, phase.u};
      EXPECT_EQ(of_page(page["points"][j]["text"]), by_u) << result.magnitude;
      EXPECT_EQ(terminal[j], by_u) << result.magnitude;
      EXPECT_EQ(repetitions[j], by_u) << result.magnitude;
      const StatedValue stated = stated_magnitude(stored.values[j]);
      const StatedValue stated_phase = stated_phase_rad(stored.values[j]);
      const Texts by_expanded{stated.value, stated.expanded, stated_phase.value,
                              stated_phase.expanded};
      EXPECT_EQ(of_page(page["transfer_function"][j]["text"]), by_expanded) << result.magnitude;
      EXPECT_EQ(means[j], by_expanded) << result.magnitude;
      ++compared;
    }
  }
  EXPECT_EQ(compared, 10'000U);
}

} // namespace
} // namespace dyncal::inline views::live
