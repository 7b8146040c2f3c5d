// Follows the sample clock of the sensor under calibration through a run and reports on it: paper
// section 3 (direct sample interval evaluation) and section 4.2 (analysis/clock/sample_clock.hpp
// has the definitions).
//
// Takes the blocks of the DAU source as they come, relates intervals to the temperature channel if
// the recipe names one of the same source. Belongs to one thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/clock/sample_clock.hpp"
#include "idl/dyncal.h"
#include "services/contract/sample_continuity.hpp"
#include "services/evaluation/recipe.hpp"

namespace dyncal::services {

class ClockReportBuilder {
public:
  explicit ClockReportBuilder(const Recipe& recipe);

  void describe(const wire::SourceDescription& description);
  void add(const wire::SampleBlock& block);

  // Empty when there were too few samples to say anything.
  [[nodiscard]] std::vector<wire::SampleClockReport> reports() const;

private:
  std::string bench_;
  std::string run_;
  std::string source_;
  std::optional<std::string> temperature_channel_;
  std::optional<std::size_t> temperature_column_;
  bus::SampleContinuity continuity_;
  std::optional<analysis::SampleClock> clock_;
};

} // namespace dyncal::services
