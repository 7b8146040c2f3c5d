// The messages of one source, made again from the columns of an HDF5 file (hdf5_samples.hpp wrote
// them).
//
// Fails with the problem alone, for the caller to say in which file. REQUIRES: a Hdf5Lock is held.
#pragma once

#include <string>
#include <vector>

#include "services/error.hpp"
#include "services/exchange/hdf5_reading.hpp"

namespace dyncal::services {

class Hdf5Columns {
public:
  template <class T>
  using Result = tl::expected<T, std::string>;

  // `name`: of its group in RAWDATA or TRIGGERED.
  [[nodiscard]] static Result<Hdf5Columns> open(hid_t file, const std::string& name);

  // The bytes of the message of this row of its blocks or shots. `runs`: names by their numbers.
  [[nodiscard]] Result<std::string> message(std::uint64_t row,
                                            const std::vector<std::string>& runs);

private:
  struct ChannelPlace {
    std::size_t quantity = 0;
    std::uint64_t row = 0;
  };

  Hdf5Columns(hid_t group, hid_t rows_place, const std::string& rows_name, bool triggered);
  [[nodiscard]] Result<void> find_channels(hid_t group);
  [[nodiscard]] Result<std::string> block(std::uint64_t row, const std::vector<std::string>& runs);
  [[nodiscard]] Result<std::string> record(std::uint64_t row, const std::vector<std::string>& runs);
  [[nodiscard]] Result<std::vector<double>> values(std::uint64_t first, std::uint64_t count);

  std::string bench_;
  std::string source_;
  bool triggered_;
  Hdf5Window rows_;
  std::vector<Hdf5Window> times_; // stamps, uncertainties, flags; of samples alone
  std::vector<Hdf5Window> quantities_;
  std::vector<ChannelPlace> channels_; // in the order of the blocks
};

} // namespace dyncal::services
