#include "services/dau/endpoint_sink.hpp"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "drivers/smartup/sensor_id.hpp"
#include "services/dau/counts.hpp"

namespace dyncal::services::dau {

namespace {

namespace smartup = drivers::smartup;
using smartup::sensor_text;

constexpr int reports_until_named = 10; // 5 s: descriptions come every 4 s
constexpr std::size_t max_listed = 16;  // sensors in one sentence

std::string name_of(const PlannedSource& planned) {
  return planned.bench + "/" + planned.source;
}

} // namespace

EndpointSink::EndpointSink(std::string listen, EventLines& lines)
    : listen_(std::move(listen)), lines_(lines) {}

void EndpointSink::add(PlannedSource planned, std::shared_ptr<SourcePublisher> publisher) {
  const std::uint32_t sensor = planned.settings.sensor;
  sources_.emplace(
      sensor,
      Source{.planned = std::move(planned), .publisher = std::move(publisher), .causes_said = {}});
}

EndpointSink::Source* EndpointSink::source_of(std::uint32_t sensor) {
  const auto found = sources_.find(sensor);
  return found == sources_.end() ? nullptr : &found->second;
}

void EndpointSink::on_description(std::uint32_t sensor,
                                  const drivers::SourceDescription& description) {
  Source* source = source_of(sensor);
  if (source == nullptr) {
    return;
  }
  for (const auto& [device_name, ours] : source->planned.settings.naming.names) {
    if (std::ranges::count(description.channels, ours, &drivers::ChannelDescription::name) == 0) {
      lines_.add(
          true, fmt::format(
                    "{}: the bench file names channel {} '{}', but sensor {} sends no such channel",
                    name_of(source->planned), device_name, ours, sensor_text(sensor)));
    }
  }
  source->publisher->describe(description);
}

void EndpointSink::on_warning(std::uint32_t sensor, const std::string& sentence) {
  for (const auto& [own, source] : sources_) {
    if (own == sensor || source.planned.settings.sync_sensor == sensor) {
      lines_.add(true, fmt::format("{}: sensor {}: {}", name_of(source.planned),
                                   sensor_text(sensor), sentence));
    }
  }
}

void EndpointSink::on_new_session(std::uint32_t sensor) {
  Source* source = source_of(sensor);
  if (source == nullptr) {
    return;
  }
  lines_.add(
      false,
      fmt::format(
          "{}: a new session begins, the unit has restarted the numbering or sends other channels",
          name_of(source->planned)));
  source->publisher->start_session();
}

void EndpointSink::on_block(std::uint32_t sensor, drivers::SampleBlock block) {
  if (Source* source = source_of(sensor)) {
    source->publisher->offer(std::move(block));
  }
}

void EndpointSink::say_causes(Source& source, const SourceCounts& counts) {
  const auto say = [&](const std::string& cause, std::uint64_t count) {
    if (count > 0 && source.causes_said.insert(cause).second) {
      lines_.add(true, fmt::format("{}: {} ({} so far; counted in the status from now on)",
                                   name_of(source.planned), cause, count));
    }
  };
  say("samples lost in the unit", counts.lost_in_device);
  say("samples lost on the way", counts.lost_on_way);
  say("duplicate samples", counts.duplicates);
  for (const auto& [cause, count] : counts.causes) {
    say(cause, count);
  }
}

void EndpointSink::report_unknown(const smartup::SensorReport& report) {
  int& reports = unknown_[report.sensor];
  if (reports > reports_until_named) {
    return;
  }
  reports = report.name.empty() ? reports + 1 : reports_until_named + 1;
  if (reports <= reports_until_named) {
    return;
  }
  lines_.add(false, fmt::format("sensor {} ({}) sends to {} from {} and is in no bench file",
                                sensor_text(report.sensor),
                                report.name.empty() ? "without a description" : report.name,
                                listen_, report.sender));
}

void EndpointSink::on_report(const smartup::SensorReport& report) {
  present_[report.sensor] = report.name;
  Source* source = source_of(report.sensor);
  if (source == nullptr) {
    if (!report.wanted) {
      report_unknown(report);
    }
    return;
  }
  if (!std::exchange(source->received, true)) {
    lines_.add(false, fmt::format("{}: sensor {} is there, from {}", name_of(source->planned),
                                  sensor_text(report.sensor), report.sender));
  }
  const SourceCounts counts = source_counts(report.counts, reception_);
  say_causes(*source, counts);
  source->publisher->report(counts);
}

std::string EndpointSink::present_sensors() const {
  std::string text;
  std::size_t listed = 0;
  for (const auto& [sensor, name] : present_) {
    if (++listed > max_listed) {
      return text + fmt::format(" and {} more", present_.size() - max_listed);
    }
    text += fmt::format("{}{}{}", text.empty() ? "" : ", ", sensor_text(sensor),
                        name.empty() ? "" : " (" + name + ")");
  }
  return text;
}

// Says in the status and in the log when a source is silent, and since it cannot be known why, what
// does come.
void EndpointSink::watch(Source& source) {
  const auto state = source.publisher->snapshot();
  const bool silent = state.silent_after.count() > 0 &&
                      std::chrono::steady_clock::now() - state.last_offer > state.silent_after;
  if (silent) {
    const std::string sensor = sensor_text(source.planned.settings.sensor);
    std::string sentence;
    if (source.received) {
      sentence = fmt::format("sensor {} is silent at {}", sensor, listen_);
    } else if (present_.empty()) {
      sentence =
          fmt::format("sensor {} does not send to {}, and nothing else does", sensor, listen_);
    } else {
      sentence = fmt::format("sensor {} does not send to {}; these do: {}", sensor, listen_,
                             present_sensors());
    }
    if (!source.silent) {
      lines_.add(true, fmt::format("{}: {}", name_of(source.planned), sentence));
    }
    source.publisher->say(std::move(sentence));
  } else if (source.silent) {
    source.publisher->say("");
    lines_.add(false, fmt::format("{}: samples come again", name_of(source.planned)));
  }
  source.silent = silent;
}

void EndpointSink::on_report(const smartup::ReceptionCounts& counts) {
  reception_ = counts;
  for (auto& [sensor, source] : sources_) {
    watch(source);
  }
}

} // namespace dyncal::services::dau
