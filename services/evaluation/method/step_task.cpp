#include "services/evaluation/method/step_task.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "services/evaluation/record/good_samples.hpp"
#include "services/evaluation/record/line_finder.hpp"

namespace dyncal::inline evaluation {
namespace {

constexpr double max_distrusted_part = 0.2; // of the stamps: with more they are the likely reason

double distrusted_part(const SourceRecord& source) {
  const auto flags = source.flags();
  const auto distrusted = static_cast<double>(
      std::count_if(flags.begin(), flags.end(), [](std::uint8_t flag) { return flag != 0; }));
  return flags.empty() ? 0.0 : distrusted / static_cast<double>(flags.size());
}

constexpr double worth_naming_rad = 0.05; // of the sine, by which stamps are off an even rate
constexpr std::int64_t worth_naming_back_ns = 500'000'000; // a step is not over in less
constexpr std::size_t max_looked_at = 4096;

// How far the stamps lie off an even rate: what is read in batches, or stamped in
// coarse ticks, is not even.
double uneven_ns(const SourceRecord& source) {
  std::vector<std::int64_t> trusted;
  const auto stamps = source.stamps_ns();
  const std::size_t middle =
      stamps.size() > max_looked_at ? (stamps.size() - max_looked_at) / 2 : 0;
  for (std::size_t i = middle; i < stamps.size() && trusted.size() < max_looked_at; ++i) {
    if (source.flags()[i] == 0) {
      trusted.push_back(stamps[i]);
    }
  }
  double most_ns = 0.0;
  for (std::size_t i = 1; i + 1 < trusted.size(); ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(trusted.size() - 1);
    const double even_ns = share * static_cast<double>(trusted.back() - trusted.front());
    most_ns =
        std::max(most_ns, std::abs(static_cast<double>(trusted[i] - trusted.front()) - even_ns));
  }
  return most_ns;
}

// Of what is known of the source; empty if nothing is.
std::string known_cause(const RunRecords& records, std::size_t step, const std::string& name) {
  const SourceRecord& source = records.of(name);
  if (source.restarts() > 0) {
    return fmt::format(": source '{}' restarted during the run", name);
  }
  if (!source.newest_stamp_ns()) {
    return fmt::format(": source '{}' sent no samples", name);
  }
  if (records.began_after(name, step)) {
    return fmt::format(": the record of source '{}' begins after it", name);
  }
  if (records.ended_before(name, step)) {
    return fmt::format(": the record of source '{}' ends before it", name);
  }
  if (source.set_back_ns() > worth_naming_back_ns) {
    return fmt::format(": the clock of source '{}' was set back by {:.6g} s during the run", name,
                       static_cast<double>(source.set_back_ns()) * 1e-9);
  }
  if (const double part = distrusted_part(source); part > max_distrusted_part) {
    return fmt::format(": {:.0f} % of its time stamps are not trusted; has its clock lost its fix, "
                       "are its samples read in batches, or does it lose samples that its numbers "
                       "do not show?",
                       100.0 * part);
  }
  if (records.excitation().is_cut_short()) {
    return fmt::format(": the run ended before source '{}' had sent it", name);
  }
  if (const std::uint64_t lost = source.lost() + source.overflowed(); lost > 0) {
    return fmt::format(": source '{}' lost {} samples during the run", name, lost);
  }
  return records.excitation().is_broken_off(step) ? ": its excitation was broken off" : "";
}

constexpr double beside_mains_rel = 0.01; // of the frequency: mains are within it
constexpr std::int64_t edge_frames = 2;   // at either end, which the search does not fill

bool is_beside_mains(const Recipe& recipe, double hz) {
  return std::any_of(recipe.mains_hz.begin(), recipe.mains_hz.end(), [&](double line_hz) {
    const double harmonic_hz = line_hz * std::max(1.0, std::round(hz / line_hz));
    return std::abs(hz - harmonic_hz) < beside_mains_rel * hz;
  });
}

enum class ShownSine {
  shown,
  not_shown,
  unknown, // there are no samples, they have not all come, or are not all held any more
};

// Whether a channel shows a sine of a step's frequency where the step may have been: between the
// steps beside it that were found in its source. It tells a step that nobody excited from one whose
// sync signal is missing. A sine that lasts from the first sample to the last beside a mains line
// is hum. Costs what the search for the step cost.
ShownSine shown_sine(const Recipe& recipe, const RunRecords& records, std::size_t step,
                     const ChannelName& channel) {
  const SourceRecord& record = records.of(channel.source);
  const auto column = record.channel(channel.channel);
  const auto stamps = record.stamps_ns();
  const TimeInterval where = records.where_missing(channel.source, step);
  if (!column || stamps.empty() || (record.forgotten() > 0 && stamps.front() > where.begin_ns)) {
    return ShownSine::unknown;
  }
  const analysis::Frequency& frequency = records.planned(step).frequency;
  analysis::ExcitationWindowFinder finder = finder_of(records.excitation().order().lines(step));
  push_good_samples(record, *column, {0, where.begin_ns, where.end_ns}, finder);
  finder.finish();
  const auto window = finder.window();
  if (!window) {
    return records.is_over_in(channel.source, step) ? ShownSine::not_shown : ShownSine::unknown;
  }
  const std::int64_t edge_ns = edge_frames * finder.frame_ns();
  const bool lasts_throughout =
      window->excited_begin_ns < std::max(where.begin_ns, stamps.front()) + edge_ns &&
      window->off_ns > std::min(where.end_ns, stamps.back()) - edge_ns;
  return lasts_throughout && is_beside_mains(recipe, frequency.hz()) ? ShownSine::not_shown
                                                                     : ShownSine::shown;
}

// What the other channels of the run show of it.
std::string where_it_shows(const Recipe& recipe, const RunRecords& records, std::size_t step,
                           const ChannelName& sync) {
  if (shown_sine(recipe, records, step, sync) == ShownSine::shown) {
    return fmt::format("; did it last longer than the {} s of settling?",
                       records.planned(step).settling_s);
  }
  std::vector<std::string> without;
  bool is_known = true;
  for (const ChannelName& channel : recipe.channels()) {
    if (channel == recipe.roles.temperature || !records.of(channel.source).newest_stamp_ns()) {
      continue;
    }
    const ShownSine shown = shown_sine(recipe, records, step, channel);
    if (shown == ShownSine::shown) {
      return fmt::format(", where {} shows one; is the sync signal connected?", channel.text());
    }
    is_known = is_known && shown == ShownSine::not_shown;
    without.push_back(channel.text());
  }
  return is_known ? fmt::format(": no excitation was found in {} either; was the exciter driven?",
                                fmt::join(without, ", "))
                  : "; is the sync signal connected?";
}

std::string likely_cause(const Recipe& recipe, const RunRecords& records, std::size_t step_index,
                         const ChannelName& sync) {
  const SourceRecord& source = records.of(sync.source);
  const RecipeStep& step = records.planned(step_index);
  const double uneven = uneven_ns(source);
  if (2.0 * std::numbers::pi * step.frequency.hz() * uneven * 1e-9 > worth_naming_rad) {
    return fmt::format(": the time stamps of source '{}' are up to {:.2g} ms off an even rate; are "
                       "its samples read in batches, or stamped in coarse ticks?",
                       source.source(), uneven * 1e-6);
  }
  return where_it_shows(recipe, records, step_index, sync);
}

} // namespace

StepTask make_step_task(std::shared_ptr<const Recipe> recipe, std::size_t step,
                        const RunRecords& records, const std::vector<SourceInterval>& sources) {
  const ExcitationProgress& excitation = records.excitation();
  StepTask task{.recipe = std::move(recipe),
                .index = excitation.order().index(step),
                .given_up = records.given_up()};
  for (const SourceInterval& source : sources) {
    const auto& record = source.record;
    const TimeInterval& interval = source.interval;
    if (record->lost_in(interval).all() > 0) {
      task.flags.push_back(flag_of_source(ResultFlag::samples_lost, record->source()));
    }
    if (record->has_second_writer_in(interval)) {
      task.flags.push_back(flag_of_source(ResultFlag::two_writers, record->source()));
    }
    if (!task.recipe->whole_record && static_cast<double>(interval.end_ns - interval.begin_ns) <
                                          0.95e9 * task.step().duration_s) {
      task.flags.push_back(flag_of_source(ResultFlag::shorter_than_planned, record->source()));
    }
  }
  if (excitation.is_broken_off(step)) {
    task.flags.push_back(make_flag(ResultFlag::excitation_broken_off));
  }
  if (records.is_uncertain(step)) {
    task.flags.push_back(make_flag(ResultFlag::step_number_uncertain));
  }
  return task;
}

std::string no_sine(const Recipe& recipe, const RunRecords& records, std::size_t step,
                    const ChannelName& sync) {
  if (auto known = records.why_missing(step); !known.empty()) {
    return known;
  }
  const std::string when = records.when_missing(step, sync.text());
  std::string cause = known_cause(records, step, sync.source);
  if (cause.empty() && when.empty()) {
    cause = likely_cause(recipe, records, step, sync);
  }
  return fmt::format("no steady sine of {} Hz was found in {}{}{}",
                     records.planned(step).frequency_text_hz, sync.text(), when, cause);
}

} // namespace dyncal::inline evaluation
