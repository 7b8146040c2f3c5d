// What came of a run: the plan as it was published last, and everything the analysis published of
// it. Plain data.
#pragma once

#include <string>
#include <vector>

#include "idl/dyncal.h"

namespace dyncal::services {

struct RunOutcome {
  wire::Measurement measurement;
  std::string analysis_dds;
  std::vector<wire::CalibrationResult> results; // in the order of steps, then as published
  std::vector<wire::TransferFunction> transfer_functions;
  std::vector<wire::SampleClockReport> clock_reports;
  bool interrupted = false;
  std::string problem; // why the run ended early, "" when it did not
};

} // namespace dyncal::services
