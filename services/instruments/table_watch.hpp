// The table of a system that evaluates itself, watched while it is written: which of its rows are
// steps of the run that is under way.
//
// What stands in the files when the run begins is not of it: rows that a file still has then, line
// by line from its first, are passed over, whether it grows or is written anew. A row counts for
// its step when match_table() is certain of it, no earlier step of its repetition lacks a row, and
// the row of a later step has followed; the last one when nothing has changed for `quiet_limit` and
// twice the longest step. A row that is measured a second time is thus seen before the first is
// handed out, and no test tone is taken for a step that is yet to come. When the run is over
// nothing needs to follow, and when nothing has changed for `late_limit` since, steps get the rows
// that are certain although others are missing, and those without say so. A step whose row the
// table no longer bears out is handed out once more, without a value: its result is flagged.
//
// look() fails (bad_file) as read_reference_steps() does; it may be called again, for whoever
// writes may mend it. Belongs to one thread.
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "drivers/tables/table_match.hpp"
#include "services/base/error.hpp"
#include "services/bench/file/source_settings.hpp"
#include "services/contract/reference_step.hpp"

namespace dyncal::inline instruments {

class TableWatch {
public:
  using Instant = std::chrono::steady_clock::time_point;

  static constexpr std::chrono::seconds quiet_limit{10};
  static constexpr std::chrono::seconds late_limit{60};

  // REQUIRES: driver "table".
  [[nodiscard]] static Expected<TableWatch>
  begin(const SourceSettings& source, std::vector<PlannedReferenceStep> plan, Instant now);

  struct News {
    std::vector<ReferenceStep> steps;   // each once, and once more if it is not certain any more
    std::vector<std::string> sentences; // for people, each once
  };
  [[nodiscard]] Expected<News> look(Instant now, bool run_is_over);

  // All was handed out, and nothing has changed for `late_limit` since the run is over.
  [[nodiscard]] bool is_finished(Instant now) const;

private:
  struct Step {
    PlannedReferenceStep planned;
    std::optional<drivers::tables::ReferenceTableRow> row{}; // that was handed out
    bool is_handed_out = false;
    bool is_doubted = false; // said
  };

  TableWatch(const SourceSettings& source, std::vector<PlannedReferenceStep> plan,
             std::vector<drivers::tables::TableFile> before, Instant now);
  [[nodiscard]] std::vector<drivers::tables::TableFile>
  of_this_run(std::vector<drivers::tables::TableFile> files) const;
  void note_changes(std::vector<drivers::tables::TableFile> files, Instant now, bool run_is_over);
  [[nodiscard]] bool is_quiet(Instant now) const;
  [[nodiscard]] std::vector<bool> rows_that_count(const drivers::tables::TableMatch& match,
                                                  Instant now) const;
  [[nodiscard]] Expected<void> hand_out(const drivers::tables::TableMatch& match, Instant now,
                                        News& news);
  void doubt(Step& step, const drivers::tables::MatchedRow& now, News& news) const;
  void name_extra_rows(const drivers::tables::TableMatch& match, News& news);

  SourceSettings source_;
  std::vector<Step> steps_;
  std::vector<drivers::tables::PlannedRow> plan_;
  double longest_s_ = 0.0;                                                        // of the steps
  std::map<std::string, std::vector<drivers::tables::ReferenceTableRow>> before_; // by file
  std::vector<drivers::tables::TableFile> files_;                                 // of this run
  Instant changed_;
  bool run_is_over_ = false;
  bool extra_rows_named_ = false;
};

} // namespace dyncal::inline instruments
