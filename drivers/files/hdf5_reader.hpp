// Reads the samples of one sensor out of an HDF5 file of the public SmartUp receiver, or of
// `dyncal export`, a stretch at a time; README.md has the layout, every error names file and place.
//
// The settings name the sensor's group where the file has several. Zeros with which the receiver
// fills up its last stretch are not samples. Its uncertainties are four standard uncertainties
// unless the file says otherwise. Sample numbers count on over the end of 32 bits. The library is
// locked while it is used (hdf5_library.hpp); one thread for each reader.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/files/file_source.hpp"
#include "drivers/files/hdf5_library.hpp"
#include "drivers/files/stamp_order.hpp"

namespace dyncal::drivers::files {

class Hdf5Reader : public SampleReader {
public:
  // Fails (not_found, malformed) as every file source does.
  [[nodiscard]] static Expected<std::unique_ptr<Hdf5Reader>> open(const FileSettings& settings);
  ~Hdf5Reader() override;

  [[nodiscard]] const SourceDescription& description() const override { return description_; }
  [[nodiscard]] Expected<SampleBlock> read(std::size_t samples) override;
  [[nodiscard]] double share_read() const override;

private:
  struct Quantity { // a dataset with channels as rows
    std::string name;
    Hdf5Handle dataset;
    std::size_t rows = 0;
    bool is_list = false; // one dimension
  };

  explicit Hdf5Reader(const FileSettings& settings) : settings_(settings) {}
  [[nodiscard]] Expected<void> open_file();
  [[nodiscard]] Expected<std::string> group_name() const;
  [[nodiscard]] Expected<void> open_quantities();
  [[nodiscard]] Expected<void> describe();
  [[nodiscard]] Expected<void> find_end();
  [[nodiscard]] Expected<Quantity> open_dataset(const std::string& name) const;
  // Numbers [row_, row_ + samples) of every row.
  template <class Number>
  [[nodiscard]] Expected<std::vector<Number>>
  numbers(const Quantity& quantity, hid_t type, std::uint64_t first, std::size_t samples) const;
  // Sample numbers, counted on; cuts the block where they jump.
  [[nodiscard]] Expected<void> number(SampleBlock& block);
  [[nodiscard]] tl::unexpected<Error> malformed(const std::string& problem) const;

  FileSettings settings_;
  Hdf5Handle file_;
  Hdf5Handle group_;
  std::string place_; // of the group
  Quantity stamps_;
  Quantity uncertainties_;
  Quantity numbers_;
  std::optional<Quantity> flags_; // of dyncal's files
  bool has_standard_uncertainties_ = false;
  std::vector<Quantity> quantities_;
  std::uint64_t columns_ = 0;
  std::uint64_t end_ = 0; // before the zeros at the end
  std::uint64_t row_ = 0; // the next sample's place
  SourceDescription description_;
  std::optional<std::uint64_t> last_sample_; // unwrapped
  StampOrder order_;
};

} // namespace dyncal::drivers::files
