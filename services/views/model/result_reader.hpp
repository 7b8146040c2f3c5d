// The parts of a result file (result.schema.json) that a model needs, checked key by key.
//
// Fails (bad_file) when the file does not exist, is not JSON, has another schema, or lacks a key;
// the sentence names file and key. Any thread.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/method/repetitions.hpp"
#include "analysis/uncertainty/contribution.hpp"
#include "services/base/byte_count.hpp"
#include "services/base/error.hpp"

namespace dyncal::services {

struct TransferValue { // NaN: null
  std::string channel;
  std::string frequency_text_hz;
  double frequency_hz = 0.0;
  double level_m_s2 = 0.0;
  double magnitude = 0.0;
  double expanded_magnitude = 0.0; // U
  double phase_rad = 0.0;
  double expanded_phase_rad = 0.0;
  double u_independent_phase_rad = 0.0; // U / 2
  std::string unit;
  std::vector<std::string> flag_names;
};

struct SinglePoint { // one repetition
  std::string channel;
  double frequency_hz = 0.0;
  double level_m_s2 = 0.0;
  double magnitude = 0.0;
  double phase_rad = 0.0;
  std::vector<analysis::Contribution> budget;
};

struct ResultContents {
  std::string file;
  std::vector<std::string> channels_that_respond;
  std::vector<TransferValue> values;
  std::vector<SinglePoint> points; // the valid ones
  std::vector<std::pair<std::string, double>> source_rates_hz;
};

[[nodiscard]] Expected<ResultContents> read_result(const std::filesystem::path& path,
                                                   ByteCount& bytes);

} // namespace dyncal::services
