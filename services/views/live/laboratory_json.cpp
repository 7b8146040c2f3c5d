#include "services/views/live/laboratory_json.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "services/base/printable_text.hpp"
#include "services/base/version.hpp"
#include "services/views/report/json_number.hpp"
#include "services/views/report/rounded_json.hpp"

namespace dyncal::inline views::live {
namespace {

using Json = nlohmann::ordered_json;
using Instant = bus::Clock::Instant;

// Null: not known.
Json milliseconds(std::int64_t utc_ns) {
  return utc_ns == 0 ? Json(nullptr) : Json(static_cast<double>(utc_ns) / 1e6);
}

Json not_zero(double value) {
  return value == 0.0 ? Json(nullptr) : json_number(value);
}

Json condition_json(const network::Condition& condition) {
  return {{"severity", to_string(condition.severity)}, {"what", condition.what}};
}

Json event_json(const network::Event& event) {
  return {{"utc_ms", milliseconds(event.utc_ns)},
          {"bench", event.bench},
          {"severity", to_string(event.severity)},
          {"text", event.text}};
}

Json last_result_json(const network::Run& run) {
  const auto found = run.newest_result ? run.results.find(*run.newest_result) : run.results.end();
  if (found == run.results.end()) {
    return nullptr;
  }
  const StepResult& result = found->second;
  return {{"channel", result.channel},
          {"step", result.step},
          {"repetition", result.repetition},
          {"frequency_text_hz", result.frequency_text_hz},
          {"magnitude", json_number(result.magnitude)},
          {"u_magnitude", json_number(result.u_magnitude)},
          {"phase_rad", json_number(result.phase_rad)},
          {"u_phase_rad", json_number(result.u_phase_rad)},
          {"unit", result.unit},
          {"valid", result.valid},
          {"flag_names", names_of(result.flags)},
          {"text", rounded_json(result.magnitude, result.u_magnitude, result.phase_rad,
                                result.u_phase_rad)}};
}

Json recording_json(const network::Bench& bench, Instant now) {
  const network::Service* recorder = bench.recorder();
  if (recorder == nullptr) {
    return nullptr;
  }
  const bool is_heard = now - recorder->heard <= network::silence_limit;
  return {{"state", is_heard ? "recording" : "silent"},
          {"file", recorder->recording},
          {"messages_stored", std::to_string(recorder->messages_stored)},
          {"messages_not_stored", std::to_string(recorder->messages_not_stored)},
          {"message", recorder->message}};
}

void add_run(const network::Run& run, Instant now, Json& json) {
  json["run"] = run.name;
  json["message"] = run.message.empty() && run.analysis ? run.analysis->message : run.message;
  if (run.plan) {
    json["method"] = to_string(run.plan->method);
    json["step_count"] = run.plan->steps.size();
    json["steps_done"] = run.steps_done();
  }
  if (run.now) {
    json["step"] = run.now->step.step;
    json["repetition"] = run.now->step.repetition;
    json["frequency_text_hz"] = run.now->step.frequency_text_hz;
    json["level_m_s2"] = json_number(run.now->step.level_m_s2);
    json["excitation"] = to_string(run.now->step.state);
  }
  if (const auto left_s = run.time_left_s(now)) {
    json["time_left_s"] = json_number(*left_s);
  }
  json["results"] = run.results.size();
  json["results_invalid"] = run.invalid_results();
  json["results_flagged"] = run.flagged_results();
  json["last_result"] = last_result_json(run);
}

Json channels_json(const network::Source& source) {
  Json channels = Json::array();
  if (!source.description) {
    return channels;
  }
  for (const drivers::ChannelDescription& channel : source.description->channels) {
    channels.push_back({{"name", channel.name},
                        {"quantity", channel.quantity},
                        {"unit", channel.unit},
                        {"minimum", json_number(channel.minimum)},
                        {"maximum", json_number(channel.maximum)},
                        {"resolution", not_zero(channel.resolution)}});
  }
  return channels;
}

void add_description(const network::Source& source, Json& json) {
  const auto text = [&](const auto member) {
    return source.description ? Json((*source.description).*member) : Json(nullptr);
  };
  using Description = drivers::SourceDescription;
  json["kind"] = source.kind ? Json(to_string(*source.kind)) : Json(nullptr);
  json["device"] = text(&Description::device);
  json["serial"] = text(&Description::serial);
  json["firmware"] = text(&Description::firmware);
  json["driver"] = text(&Description::driver);
  json["software"] = source.software;
  json["host"] = source.host;
  json["process_id"] = source.process_id;
  json["nominal_rate_hz"] =
      source.description ? not_zero(source.description->nominal_rate_hz) : Json(nullptr);
  json["time_base"] = nullptr;
  if (source.description) {
    const bool is_utc = source.description->time_base == drivers::TimeBase::utc;
    json["time_base"] = is_utc ? "utc" : "local";
  }
}

Json source_json(const network::Source& source, Instant now) {
  Json json{{"source", source.name}};
  add_description(source, json);
  json["state"] = source.is_silent && source.state != network::SourceState::ended
                      ? "gone"
                      : to_string(source.state);
  json["worst"] = condition_json(condition_of(source, now));
  json["rate_hz"] = json_number(source.rate_hz);
  json["received"] = std::to_string(source.counts.received);
  json["lost_in_device"] = std::to_string(source.counts.lost_in_device);
  json["lost_in_transit"] = std::to_string(source.counts.lost_on_way);
  json["duplicates"] = std::to_string(source.counts.duplicates);
  json["rejected"] = std::to_string(source.counts.rejected);
  json["stamps_not_trusted"] = std::to_string(source.counts.stamps_not_trusted);
  json["dropped_in_service"] = std::to_string(source.dropped_in_service);
  json["causes"] = Json::array();
  for (const drivers::NamedCount& cause : source.counts.causes) {
    json["causes"].push_back({{"name", cause.name}, {"value", std::to_string(cause.value)}});
  }
  json["clock_uncertainty_s"] = not_zero(source.counts.clock_uncertainty_s);
  json["buffer_fill"] = json_number(source.buffer_fill);
  json["matched_readers"] = source.matched_readers;
  json["message"] = source.message;
  json["last_message_utc_ms"] = milliseconds(source.heard_utc_ns);
  json["channels"] = channels_json(source);
  return json;
}

Json plan_json(const network::Run& run) {
  if (!run.plan) {
    return nullptr;
  }
  const network::Plan& plan = *run.plan;
  Json steps = Json::array();
  for (const network::Step& step : plan.steps) {
    steps.push_back({{"step", step.step},
                     {"frequency_text_hz", step.frequency_text_hz},
                     {"level_m_s2", json_number(step.level_m_s2)},
                     {"repetition", step.repetition},
                     {"settling_s", json_number(step.settling_s)},
                     {"duration_s", json_number(step.duration_s)},
                     {"state", to_string(step.state)},
                     {"attempt", step.attempt}});
  }
  return {{"run", run.name},
          {"state", to_string(run.state())},
          {"message", run.message},
          {"planned_utc_ms", milliseconds(run.planned_utc_ns)},
          {"method", to_string(plan.method)},
          {"reference", plan.reference},
          {"sync_acs", plan.sync_acs},
          {"sync_dau", plan.sync_dau},
          {"sync_dso", plan.sync_dso},
          {"dut", plan.dut},
          {"recipe_sha256", plan.recipe_sha256},
          {"conductor", plan.conductor},
          {"steps", std::move(steps)}};
}

Json step_now_json(const network::Run& run, Instant now) {
  if (!run.now) {
    return nullptr;
  }
  const network::Excitation& excitation = *run.now;
  const double whole_s = excitation.step.settling_s + excitation.step.duration_s;
  const double passed_s = std::chrono::duration<double>(now - excitation.began).count();
  const bool is_driven = excitation.step.state == network::StepState::settling ||
                         excitation.step.state == network::StepState::steady;
  return {{"step", excitation.step.step},
          {"state", to_string(excitation.step.state)},
          {"attempt", excitation.step.attempt},
          {"frequency_text_hz", excitation.step.frequency_text_hz},
          {"begin_utc_ms", milliseconds(excitation.begin_utc_ns)},
          {"end_utc_ms", milliseconds(excitation.end_utc_ns)},
          {"time_left_s", is_driven && whole_s > 0.0
                              ? json_number(std::clamp(whole_s - passed_s, 0.0, whole_s))
                              : Json(nullptr)}};
}

// What the sources and services of a process tell of it.
struct ProgramNews {
  std::string bench;
  Severity severity = Severity::ok;
  bool is_heard = true;
  std::string message;
  std::int64_t heard_utc_ns = 0;
};

void add_news(const std::string& bench, const network::Condition& condition, bool is_heard,
              std::int64_t heard_utc_ns, ProgramNews& news) {
  if (news.bench.find(bench) == std::string::npos && news.bench.size() < max_line_bytes) {
    news.bench += news.bench.empty() ? bench : ", " + bench;
  }
  if (condition.severity > news.severity) {
    news.severity = condition.severity;
    news.message = condition.what;
  }
  news.is_heard = news.is_heard && is_heard;
  news.heard_utc_ns = std::max(news.heard_utc_ns, heard_utc_ns);
}

ProgramNews news_of(const network::BusState& laboratory, const ProgramIdentity& program,
                    Instant now) {
  ProgramNews news;
  const auto is_of_it = [&](const std::string& host, std::uint32_t process_id) {
    return host == program.host && process_id == program.process_id;
  };
  for (const auto& [name, bench] : laboratory.benches()) {
    for (const auto& [source_name, source] : bench.sources) {
      if (is_of_it(source.host, source.process_id)) {
        add_news(name, condition_of(source, now), !source.is_silent, source.heard_utc_ns, news);
      }
    }
    for (const auto& [service_name, service] : bench.services) {
      if (is_of_it(service.host, service.process_id)) {
        network::Condition condition;
        if (service.health == network::Health::failed || !service.message.empty()) {
          const bool has_failed = service.health == network::Health::failed;
          condition.raise_severity(has_failed ? Severity::error : Severity::note, service.message);
        }
        add_news(name, condition, !bench.is_silent(service, now), service.heard_utc_ns, news);
      }
    }
  }
  return news;
}

Json program_json(const network::BusState& laboratory, const DiscoveredProgram& program,
                  Instant now) {
  const ProgramNews news = news_of(laboratory, program.identity, now);
  const std::string& name = program.identity.program;
  constexpr std::string_view prefix = "dyncal-";
  const char* health = !news.is_heard                       ? "silent"
                       : news.severity == Severity::error   ? "failed"
                       : news.severity == Severity::warning ? "waiting"
                                                            : "ok";
  Json json{{"name", name},
            {"kind", name.starts_with(prefix) ? name.substr(prefix.size()) : name},
            {"bench", news.bench},
            {"host", program.identity.host},
            {"process_id", program.identity.process_id},
            {"version", program.identity.software},
            {"vendor", program.identity.dds},
            {"health", health},
            {"message", news.message},
            {"last_message_utc_ms", milliseconds(news.heard_utc_ns)},
            {"clock_offset_s", nullptr},
            {"clock_offset_bound_s", nullptr}};
  if (program.clock) {
    json["clock_offset_s"] = json_number(program.clock->offset_s);
    json["clock_offset_bound_s"] = json_number(program.clock->bound_s);
  }
  return json;
}

Json with_time(const network::BusState& laboratory, std::uint64_t number) {
  return {{"number", number}, {"now_utc_ms", milliseconds(laboratory.clock().utc_now_ns())}};
}

} // namespace

Json bench_tile_json(const network::BusState& laboratory, const network::Bench& bench) {
  const Instant now = laboratory.clock().now();
  Json json{{"bench", bench.name},
            {"state", to_string(state_of(bench, now))},
            {"run", nullptr},
            {"message", ""},
            {"method", nullptr},
            {"step", nullptr},
            {"step_count", nullptr},
            {"steps_done", nullptr},
            {"repetition", nullptr},
            {"frequency_text_hz", nullptr},
            {"level_m_s2", nullptr},
            {"excitation", nullptr},
            {"time_left_s", nullptr},
            {"worst", condition_json(condition_of(bench, now))},
            {"lost", std::to_string(bench.lost())},
            {"clock_offset_s", nullptr},
            {"clock_offset_bound_s", nullptr},
            {"last_message_utc_ms", milliseconds(bench.heard_utc_ns)},
            {"results", 0},
            {"results_invalid", 0},
            {"results_flagged", 0},
            {"recording", recording_json(bench, now)},
            {"last_result", nullptr}};
  if (const auto clock = laboratory.worst_clock(bench)) {
    json["clock_offset_s"] = json_number(clock->offset_s);
    json["clock_offset_bound_s"] = json_number(clock->bound_s);
  }
  if (const network::Run* run = bench.current_run()) {
    add_run(*run, now, json);
  }
  return json;
}

Json bench_json(const network::BusState& laboratory, const network::Bench& bench) {
  const Instant now = laboratory.clock().now();
  Json json = with_time(laboratory, bench.number);
  json.update(bench_tile_json(laboratory, bench));
  json["sources"] = Json::array();
  for (const auto& [name, source] : bench.sources) {
    json["sources"].push_back(source_json(source, now));
  }
  const network::Run* run = bench.current_run();
  json["plan"] = run == nullptr ? Json(nullptr) : plan_json(*run);
  json["now"] = run == nullptr ? Json(nullptr) : step_now_json(*run, now);
  json["messages"] = Json::array();
  for (const network::Event& event : bench.events) {
    json["messages"].push_back(event_json(event));
  }
  return json;
}

Json laboratory_json(const network::BusState& laboratory) {
  const Instant now = laboratory.clock().now();
  Json json = with_time(laboratory, laboratory.number());
  json["software"] = software_version();
  json["benches"] = Json::array();
  for (const auto& [name, bench] : laboratory.benches()) {
    json["benches"].push_back(bench_tile_json(laboratory, bench));
  }
  json["programs"] = Json::array();
  for (const DiscoveredProgram& program : laboratory.programs()) {
    json["programs"].push_back(program_json(laboratory, program, now));
  }
  json["events"] = Json::array();
  for (const network::Event& event : laboratory.events()) {
    json["events"].push_back(event_json(event));
  }
  return json;
}

} // namespace dyncal::inline views::live
