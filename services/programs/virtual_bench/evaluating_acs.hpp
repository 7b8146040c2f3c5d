// The virtual bench's analogue calibration system as one that evaluates its own samples: it writes
// the table of drivers/tables (ptb-csv, deviations of two standard uncertainties), a row at the end
// of every excitation, with sync less reference as its phase.
//
// A row is of all samples from `settling_s` after the output was switched on, or set anew, to when
// it is switched off; shorter excitations than `least_s`, and those of several lines, have none.
// The rows of a loop end where a frequency comes again. Belongs to the bench's thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <vector>

#include "drivers/virtual_bench/model/virtual_bench.hpp"
#include "services/base/error.hpp"

namespace dyncal::inline programs::virtual_bench {

class EvaluatingAcs {
public:
  static constexpr double settling_s = 0.3;
  static constexpr double least_s = 0.5; // behind that

  // Fails (bad_file) where the table cannot be written; what was there is gone. `acs` outlives the
  // object.
  [[nodiscard]] static Expected<EvaluatingAcs>
  open(const drivers::virtual_bench::AcsInstrument& acs, const std::filesystem::path& table);

  // What it has sampled; those that it was given already are passed over.
  void take(const drivers::virtual_bench::AcsSamples& samples,
            const drivers::virtual_bench::Drive& drive);

private:
  EvaluatingAcs(const drivers::virtual_bench::AcsInstrument& acs, std::ofstream table)
      : acs_(acs), table_(std::move(table)) {}
  void write_row();

  const drivers::virtual_bench::AcsInstrument& acs_;
  std::ofstream table_;
  drivers::virtual_bench::Drive drive_; // that the samples are of
  std::uint64_t next_sample_ = 0;
  std::vector<std::int64_t> stamps_ns_; // of the excitation, with its settling
  std::vector<double> reference_;
  std::vector<double> sync_;
  int loop_ = 0;
  std::set<double> frequencies_hz_; // of the loop
};

} // namespace dyncal::inline programs::virtual_bench
