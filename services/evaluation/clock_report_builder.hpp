// Follows the sample clock of the sensor under calibration through a run and reports on it: paper
// section 3 (direct sample interval evaluation) and section 4.2 (analysis/clock/sample_clock.hpp
// has the definitions).
//
// Takes the blocks of the source whose stamps tell of it, relates intervals to its temperature
// channel if it has one. What was lost is counted by the source's record alone. Belongs to one
// thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analysis/clock/sample_clock.hpp"
#include "drivers/sample_block.hpp"
#include "services/contract/channel_name.hpp"
#include "services/contract/source_block.hpp"
#include "services/evaluation/result/clock_report.hpp"

namespace dyncal::services {

class ClockReportBuilder {
public:
  ClockReportBuilder(std::string source, const std::optional<ChannelName>& temperature);

  [[nodiscard]] const std::string& source() const { return source_; }

  // A later description of the same source changes nothing.
  void describe(const drivers::SourceDescription& description);
  // A block that the source's record has taken. REQUIRES: its sizes agree.
  void add(const SourceBlock& block);

  // Empty when there were too few samples to report on.
  [[nodiscard]] std::vector<ClockReport> reports(std::uint64_t lost) const;

private:
  std::string source_;
  std::optional<std::string> temperature_channel_;
  std::optional<std::size_t> temperature_column_;
  std::optional<analysis::SampleClock> clock_;
};

} // namespace dyncal::services
