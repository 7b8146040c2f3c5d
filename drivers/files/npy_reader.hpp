// Reads the samples of a NumPy file with a structured array (numpy.save of rows with named fields);
// README.md has the format.
//
// The file is mapped into memory and its numbers are copied as they are, so it is read as fast as
// the disk or the memory delivers it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/files/file_source.hpp"
#include "drivers/files/mapped_file.hpp"
#include "drivers/files/npy_header.hpp"
#include "drivers/files/stamp_order.hpp"

namespace dyncal::drivers::files {

class NpyReader : public SampleReader {
public:
  // Fails (not_found, malformed, invalid_setting) as every file source does.
  [[nodiscard]] static Expected<std::unique_ptr<NpyReader>> open(const FileSettings& settings);

  [[nodiscard]] const SourceDescription& description() const override { return description_; }
  [[nodiscard]] Expected<SampleBlock> read(std::size_t samples) override;
  [[nodiscard]] double share_read() const override;

private:
  NpyReader(const FileSettings& settings, MappedFile file)
      : settings_(settings), file_(std::move(file)) {}
  Expected<void> name_fields();
  [[nodiscard]] tl::unexpected<Error> malformed(const std::string& problem) const;
  template <class Number>
  void copy(const NpyField& field, std::size_t rows, Number* to) const;
  [[nodiscard]] Expected<void> check_numbers(const std::vector<std::uint64_t>& numbers) const;

  FileSettings settings_;
  MappedFile file_;
  NpyHeader header_;
  std::optional<NpyField> time_;
  std::optional<NpyField> number_;
  std::vector<NpyField> channels_;
  SourceDescription description_;
  std::size_t row_ = 0; // the next one
  StampOrder order_;
  std::uint64_t next_sample_ = 0;
};

} // namespace dyncal::drivers::files
