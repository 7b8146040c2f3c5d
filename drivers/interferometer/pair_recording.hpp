// The raw pairs of an interferometer in files beside what is published, for a later evaluation:
// NumPy arrays of two columns, u1 and u2, a new file behind every gap.
//
//   FOLDER/TIME-FIRST.npy    <i2 counts of the channels' resolution where both ranges fit into 16
//                            bits, else <f4 in their unit; TIME: of its begin, in UTC; FIRST:
//                            number of the first pair
//   FOLDER/TIME-FIRST.toml   rate, units of a count, stamp of the first pair
//
// A file is whole at any time: its header tells how many pairs there are, and is written anew when
// it is closed and every 2^20 pairs. What cannot be written ends the recording, with a sentence.
// Belongs to one thread, which it makes wait for the disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/error.hpp"
#include "drivers/sample_block.hpp"

namespace dyncal::drivers::interferometer {

class PairRecording {
public:
  PairRecording(std::filesystem::path folder, const ChannelDescription& u1,
                const ChannelDescription& u2, double rate_hz);
  ~PairRecording();
  PairRecording(PairRecording&&) = default;
  PairRecording& operator=(PairRecording&&) = default;

  // Fails (refused) with file and reason, once.
  [[nodiscard]] Expected<void> add(const SampleBlock& block, std::span<const double> u1,
                                   std::span<const double> u2);
  void begin_session() { close(); }

private:
  [[nodiscard]] Expected<void> open(const SampleBlock& block);
  void write_header();
  void close();
  [[nodiscard]] Expected<void> failed();

  std::filesystem::path folder_;
  std::string unit_;
  double count_1_ = 1.0; // unit of a count
  double count_2_ = 1.0;
  bool is_counts_;
  double rate_hz_;
  std::filesystem::path path_;
  std::ofstream file_;
  std::uint64_t pairs_ = 0; // in the file
  std::uint64_t stated_pairs_ = 0;
  std::optional<std::uint64_t> next_;
  std::vector<char> bytes_;
  bool ended_ = false;
};

} // namespace dyncal::drivers::interferometer
