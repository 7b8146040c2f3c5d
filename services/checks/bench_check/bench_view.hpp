// What is known of a bench without its instruments: the bench file with everything that is wrong in
// it, and of each source what files tell of it: a recorded series by its first samples, a sensor
// on CAN by its DBC file; and the calibration of the sync ADC. Instruments are not asked. Plain
// data once it was made.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "analysis/instrument/adc_calibration.hpp"
#include "drivers/sample_block.hpp"
#include "services/base/finding.hpp"
#include "services/bench/file/bench_file.hpp"
#include "services/checks/bench_check/key_lines.hpp"

namespace dyncal::inline checks::bench_check {

// A message of a sensor on CAN.
struct CanMessage {
  std::string name;
  std::uint32_t id = 0;
};

struct SourceView {
  std::string name;
  std::optional<drivers::SourceDescription> description; // nothing: only the instrument knows
  double rate_hz = 0.0;                                  // 0: not known
  std::string rate_origin;                               // "as its first samples show"
  std::vector<CanMessage> messages;
  std::optional<std::string> problem; // why its files cannot be used
  std::string problem_key;            // of the source: "path", "dbc"
  std::vector<std::string> warnings;  // of the same file, which can be used all the same
};

struct BenchView {
  BenchFile bench;
  BenchProblems problems;
  KeyLines lines;
  std::vector<SourceView> sources; // in the order of bench.sources
  std::vector<analysis::AdcCalibrationPoint> adc;
  std::optional<std::string> adc_problem; // why the file of corrections.adc cannot be used

  [[nodiscard]] const SourceView* source(const std::string& name) const;
  // The reader of the file refused the key: nothing follows from its value.
  [[nodiscard]] bool refused(const std::string& key) const;
  // A finding at a key, with its line.
  [[nodiscard]] Finding at(Severity severity, const KeyPath& key, std::string sentence,
                           std::optional<std::size_t> entry = std::nullopt) const;
};

// A file that cannot be read is a problem.
[[nodiscard]] BenchView look_at_bench(const std::filesystem::path& path);
[[nodiscard]] BenchView look_at_bench_text(const std::string& text,
                                           const std::filesystem::path& path);

} // namespace dyncal::inline checks::bench_check
