#include "drivers/tables/table_match.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "drivers/tables/row_alignment.hpp"

namespace dyncal::drivers::tables {
namespace {

using Loops = std::vector<std::vector<LoopRow>>;

constexpr std::int64_t max_loops = 10'000;

tl::unexpected<Error> refuse(std::string sentence) {
  return fail(ErrorCode::invalid_setting, std::move(sentence));
}

tl::unexpected<Error> refuse_first_loop(const LoopRow& first, std::int64_t begin) {
  return refuse(fmt::format("{}: line {}: the row is of loop {}, and loop {} is taken for the "
                            "first repetition; name the loop of the first repetition with the "
                            "source's key 'first_loop'",
                            first.file->name, first.row->line, first.row->loop.value_or(0), begin));
}

Expected<Loops> numbered_loops(const TableFile& file, const TableSettings& settings) {
  Loops loops;
  const std::int64_t begin = settings.first_loop.value_or(0);
  for (const ReferenceTableRow& row : file.rows) {
    const std::int64_t loop = row.loop.value_or(begin) - begin;
    if (loop < 0 || loop >= max_loops || (loops.empty() && loop != 0 && !settings.first_loop)) {
      return refuse_first_loop({&file, &row}, begin);
    }
    const auto index = static_cast<std::size_t>(loop);
    if (index + 1 < loops.size()) {
      return refuse(fmt::format("{}: line {}: the row is of loop {}, behind rows of a later one; "
                                "the rows of a loop must stand together",
                                file.name, row.line, *row.loop));
    }
    loops.resize(index + 1);
    loops[index].push_back({&file, &row});
  }
  return loops;
}

Loops loops_of_files(std::span<const TableFile> files) {
  Loops loops;
  for (const TableFile& file : files) {
    auto& loop = loops.emplace_back();
    for (const ReferenceTableRow& row : file.rows) {
      loop.push_back({&file, &row});
    }
  }
  return loops;
}

struct PlannedLoop {
  std::vector<std::size_t> steps; // places in the plan
  std::vector<double> frequencies_hz;
};

std::vector<PlannedLoop> planned_loops(std::span<const PlannedRow> plan) {
  std::vector<PlannedLoop> loops;
  for (std::size_t i = 0; i < plan.size(); ++i) {
    const std::size_t index = std::max<std::size_t>(plan[i].repetition, 1) - 1;
    loops.resize(std::max(loops.size(), index + 1));
    loops[index].steps.push_back(i);
    loops[index].frequencies_hz.push_back(plan[i].frequency_hz);
  }
  return loops;
}

void match_loop(const PlannedLoop& planned, std::span<const LoopRow> rows, TableMatch& match) {
  const auto aligned = align_rows(planned.frequencies_hz, frequencies_of(rows));
  std::vector<bool> used(rows.size(), false);
  for (std::size_t i = 0; i < aligned.size(); ++i) {
    MatchedRow& step = match.steps[planned.steps[i]];
    if (aligned[i].row) {
      step.at = rows[*aligned[i].row];
      used[*aligned[i].row] = true;
      continue;
    }
    std::vector<LoopRow> possible;
    for (const std::size_t row : aligned[i].possible) {
      possible.push_back(rows[row]);
    }
    step.problem = lacking_row(planned.frequencies_hz[i], possible);
  }
  for (std::size_t row = 0; row < rows.size(); ++row) {
    if (!used[row]) {
      match.extra.push_back(name_of(rows[row]));
    }
  }
}

} // namespace

std::vector<double> frequencies_of(std::span<const LoopRow> rows) {
  std::vector<double> frequencies_hz;
  for (const LoopRow& one : rows) {
    frequencies_hz.push_back(one.row->frequency_hz);
  }
  return frequencies_hz;
}

std::string name_of(const LoopRow& row) {
  return fmt::format("{}: line {} ({} Hz)", row.file->name, row.row->line, row.row->frequency_hz);
}

std::string lacking_row(double frequency_hz, std::span<const LoopRow> possible) {
  if (possible.empty()) {
    return fmt::format("the reference's table has no row for this step, of {} Hz within 1 %",
                       frequency_hz);
  }
  std::vector<std::string> names;
  for (const LoopRow& row : possible) {
    names.push_back(name_of(row));
  }
  return fmt::format("the order does not tell which row of the reference's table is of this step: "
                     "{}; name rows that are no steps with the source's keys 'skip_first_rows' and "
                     "'skip_last_rows'",
                     fmt::join(names, " or "));
}

Expected<Loops> loops_of(std::span<const TableFile> files, const TableSettings& settings) {
  Loops loops;
  if (files.size() == 1) {
    DYNCAL_TRY(loops, numbered_loops(files.front(), settings));
  } else {
    loops = loops_of_files(files);
  }
  for (auto& loop : loops) {
    loop.resize(loop.size() - std::min(loop.size(), settings.skip_last_rows));
    const std::size_t before = std::min(loop.size(), settings.skip_first_rows);
    loop.erase(loop.begin(), loop.begin() + static_cast<std::ptrdiff_t>(before));
  }
  return loops;
}

Expected<TableMatch> match_table(std::span<const TableFile> files, std::span<const PlannedRow> plan,
                                 const TableSettings& settings) {
  DYNCAL_TRY(auto loops, loops_of(files, settings));
  const std::vector<PlannedLoop> planned = planned_loops(plan);
  if (loops.size() > planned.size() && !loops.back().empty()) {
    return refuse(fmt::format("{}: the table has {} loops, and the plan {} repetitions; the keys "
                              "'first_loop' of the source and 'repetitions' of the excitation "
                              "must agree with it",
                              name_of(loops.back().front()), loops.size(), planned.size()));
  }
  loops.resize(planned.size());
  TableMatch match{.steps = std::vector<MatchedRow>(plan.size()), .extra = {}};
  for (std::size_t i = 0; i < planned.size(); ++i) {
    if ((planned[i].steps.size() + 1) * (loops[i].size() + 1) > max_compared) {
      return refuse(fmt::format("{} rows are too many to be compared with {} steps",
                                loops[i].size(), planned[i].steps.size()));
    }
    match_loop(planned[i], loops[i], match);
  }
  return match;
}

} // namespace dyncal::drivers::tables
