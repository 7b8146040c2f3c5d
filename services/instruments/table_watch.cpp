#include "services/instruments/table_watch.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "drivers/tables/table_files.hpp"
#include "services/instruments/reference_steps.hpp"

namespace dyncal::inline instruments {
namespace {

namespace tables = drivers::tables;

Expected<std::vector<tables::TableFile>> read_files(const SourceSettings& source) {
  auto files = tables::read_table_files(table_settings_of(source), tables::TableIs::written_to);
  if (!files) {
    return fail(table_error(source, files.error()));
  }
  return *std::move(files);
}

} // namespace

Expected<TableWatch> TableWatch::begin(const SourceSettings& source,
                                       std::vector<PlannedReferenceStep> plan, Instant now) {
  DYNCAL_TRY(auto before, read_files(source));
  return TableWatch(source, std::move(plan), std::move(before), now);
}

TableWatch::TableWatch(const SourceSettings& source, std::vector<PlannedReferenceStep> plan,
                       std::vector<tables::TableFile> before, Instant now)
    : source_(source), plan_(planned_rows(plan)), changed_(now) {
  for (PlannedReferenceStep& planned : plan) {
    longest_s_ = std::max(longest_s_, planned.length_s);
    steps_.push_back({std::move(planned)});
  }
  for (tables::TableFile& file : before) {
    before_[file.name] = std::move(file.rows);
  }
}

bool TableWatch::is_finished(Instant now) const {
  return run_is_over_ && is_quiet(now) && std::ranges::all_of(steps_, &Step::is_handed_out);
}

// Of a folder, files without rows of this run are of other runs. A list says which repetition each
// file is, also while it has no row.
std::vector<tables::TableFile> TableWatch::of_this_run(std::vector<tables::TableFile> files) const {
  for (tables::TableFile& file : files) {
    const auto before = before_.find(file.name);
    if (before != before_.end()) {
      const auto first = std::ranges::mismatch(file.rows, before->second).in1;
      file.rows.erase(file.rows.begin(), first);
    }
  }
  const auto& paths = table_settings_of(source_).paths;
  if (paths.size() == 1) {
    std::erase_if(files, [](const tables::TableFile& file) { return file.rows.empty(); });
    return files;
  }
  std::vector<tables::TableFile> all;
  for (const auto& path : paths) {
    const auto found = std::ranges::find(files, path.string(), &tables::TableFile::name);
    all.push_back(found != files.end() ? std::move(*found) : tables::TableFile{path.string(), {}});
  }
  return all;
}

void TableWatch::note_changes(std::vector<tables::TableFile> files, Instant now, bool run_is_over) {
  if (files != files_ || run_is_over != run_is_over_) {
    changed_ = now;
  }
  files_ = std::move(files);
  run_is_over_ = run_is_over;
}

bool TableWatch::is_quiet(Instant now) const {
  const std::chrono::duration<double> limit =
      run_is_over_ ? late_limit : quiet_limit + std::chrono::duration<double>(2.0 * longest_s_);
  return now - changed_ >= limit;
}

std::vector<bool> TableWatch::rows_that_count(const tables::TableMatch& match, Instant now) const {
  const auto has_row = [&](std::size_t i) { return match.steps[i].at.row != nullptr; };
  std::size_t followed = 0; // steps before this one
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    followed = has_row(i) ? i : followed;
  }
  const bool quiet = is_quiet(now);
  std::map<std::uint32_t, bool> lacks_earlier; // by repetition
  std::vector<bool> counts(steps_.size(), false);
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    bool& lacks = lacks_earlier[steps_[i].planned.repetition];
    const bool is_last = i + 1 == steps_.size();
    const bool is_closed = i < followed || run_is_over_ || (is_last && quiet);
    counts[i] = has_row(i) && ((is_closed && !lacks) || (run_is_over_ && quiet));
    lacks = lacks || !has_row(i);
  }
  return counts;
}

void TableWatch::doubt(Step& step, const tables::MatchedRow& now, News& news) const {
  const bool is_same = step.row ? now.at.row != nullptr && *now.at.row == *step.row : true;
  if (!is_same && !std::exchange(step.is_doubted, true)) {
    news.sentences.push_back(
        fmt::format("the row of step {} ({} Hz) was handed out, and the table has changed since: "
                    "it does not tell any more that it is of this step; evaluate the run again "
                    "with 'dyncal analyse'",
                    step.planned.step, step.planned.frequency_text_hz));
    news.steps.push_back(missing_step(step.planned, news.sentences.back()));
  }
}

Expected<void> TableWatch::hand_out(const tables::TableMatch& match, Instant now, News& news) {
  const std::vector<bool> counts = rows_that_count(match, now);
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    Step& step = steps_[i];
    const tables::MatchedRow& matched = match.steps[i];
    if (step.is_handed_out) {
      doubt(step, matched, news);
    } else if (counts[i]) {
      DYNCAL_TRY(news.steps.emplace_back(), reference_step_of(source_, step.planned, matched.at));
      step.row = *matched.at.row;
      step.is_handed_out = true;
    } else if (run_is_over_ && is_quiet(now)) {
      news.steps.push_back(missing_step(step.planned, matched.problem));
      step.is_handed_out = true;
    }
  }
  return {};
}

void TableWatch::name_extra_rows(const tables::TableMatch& match, News& news) {
  if (!match.extra.empty() && !std::exchange(extra_rows_named_, true)) {
    news.sentences.push_back(rows_of_no_step(match));
  }
}

Expected<TableWatch::News> TableWatch::look(Instant now, bool run_is_over) {
  DYNCAL_TRY(auto files, read_files(source_));
  note_changes(of_this_run(std::move(files)), now, run_is_over);
  const auto match = tables::match_table(files_, plan_, table_settings_of(source_));
  if (!match) {
    return fail(table_error(source_, match.error()));
  }
  News news;
  DYNCAL_TRY(hand_out(*match, now, news));
  if (run_is_over_ && is_quiet(now)) {
    name_extra_rows(*match, news);
  }
  return news;
}

} // namespace dyncal::inline instruments
