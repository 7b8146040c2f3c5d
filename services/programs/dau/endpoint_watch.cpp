#include "services/programs/dau/endpoint_watch.hpp"

#include <chrono>
#include <utility>

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include "drivers/smartup/sensor_id.hpp"

namespace dyncal::inline programs::dau {

namespace {

namespace smartup = drivers::smartup;
using smartup::sensor_text;

constexpr int reports_until_named = 10; // 5 s: descriptions come every 4 s
constexpr std::size_t max_listed = 16;  // sensors in one sentence

std::string name_of(const PlannedSource& planned) {
  return planned.bench + "/" + planned.source;
}

} // namespace

void EndpointWatch::add(PlannedSource planned, std::shared_ptr<SourcePublisher> publisher) {
  const std::uint32_t sensor = planned.settings.sensor;
  sources_.emplace(sensor, Source{.planned = std::move(planned),
                                  .publisher = std::move(publisher),
                                  .reported_causes = {}});
}

void EndpointWatch::report_causes(Source& source) {
  const auto report = [&](const std::string& cause, std::uint64_t count) {
    if (count > 0 && source.reported_causes.insert(cause).second) {
      spdlog::warn("{}: {} ({} so far; counted in the status from now on)", name_of(source.planned),
                   cause, count);
    }
  };
  const drivers::SampleCounts counts = source.publisher->snapshot().counts;
  report("samples lost in the unit", counts.lost_in_device);
  report("samples lost on the way", counts.lost_on_way);
  report("duplicate samples", counts.duplicates);
  for (const drivers::NamedCount& cause : counts.causes) {
    report(cause.name, cause.value);
  }
}

void EndpointWatch::report_unknown(const smartup::SensorReport& report) {
  int& reports = unknown_[report.sensor];
  if (reports > reports_until_named) {
    return;
  }
  reports = report.name.empty() ? reports + 1 : reports_until_named + 1;
  if (reports <= reports_until_named) {
    return;
  }
  spdlog::info("sensor {} ({}) sends to {} from {} and is in no bench file",
               sensor_text(report.sensor),
               report.name.empty() ? "without a description" : report.name, listen_, report.sender);
}

void EndpointWatch::on_report(const smartup::SensorReport& report) {
  present_[report.sensor] = report.name;
  const auto found = sources_.find(report.sensor);
  if (found == sources_.end()) {
    if (!report.wanted) {
      report_unknown(report);
    }
    return;
  }
  Source& source = found->second;
  if (!std::exchange(source.received, true)) {
    spdlog::info("{}: sensor {} is there, from {}", name_of(source.planned),
                 sensor_text(report.sensor), report.sender);
  }
  report_causes(source);
}

void EndpointWatch::on_report(const smartup::ReceptionCounts&) {
  for (auto& [sensor, source] : sources_) {
    watch(source);
  }
}

std::string EndpointWatch::present_sensors() const {
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

// The cause cannot be known here; what does come tells a person most.
std::string EndpointWatch::why_silent(const Source& source) const {
  const std::string sensor = sensor_text(source.planned.settings.sensor);
  if (source.received) {
    return fmt::format("sensor {} is silent at {}", sensor, listen_);
  }
  if (present_.empty()) {
    return fmt::format("sensor {} does not send to {}, and nothing else does", sensor, listen_);
  }
  return fmt::format("sensor {} does not send to {}; these do: {}", sensor, listen_,
                     present_sensors());
}

void EndpointWatch::watch(Source& source) {
  const auto state = source.publisher->snapshot();
  const bool silent = state.silent_after.count() > 0 &&
                      std::chrono::steady_clock::now() - state.last_offer > state.silent_after;
  if (silent) {
    std::string sentence = why_silent(source);
    if (!source.silent) {
      spdlog::warn("{}: {}", name_of(source.planned), sentence);
    }
    source.publisher->set_message(std::move(sentence));
  } else if (source.silent) {
    source.publisher->set_message("");
    spdlog::info("{}: samples come again", name_of(source.planned));
  }
  source.silent = silent;
}

} // namespace dyncal::inline programs::dau
