// Sensors under calibration with stamps of their own (sensors on CAN), on the time scale that links
// them to the reference: what absolute time and a sync recorded beside the sensors have in common.
//
// Each source is selected in the interval of the clock that found the step. What descriptions and
// stamps tell of their uncertainty becomes the offset between the clocks; where nothing is known of
// it, a flag tells. Plain functions, any thread.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "analysis/base/error.hpp"
#include "services/base/error.hpp"
#include "services/evaluation/method/selected_channels.hpp"
#include "services/evaluation/method/step_results.hpp"
#include "services/evaluation/method/step_task.hpp"
#include "services/evaluation/record/run_records.hpp"

namespace dyncal::inline evaluation {

// The samples of every sensor in the step's interval have come, or cannot come any more. `search`
// finds their intervals; without one for the step there is nothing to wait for.
[[nodiscard]] bool sensors_have_sent(const Recipe& recipe, const RunRecords& records,
                                     std::size_t search, std::size_t step);

// The samples of all sensors.
[[nodiscard]] std::vector<SourceInterval>
sensor_intervals(const Recipe& recipe, const RunRecords& records, const TimeInterval& interval);

// The channels under calibration that this sensor has.
[[nodiscard]] SelectedChannels select_dut(const Recipe& recipe, const SourceInterval& sensor);
[[nodiscard]] std::vector<ChannelName> dut_of(const Recipe& recipe, const std::string& source);

// Standard uncertainty of one clock against the other.
[[nodiscard]] double u_clock_offset_s(const SelectedChannels& a, const SelectedChannels& b);
// That of reference and sync against sensor and sync, where both have UTC and say how well; then
// their stamps link them beside sync.
[[nodiscard]] std::optional<double> u_utc_s(const SelectedChannels& acs,
                                            const SelectedChannels& dau);
void flag_unknown_clock(const SelectedChannels& channels, std::vector<Flag>& flags);

// Fails when nothing of the sensor is in the step.
[[nodiscard]] analysis::Expected<void> require_samples(const SelectedChannels& sensor);

// Fails (no_source) with the names of two sources that are not on one time scale: `link` and every
// sensor, as far as they have described themselves.
[[nodiscard]] Expected<void> check_one_time_scale(const Recipe& recipe, const RunRecords& records,
                                                  const std::string& link);

} // namespace dyncal::inline evaluation
