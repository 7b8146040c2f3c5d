#include "services/programs/command/condition_logger.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "drivers/utc_clock.hpp"
#include "services/base/csv_field.hpp"
#include "services/base/printable_text.hpp"
#include "services/contract/unit.hpp"
#include "services/evaluation/result/members.hpp"
#include "services/programs/command/local_command.hpp"
#include "services/programs/command/logger_file.hpp"

namespace dyncal::inline programs {
namespace {

constexpr double ns_per_s = 1e9;
constexpr std::chrono::seconds command_limit{10};
constexpr std::chrono::seconds channel_time{2}; // of which a reading is the mean

std::string source_text(const ConditionSettings& settings, const ConditionQuantity& quantity) {
  const std::string what = settings.kind == "file"      ? "file " + settings.file
                           : settings.kind == "channel" ? "channel " + quantity.place
                                                        : "command " + settings.command.front();
  return settings.name.empty() ? what : settings.name + ", " + what;
}

bool is_on_earth(const std::string& quantity, double value) {
  if (quantity == "humidity") {
    return value >= 0.0 && value <= 100.0;
  }
  return quantity == "pressure" ? value >= 100.0 && value <= 2000.0
                                : value >= -100.0 && value <= 200.0; // so that 296 K is none
}

// What a value in a unit is times, and then plus, in that of the condition; nothing: it is none.
std::optional<std::pair<double, double>> conversion_to(const std::string& unit,
                                                       const std::string& d_si) {
  struct Conversion {
    std::string_view unit;
    std::string_view d_si;
    double factor;
    double offset;
  };
  static constexpr std::array conversions{
      Conversion{"degC", R"(\degreecelsius)", 1.0, 0.0},
      Conversion{"degC", R"(\kelvin)", 1.0, -273.15}, Conversion{"%", R"(\percent)", 1.0, 0.0},
      Conversion{"hPa", R"(\hecto\pascal)", 1.0, 0.0}, Conversion{"hPa", R"(\pascal)", 0.01, 0.0}};
  for (const Conversion& one : conversions) {
    if (one.unit == unit && one.d_si == d_si) {
      return std::pair(one.factor, one.offset);
    }
  }
  return std::nullopt;
}

ReadCondition file_reader(const std::filesystem::path& file, const ConditionQuantity& quantity) {
  return
      [file, wanted = LoggerColumn{quantity.place, quantity.unit}]() -> Expected<ConditionReading> {
        DYNCAL_TRY(const auto reading, newest_reading(file, wanted));
        return ConditionReading{reading.utc_ns, reading.value};
      };
}

// Of lines "NAME VALUE".
ReadCondition command_reader(const std::vector<std::string>& words,
                             const ConditionQuantity& quantity) {
  return [words, name = quantity.place, unit = quantity.unit]() -> Expected<ConditionReading> {
    DYNCAL_TRY(const auto output, run_local_command({.words = words, .limit = command_limit}));
    std::istringstream lines(output);
    for (std::string line; std::getline(lines, line);) {
      const auto value = line.starts_with(name + " ")
                             ? logger_value(line.substr(name.size() + 1), unit)
                             : std::nullopt;
      if (value) {
        return ConditionReading{utc_now_ns(), *value};
      }
    }
    return fail(ErrorCode::bad_file,
                fmt::format("{}: prints no line '{} VALUE', in {}", words.front(), name, unit));
  };
}

ReadCondition no_reader(const std::string& why) {
  return [why]() -> Expected<ConditionReading> { return fail(ErrorCode::bad_file, why); };
}

} // namespace

ConditionSummary::ConditionSummary(const ConditionSettings& settings,
                                   const ConditionQuantity& quantity)
    : max_age_s_(settings.max_age_s) {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  logged_.quantity = quantity.quantity;
  logged_.unit = quantity.unit;
  logged_.source = source_text(settings, quantity);
  logged_.minimum = logged_.mean = logged_.maximum = unknown;
  logged_.expanded = quantity.expanded;
}

std::string ConditionSummary::what_is_wrong(const Expected<ConditionReading>& reading,
                                            std::int64_t now_ns) const {
  if (!reading) {
    return reading.error().message;
  }
  const double age_s = static_cast<double>(now_ns - reading->utc_ns) / ns_per_s;
  if (!(std::abs(age_s) <= max_age_s_)) {
    return fmt::format("the newest reading is of {}, {:.0f} s {}", utc_text(reading->utc_ns),
                       std::abs(age_s), age_s > 0.0 ? "ago" : "after now");
  }
  if (!is_on_earth(logged_.quantity, reading->value)) {
    return fmt::format("the reading {:g} {} is beyond what a laboratory has", reading->value,
                       logged_.unit);
  }
  return "";
}

std::string ConditionSummary::take(const Expected<ConditionReading>& reading, std::int64_t now_ns) {
  const std::string wrong = what_is_wrong(reading, now_ns);
  const bool was_missing = std::exchange(is_missing_, !wrong.empty());
  if (!wrong.empty()) {
    logged_.problem = logged_.problem.empty() ? one_line(wrong) : logged_.problem;
    return was_missing ? ""
                       : fmt::format("{} ({}) is not logged: {}", logged_.quantity, logged_.source,
                                     one_line(wrong));
  }
  if (newest_ && newest_->utc_ns == reading->utc_ns) {
    return ""; // the same line of the file
  }
  newest_ = *reading;
  const double count = static_cast<double>(++logged_.count);
  const bool is_first = logged_.count == 1;
  logged_.minimum = is_first ? reading->value : std::min(logged_.minimum, reading->value);
  logged_.maximum = is_first ? reading->value : std::max(logged_.maximum, reading->value);
  logged_.mean = is_first ? reading->value : logged_.mean + (reading->value - logged_.mean) / count;
  return was_missing ? fmt::format("{} is logged again", logged_.quantity) : "";
}

ConditionLogger::ConditionLogger(ConditionSettings settings, const BenchFile& bench,
                                 const RunOutcome& planned, bus::Participant& participant,
                                 std::filesystem::path csv)
    : settings_(std::move(settings)), participant_(participant), csv_(std::move(csv)) {
  for (const ConditionQuantity& quantity : settings_.quantities) {
    readers_.push_back(reader_of(quantity, bench, planned));
    summaries_.emplace_back(settings_, quantity);
  }
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

ConditionLogger::~ConditionLogger() = default;

ReadCondition ConditionLogger::reader_of(const ConditionQuantity& quantity, const BenchFile& bench,
                                         const RunOutcome& planned) {
  if (settings_.kind == "file") {
    const auto folder = std::filesystem::absolute(bench.path).parent_path();
    return file_reader(folder / settings_.file, quantity);
  }
  return settings_.kind == "command" ? command_reader(settings_.command, quantity)
                                     : channel_reader(quantity, bench.bench, planned);
}

ReadCondition ConditionLogger::channel_reader(const ConditionQuantity& quantity,
                                              const std::string& bench, const RunOutcome& planned) {
  const std::size_t slash = quantity.place.find('/');
  const std::string name = quantity.place.substr(0, slash);
  const auto source = std::ranges::find(planned.sources, name, &RunSource::source);
  if (source == planned.sources.end()) {
    return no_reader(fmt::format("the run has no source '{}'", name));
  }
  const auto& channels = source->description.channels;
  const auto column = std::ranges::find(channels, quantity.place.substr(slash + 1),
                                        &drivers::ChannelDescription::name);
  if (column == channels.end()) {
    return no_reader(
        fmt::format("source {} has no channel '{}'", name, quantity.place.substr(slash + 1)));
  }
  const auto conversion = conversion_to(quantity.unit, column->unit);
  if (!conversion) {
    return no_reader(fmt::format(
        "channel {} is in {}, not in {}; state its unit in the bench file", quantity.place,
        column->unit.empty() ? "no unit" : short_form(column->unit), quantity.unit));
  }
  tap_ = tap_ ? std::move(tap_) : std::make_unique<SignalTap>(participant_, bus::system_clock());
  const TappedChannel tapped{bench, name, source->kind,
                             static_cast<std::size_t>(column - channels.begin())};
  return [this, tapped, conversion = *conversion]() -> Expected<ConditionReading> {
    DYNCAL_TRY(const double mean, mean_since(tapped, looked_since_));
    return ConditionReading{utc_now_ns(), conversion.first * mean + conversion.second};
  };
}

// Of the samples that came at this instant or later: older ones may be of a source that is silent.
Expected<double> ConditionLogger::mean_since(const TappedChannel& channel,
                                             bus::Clock::Instant since) {
  double sum = 0.0;
  std::size_t count = 0;
  const bool is_seen = tap_->look(channel, [&](const ChannelRing& ring) {
    const auto first_ns = ring.first_stamp_since(since);
    for (auto sample = ring.samples().rbegin();
         first_ns && sample != ring.samples().rend() && sample->stamp_ns >= *first_ns; ++sample) {
      sum += sample->value;
      ++count;
    }
  });
  if (!is_seen || count == 0) {
    return fail(ErrorCode::bad_file, fmt::format("source {} sends no samples", channel.source));
  }
  return sum / static_cast<double>(count);
}

// A channel is read from the first look on; so long its samples are gathered.
void ConditionLogger::gather_samples() {
  looked_since_ = bus::system_clock().now();
  for (const ReadCondition& read : readers_) {
    static_cast<void>(read()); // the look counts
  }
  std::this_thread::sleep_for(channel_time); // no condition: this is what a reading is the mean of
}

void ConditionLogger::read_all() {
  if (tap_) {
    gather_samples();
  }
  for (std::size_t i = 0; i < readers_.size(); ++i) {
    const auto reading = readers_[i]();
    const std::lock_guard lock(mutex_);
    const auto count = summaries_[i].logged().count;
    std::string sentence = summaries_[i].take(reading, utc_now_ns());
    if (!sentence.empty()) {
      sentences_.push_back(std::move(sentence));
    }
    if (summaries_[i].logged().count != count) {
      keep(summaries_[i]);
    }
  }
}

void ConditionLogger::keep(const ConditionSummary& summary) {
  std::error_code unknown;
  const bool is_new = !std::filesystem::exists(csv_, unknown);
  std::ofstream stream(csv_, std::ios::app);
  if (is_new) {
    stream << "utc,quantity,value,unit,source\n";
  }
  const LoggedCondition& logged = summary.logged();
  stream << fmt::format("{},{},{},{},{}\n", utc_text(summary.newest()->utc_ns), logged.quantity,
                        summary.newest()->value, logged.unit, csv_field(logged.source));
}

void ConditionLogger::run(const std::stop_token& stop) {
  const auto interval = std::chrono::duration_cast<std::chrono::nanoseconds>(
      std::chrono::duration<double>(settings_.every_s));
  do {
    read_all();
    std::unique_lock lock(mutex_);
    ended_.wait_for(lock, stop, interval, [] { return false; });
  } while (!stop.stop_requested());
  read_all();
}

std::vector<std::string> ConditionLogger::take_sentences() {
  const std::lock_guard lock(mutex_);
  return std::exchange(sentences_, {});
}

std::vector<LoggedCondition> ConditionLogger::logged() const {
  const std::lock_guard lock(mutex_);
  std::vector<LoggedCondition> all;
  for (const ConditionSummary& summary : summaries_) {
    all.push_back(summary.logged());
  }
  return all;
}

std::vector<LoggedCondition> ConditionLogger::finish() {
  thread_.request_stop();
  if (thread_.joinable()) {
    thread_.join();
  }
  return logged();
}

std::vector<LoggedCondition> joined_conditions(const std::vector<LoggedCondition>& before,
                                               const std::vector<LoggedCondition>& since) {
  std::vector<LoggedCondition> joined = since;
  for (LoggedCondition& one : joined) {
    const auto other = std::ranges::find(before, one.quantity, &LoggedCondition::quantity);
    if (other == before.end() || other->count == 0) {
      continue;
    }
    if (one.count == 0) {
      one.minimum = other->minimum;
      one.mean = other->mean;
      one.maximum = other->maximum;
    } else {
      const double weight =
          static_cast<double>(one.count) / static_cast<double>(one.count + other->count);
      one.mean = weight * one.mean + (1.0 - weight) * other->mean;
      one.minimum = std::min(one.minimum, other->minimum);
      one.maximum = std::max(one.maximum, other->maximum);
    }
    one.count += other->count;
    one.problem = other->problem.empty() ? one.problem : other->problem;
  }
  return joined;
}

} // namespace dyncal::inline programs
