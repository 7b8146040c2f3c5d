// The samples of a source as rows with named columns, for formats that know nothing but tables.
//
// Of samples: t_ns (time of the sample in the time base of its source), sample_number, session
// (counted from 1), lost_before (samples that are missing before this one), stamp_uncertainty_ns
// (standard uncertainty; 0: not known), stamp_flags (drivers/sample_block.hpp), then the channels.
// Of records of shots: t_ns of the sample by the trigger's time, t_s (after the trigger), session,
// shot, run (counted from 1, in the order of their names), step, attempt, then the channels. Not
// measured is NaN. Plain data; any thread.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "services/records/exchange/exported_recording.hpp"

namespace dyncal::inline records {

using ColumnValues =
    std::variant<std::vector<std::int64_t>, std::vector<std::uint64_t>, std::vector<double>>;

struct RowColumn {
  std::string name;
  std::string unit;    // "": a number, or not known
  ColumnValues none{}; // of the type that its values have
  bool is_channel = false;
};

struct Rows {
  std::size_t count = 0;
  std::size_t session = 0;
  std::int64_t received_utc_ns = 0;
  std::vector<ColumnValues> columns; // as columns() has them
};

class RowTable {
public:
  // Both outlive the object. `channels`: indices of those that are wanted.
  RowTable(const ExportedRecording& recording, const ExportedSource& source,
           std::vector<std::size_t> channels);

  [[nodiscard]] const ExportedSource& source() const { return source_; }
  [[nodiscard]] const std::vector<RowColumn>& columns() const { return columns_; }
  [[nodiscard]] std::uint64_t rows() const { return source_.samples; }
  // Ends with the first failure of `visit`.
  [[nodiscard]] Expected<void>
  for_each(const std::function<Expected<void>(const Rows&)>& visit) const;
  [[nodiscard]] Rows rows_of(const InOrder<wire::SampleBlock>& one) const;
  [[nodiscard]] Rows rows_of(const InOrder<wire::TriggeredRecord>& one) const;

private:
  const ExportedRecording& recording_;
  const ExportedSource& source_;
  std::vector<std::size_t> channels_;
  std::vector<RowColumn> columns_;
};

// The sources as tables. `channels`: "SOURCE/CHANNEL" or "SOURCE", none: everything. Fails
// (bad_argument) with what there is when one of them is not there.
[[nodiscard]] Expected<std::vector<RowTable>> row_tables(const ExportedRecording& recording,
                                                         const std::vector<std::string>& channels);

} // namespace dyncal::inline records
