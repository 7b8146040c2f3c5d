// `dyncal compare A.json B.json`: do two results agree? E_n of ISO/IEC 17043 for magnitude and
// phase at every frequency that both have.
//
// Compares the transfer functions (means over repetitions) of two result files of dyncal; |E_n| <=
// 1 at k = 2 means that they agree. What both have in common, such as the reference, can be taken
// out of the uncertainties of the difference by its relative standard uncertainty
// (--common-magnitude, --common-phase); without that E_n is too kind to two results that share a
// reference. Prints a table, or JSON. Exit status 1 and one line when a file is not a result or the
// two have nothing in common. Belongs to one thread.
#pragma once

#include <filesystem>
#include <string>

namespace dyncal::inline programs {

struct CompareCommand {
  std::filesystem::path first;
  std::filesystem::path second;
  std::string first_channel;         // empty: every channel by its own name
  std::string second_channel;        // empty: the same as first_channel
  double common_magnitude_rel = 0.0; // standard uncertainty that both results share
  double common_phase_rad = 0.0;
  bool json = false;
};

[[nodiscard]] int run_compare(const CompareCommand& command);

} // namespace dyncal::inline programs
