// The samples of some channels of one source in one step, as the evaluations of analysis/method
// take them.
//
// Selects when it is made (record/step_samples.hpp), so make it in the thread that evaluates.
// REQUIRES: the source has the channels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <vector>

#include "analysis/method/transfer_point.hpp"
#include "services/contract/channel_name.hpp"
#include "services/evaluation/record/run_records.hpp"
#include "services/evaluation/record/step_samples.hpp"
#include "services/evaluation/result/step_result.hpp"

namespace dyncal::inline evaluation {

class SelectedChannels {
public:
  // `mains_hz` lives as long as this.
  SelectedChannels(SourceInterval source, std::vector<ChannelName> names,
                   std::span<const double> mains_hz = analysis::usual_mains_hz);

  // Selects again.
  void narrow(const TimeInterval& interval);
  // Copies the samples without those of an interval.
  void leave_out(const TimeInterval& interval);

  [[nodiscard]] bool has(const std::string& channel) const;

  [[nodiscard]] const SourceRecord& record() const { return *source_.record; }
  [[nodiscard]] const TimeInterval& interval() const { return source_.interval; }
  [[nodiscard]] const StepSamples& samples() const { return samples_; }
  [[nodiscard]] std::span<const std::int64_t> stamps_ns() const { return samples_.stamps_ns; }
  [[nodiscard]] std::size_t size() const { return names_.size(); }
  // In the order of the names.
  [[nodiscard]] analysis::ChannelSamples channel(std::size_t i) const;
  [[nodiscard]] std::vector<analysis::ChannelSamples> channels_from(std::size_t first) const;
  [[nodiscard]] const std::string& unit(std::size_t i) const;

  [[nodiscard]] const drivers::ChannelDescription& description(std::size_t i) const {
    return record().description().channels[columns_[i]];
  }

  // Of the time before the step in which nothing was excited; no samples where it is not known.
  [[nodiscard]] StepSamples quiet_samples() const;

  [[nodiscard]] SourceSamples summary() const;

private:
  [[nodiscard]] StepSamples select_rise() const;

  SourceInterval source_;
  std::vector<ChannelName> names_;
  std::vector<std::size_t> columns_;
  StepSamples samples_;
  StepSamples rise_; // before them, from before the excitation began
  std::span<const double> mains_hz_;
};

// SHA-256 over stamps and values of all parts in their order.
[[nodiscard]] std::string digest_of(std::initializer_list<const SelectedChannels*> parts);

// Output per input, as D-SI spells it: "\one" when both are the same, empty where one is not known.
[[nodiscard]] std::string ratio_unit(const std::string& input, const std::string& output);

} // namespace dyncal::inline evaluation
