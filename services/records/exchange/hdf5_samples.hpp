// The samples of one source on their way into the columns of an HDF5 file: buffered, in the order
// of sessions and numbers.
//
// Functions return false when the library reports an error. REQUIRES: a Hdf5Lock is held.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "services/records/exchange/hdf5_writing.hpp"
#include "services/records/exchange/row_table.hpp"

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
  // `place`: RAWDATA or TRIGGERED. `table`: with all channels of its source; outlives the object.
  Hdf5Samples(const RowTable& table, hid_t place);

  [[nodiscard]] bool is_open() const { return open_; }
  [[nodiscard]] bool add(const Rows& rows);
  // Of the rows that are added next.
  void add_shot(const wire::TriggeredRecord& record, RunNumbers& runs);
  [[nodiscard]] bool flush();

private:
  struct Dataset {
    std::vector<std::size_t> columns; // of the table, each a row of the matrix
    Hdf5Matrix matrix;
  };

  [[nodiscard]] bool describe() const;
  [[nodiscard]] bool add_stamps();
  [[nodiscard]] bool add_quantity(const Hdf5Quantity& quantity);
  hid_t add_dataset(const std::string& name, hid_t type, std::vector<std::size_t> columns);

  const RowTable& table_;
  Hdf5Handle group_;
  std::vector<Dataset> datasets_;
  Hdf5List shots_;
  bool open_ = false;
  std::uint64_t columns_ = 0; // so far
  // Not written yet:
  std::size_t buffered_ = 0;
  std::vector<ColumnValues> waiting_; // as the table has them
  std::string shots_waiting_;
  std::uint64_t shot_count_ = 0;
};

} // namespace dyncal::inline records
