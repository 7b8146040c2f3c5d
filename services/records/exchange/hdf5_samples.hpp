// The samples of one source on their way into the columns of an HDF5 file: buffered, in the order
// of sessions and numbers.
//
// Functions return false when the library reports an error. REQUIRES: a Hdf5Lock is held.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "services/records/exchange/exported_recording.hpp"
#include "services/records/exchange/hdf5_writing.hpp"

namespace dyncal::inline records {

// Channels that become the rows of one dataset, as the receiver's hierarchy has them:
// acceleration_x, _y, _z of one unit are "Acceleration".
struct Hdf5Quantity {
  std::string name;
  std::vector<std::size_t> channels;
};

[[nodiscard]] std::vector<Hdf5Quantity>
quantities_of(const std::vector<drivers::ChannelDescription>& channels);

// Numbers of runs, from 1; 0: none.
class RunNumbers {
public:
  explicit RunNumbers(std::vector<std::string> names) : names_(std::move(names)) {}
  [[nodiscard]] std::uint32_t operator()(const std::string& name);
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }

private:
  std::vector<std::string> names_;
};

class Hdf5Samples {
public:
  // `place`: RAWDATA or TRIGGERED.
  Hdf5Samples(const ExportedSource& source, hid_t place);

  [[nodiscard]] bool is_open() const { return open_; }
  [[nodiscard]] bool add(const InOrder<wire::SampleBlock>& one);
  [[nodiscard]] bool add(const InOrder<wire::TriggeredRecord>& one, RunNumbers& runs);
  [[nodiscard]] bool flush();

private:
  [[nodiscard]] bool describe(const ExportedSource& source) const;
  [[nodiscard]] bool add_quantities(const ExportedSource& source);
  void add_values(std::span<const double> values, std::size_t samples);
  [[nodiscard]] bool flush_if_full();

  Hdf5Handle group_;
  Hdf5Matrix stamps_;
  Hdf5Matrix uncertainties_;
  Hdf5Matrix numbers_;
  Hdf5Matrix sessions_;
  Hdf5Matrix flags_;
  std::vector<Hdf5Quantity> quantities_;
  std::vector<Hdf5Matrix> values_;
  Hdf5List shots_;
  bool triggered_;
  bool open_ = false;
  std::uint64_t columns_ = 0; // so far
  // Not written yet:
  std::size_t buffered_ = 0; // columns
  std::vector<std::int64_t> stamps_waiting_;
  std::vector<std::uint32_t> uncertainties_waiting_;
  std::vector<std::uint64_t> numbers_waiting_;
  std::vector<std::uint64_t> sessions_waiting_;
  std::vector<std::uint8_t> flags_waiting_;
  std::vector<std::vector<double>> channels_waiting_;
  std::vector<Hdf5Shot> shots_waiting_;
};

} // namespace dyncal::inline records
