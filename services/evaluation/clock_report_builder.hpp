// Follows the sample clock of the sensor under calibration through a run and reports on it: paper
// section 3 (direct sample interval evaluation) and section 4.2 (analysis/clock/sample_clock.hpp
// has the definitions).
//
// Relates intervals to the temperature channel of the source if it has one. Without a stated
// uncertainty of its stamps the report is flagged; of a source with a clock of its own, whose rate
// nobody states, the uncertainty of the mean interval is not known (NaN). Where many of its stamps
// are not trusted, the report is of few intervals, and flagged. What was lost is counted by the
// source's record alone. Belongs to one thread.
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

namespace dyncal::inline evaluation {

class ClockReportBuilder {
public:
  ClockReportBuilder(std::string source, const std::optional<ChannelName>& temperature);

  [[nodiscard]] const std::string& source() const { return source_; }

  // A later description of the same source changes nothing.
  void describe(const drivers::SourceDescription& description);
  // A block that the source's record has taken. REQUIRES: its sizes agree.
  void add(const SourceBlock& block);

  [[nodiscard]] const std::optional<BlockPosition>& last_block() const { return last_block_; }

  // Empty when there were too few samples to report on.
  [[nodiscard]] std::vector<ClockReport> reports(std::uint64_t lost) const;

private:
  std::string source_;
  std::optional<std::string> temperature_channel_;
  std::optional<std::size_t> temperature_column_;
  std::optional<analysis::SampleClock> clock_;
  bool has_own_clock_ = false;      // its stamps are not UTC
  bool states_uncertainty_ = false; // of its stamps
  std::optional<BlockPosition> last_block_;
  std::uint64_t samples_ = 0;
  std::uint64_t not_trusted_ = 0;    // of them, by their stamps
  std::vector<std::int64_t> stamps_; // of a block whose stamps follow from a clock
};

} // namespace dyncal::inline evaluation
