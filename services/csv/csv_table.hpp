// A whole CSV file of a recorded series, as fast as the numbers can be read: memory-mapped, parsed in parallel.
//
// First line: names, separated by `,` `;` or tab. The column `t_ns` holds int64 nanoseconds and never passes a double; all
// others hold doubles (std::from_chars: shortest decimals come back bit for bit). An empty field or `nan` is "not measured" and
// becomes NaN. Lines end in LF or CRLF; an empty line is allowed at the end only. The order of stamps is not judged here.
// Memory: 8 bytes a value beside the mapped file. The file must not shrink while it is read.
// Fails (bad_file): unreadable, no `t_ns`, a name twice, or a line that is malformed, as FILE:LINE: problem.
// Starts its threads inside and ends them before it returns; a table may be read by any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "services/error.hpp"

namespace dyncal::services {

class CsvTable {
public:
  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::span<const std::int64_t> stamps_ns() const { return {stamps_ns_.get(), rows_}; }

  // Without `t_ns`, in the order of the file.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  [[nodiscard]] std::span<const double> column(std::size_t index) const { return {columns_[index].get(), rows_}; }
  [[nodiscard]] std::optional<std::size_t> find(std::string_view name) const;

private:
  friend class CsvParser;
  std::size_t rows_ = 0;
  std::vector<std::string> names_;
  std::unique_ptr<std::int64_t[]> stamps_ns_;
  std::vector<std::unique_ptr<double[]>> columns_;
};

// threads 0: as many as the processor has, at most one for every megabyte.
[[nodiscard]] Expected<CsvTable> read_csv(const std::filesystem::path& path, unsigned threads = 0);

// The same of text in memory; `name` stands for the file in errors.
[[nodiscard]] Expected<CsvTable> parse_csv(std::string_view text, const std::string& name, unsigned threads = 0);

} // namespace dyncal::services
