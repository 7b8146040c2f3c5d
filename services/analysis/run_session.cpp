#include "services/analysis/run_session.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "drivers/utc_clock.hpp"
#include "services/contract/topics.hpp"
#include "services/version.hpp"

namespace dyncal::services {
namespace {

using namespace std::chrono_literals;

constexpr auto command_interval = 250ms;
constexpr auto status_interval = 1s;

const char* samples_topic(wire::SourceKind kind) {
  switch (kind) {
  case wire::SOURCE_DAU:
    return bus::topics::dau_samples;
  case wire::SOURCE_CAN:
    return bus::topics::can_samples;
  default:
    return bus::topics::acs_samples;
  }
}

std::string why(const KnownSource* source) {
  if (source == nullptr || !source->status || source->status->message().empty()) {
    return "";
  }
  return ": " + source->status->message();
}

} // namespace

Expected<std::unique_ptr<RunSession>> RunSession::create(bus::Participant& participant,
                                                         std::shared_ptr<bus::WakeUp> wake_up,
                                                         const AnalysisIdentity& identity,
                                                         const wire::Measurement& measurement,
                                                         Clock::time_point now) {
  std::unique_ptr<RunSession> session(
      new RunSession(participant, std::move(wake_up), identity, measurement, now));
  if (auto opened = session->open_writers(); !opened) {
    return fail(opened.error());
  }
  auto recipe = parse_recipe(measurement);
  if (!recipe) {
    session->refuse(recipe.error().message);
    return session;
  }
  for (const std::string& source : recipe->sources()) {
    session->links_.emplace(source, SourceLink{});
  }
  session->evaluator_ = std::make_unique<RunEvaluator>(std::move(*recipe));
  spdlog::info("bench {}, run {}: {} steps planned, waiting for its sources", session->bench_,
               session->run_, measurement.steps().size());
  session->publish_status();
  return session;
}

RunSession::RunSession(bus::Participant& participant, std::shared_ptr<bus::WakeUp> wake_up,
                       const AnalysisIdentity& identity, const wire::Measurement& measurement,
                       Clock::time_point now)
    : participant_(participant), wake_up_(std::move(wake_up)), identity_(identity),
      bench_(measurement.bench().to_string()), run_(measurement.run().to_string()),
      state_(measurement.state()), created_(now), last_heard_of_run_(now), last_progress_(now),
      next_command_(now), next_status_(now + status_interval) {}

Expected<void> RunSession::open_writers() {
  const auto open = [&](auto& place, const char* topic, bus::Profile profile) -> Expected<void> {
    using Message = typename std::remove_reference_t<decltype(*place)>::Message;
    auto writer = participant_.writer<Message>(topic, profile, bench_);
    if (!writer) {
      return fail(writer.error());
    }
    place.emplace(std::move(*writer));
    return {};
  };
  return open(status_writer_, bus::topics::service_status, bus::Profile::state)
      .and_then([&] { return open(command_writer_, bus::topics::command, bus::Profile::command); })
      .and_then([&] {
        return open(result_writer_, bus::topics::calibration_result, bus::Profile::results);
      })
      .and_then([&] {
        return open(transfer_writer_, bus::topics::transfer_function, bus::Profile::results);
      })
      .and_then([&] {
        return open(clock_writer_, bus::topics::sample_clock_report, bus::Profile::results);
      });
}

void RunSession::update(const wire::Measurement& measurement, Clock::time_point now) {
  last_heard_of_run_ = now;
  if (measurement.state() == state_) {
    return;
  }
  state_ = measurement.state();
  if (evaluator_ && (state_ == wire::MEASUREMENT_DONE || state_ == wire::MEASUREMENT_ABORTED)) {
    spdlog::info("bench {}, run {}: {}", bench_, run_,
                 state_ == wire::MEASUREMENT_DONE ? "excitation done" : "broken off");
    evaluator_->end_of_excitation(state_ == wire::MEASUREMENT_ABORTED);
    if (health_ == wire::HEALTH_FAILED) {
      evaluator_->finish_now(); // a source is gone: nothing more will come
    }
    last_progress_ = now;
  }
}

void RunSession::announce(const wire::Excitation& excitation) {
  excited_by_steps_ = true;
  if (evaluator_) {
    evaluator_->announce(excitation);
  }
}

void RunSession::work(const KnownSources& sources, Clock::time_point now) {
  if (finished() || !evaluator_) {
    return;
  }
  take_descriptions(sources);
  take_samples(now);
  if (!finished() && arm_ == wire::ARM_WAITING) {
    arm(sources, now);
  }
  if (!finished() && arm_ == wire::ARM_ARMED) {
    watch_sources(now);
    evaluate(now);
  }
  if (now >= next_status_) {
    publish_status();
    next_status_ = now + status_interval;
  }
}

void RunSession::take_descriptions(const KnownSources& sources) {
  for (auto& [name, link] : links_) {
    const auto known = sources.find(name);
    if (known == sources.end() || !known->second.description ||
        known->second.description == link.description) {
      continue;
    }
    const wire::SourceDescription& description = *known->second.description;
    const bool only_told_more =
        link.description && link.description->session() == description.session() && !link.triggered;
    link.description = description;
    if (only_told_more) {
      continue; // what its samples mean was known from the beginning
    }
    if (const auto described = evaluator_->describe(description); !described) {
      refuse(described.error().message);
      return;
    }
    link.described = true;
    link.triggered =
        description.kind() == wire::SOURCE_DSO || description.kind() == wire::SOURCE_TSS;
    if (link.triggered) {
      open_record_reader(description.kind());
    } else {
      open_reader(description.kind());
    }
  }
}

void RunSession::open_reader(wire::SourceKind kind) {
  if (readers_.contains(kind)) {
    return;
  }
  auto reader = participant_.reader<wire::SampleBlock>(samples_topic(kind), bus::Profile::samples,
                                                       bench_, wake_up_);
  if (!reader) {
    refuse(reader.error().message);
    return;
  }
  readers_.emplace(kind, std::move(*reader));
}

void RunSession::open_record_reader(wire::SourceKind kind) {
  if (record_readers_.contains(kind)) {
    return;
  }
  const char* topic = kind == wire::SOURCE_DSO ? bus::topics::dso_record : bus::topics::tss_record;
  auto reader =
      participant_.reader<wire::TriggeredRecord>(topic, bus::Profile::samples, bench_, wake_up_);
  if (!reader) {
    refuse(reader.error().message);
    return;
  }
  record_readers_.emplace(kind, std::move(*reader));
}

void RunSession::take_samples(Clock::time_point now) {
  for (auto& entry : readers_) {
    entry.second.take([&](const wire::SampleBlock& block, const bus::SampleInfo& info) {
      if (info.valid) {
        take_block(block, now);
      }
    });
  }
  for (auto& entry : record_readers_) {
    entry.second.take([&](const wire::TriggeredRecord& record, const bus::SampleInfo& info) {
      SourceLink* link =
          info.valid ? link_of(record.source().to_string(), record.acknowledged_run()) : nullptr;
      if (link != nullptr) {
        link->last_block = now;
        link->ended = record.end_of_stream();
        evaluator_->add(record);
      }
    });
  }
}

// Nothing when the source is not of this run, or has not answered yet.
RunSession::SourceLink* RunSession::link_of(const std::string& source,
                                            const std::string& answers_run) {
  const auto link = links_.find(source);
  if (link == links_.end()) {
    return nullptr;
  }
  link->second.answered = link->second.answered || answers_run == run_;
  return link->second.answered ? &link->second : nullptr;
}

void RunSession::take_block(const wire::SampleBlock& block, Clock::time_point now) {
  SourceLink* link = link_of(block.source().to_string(), block.acknowledged_run());
  if (link != nullptr) {
    link->last_block = now;
    link->ended = block.end_of_stream();
    evaluator_->add(block);
  }
}

void RunSession::arm(const KnownSources& sources, Clock::time_point now) {
  if (now >= next_command_) {
    next_command_ = now + command_interval;
    for (const auto& [name, link] : links_) {
      if (link.described && !link.answered) {
        wire::Command command;
        command.target(name);
        command.kind(wire::COMMAND_ARM);
        command.bench(bench_);
        command.run(run_);
        command.sender(identity_.service);
        write(command_writer_, command);
      }
    }
  }
  const std::string missing = what_is_missing(sources);
  if (missing.empty()) {
    arm_ = wire::ARM_ARMED;
    last_progress_ = now;
    spdlog::info("bench {}, run {}: armed", bench_, run_);
    publish_status();
  } else if (now - created_ > arm_limit) {
    refuse(missing);
  }
}

std::string RunSession::what_is_missing(const KnownSources& sources) const {
  for (const auto& [name, link] : links_) {
    const auto known = sources.find(name);
    const KnownSource* source = known == sources.end() ? nullptr : &known->second;
    if (source == nullptr) {
      return fmt::format("source '{}' of bench '{}' is not on the network; is its service running "
                         "with this bench file, in the same DDS domain?",
                         name, bench_);
    }
    const bool silent = source->status && (source->status->state() == wire::SOURCE_SILENT ||
                                           source->status->state() == wire::SOURCE_FAILED);
    if (silent) {
      return fmt::format("source '{}' of bench '{}' is silent{}", name, bench_, why(source));
    }
    if (!link.described) {
      return fmt::format("source '{}' of bench '{}' has not described its channels yet{}", name,
                         bench_, why(source));
    }
    if (!link.answered) {
      return fmt::format("source '{}' of bench '{}' does not answer in its sample stream; do "
                         "samples get through from its host to this one?",
                         name, bench_);
    }
  }
  return "";
}

void RunSession::watch_sources(Clock::time_point now) {
  if (state_ != wire::MEASUREMENT_RUNNING || health_ != wire::HEALTH_OK ||
      now - last_heard_of_run_ > runner_limit) {
    return;
  }
  for (const auto& [name, link] : links_) {
    if (link.ended && excited_by_steps_) {
      report_failure(
          fmt::format("source '{}' of bench '{}' has ended before the run", name, bench_));
    } else if (!link.ended && !link.triggered &&
               now - std::max(link.last_block, last_progress_) > silence_limit) {
      report_failure(fmt::format("source '{}' of bench '{}' has sent nothing for {} s", name,
                                 bench_, silence_limit.count()));
    }
  }
}

void RunSession::report_failure(std::string message) {
  if (health_ == wire::HEALTH_FAILED) {
    return; // the first cause explains the others
  }
  health_ = wire::HEALTH_FAILED;
  message_ = std::move(message);
  spdlog::warn("bench {}, run {}: {}", bench_, run_, message_);
  publish_status();
}

void RunSession::evaluate(Clock::time_point now) {
  EvaluationOutput output = evaluator_->take_output();
  for (const wire::CalibrationResult& result : output.results) {
    last_progress_ = now;
    if (!result.valid()) {
      spdlog::warn("bench {}, run {}, step {}, {}: {}", bench_, run_, result.step(),
                   result.channel().c_str(), result.problem());
    }
    write(result_writer_, result);
    ++results_published_;
  }
  for (const wire::TransferFunction& function : output.transfer_functions) {
    write(transfer_writer_, function);
    ++transfer_functions_published_;
  }
  for (const wire::SampleClockReport& report : output.clock_reports) {
    write(clock_writer_, report);
    ++clock_reports_published_;
  }
  if (evaluator_->finished()) {
    arm_ = wire::ARM_FINISHED;
    readers_.clear();
    record_readers_.clear();
    evaluator_.reset();
    spdlog::info("bench {}, run {}: finished, {} results", bench_, run_, results_published_);
    publish_status();
    return;
  }
  const bool over = state_ == wire::MEASUREMENT_DONE || state_ == wire::MEASUREMENT_ABORTED;
  const bool runner_gone = now - last_heard_of_run_ > runner_limit;
  if ((over && now - last_progress_ > quiet_limit) || runner_gone) {
    if (runner_gone) {
      spdlog::warn(
          "bench {}, run {}: nothing heard of the run for {} s; it ends with what there is", bench_,
          run_, runner_limit.count());
    }
    evaluator_->end_of_excitation(runner_gone);
    evaluator_->finish_now();
    wake_up_->ring();
  }
}

void RunSession::refuse(std::string message) {
  arm_ = wire::ARM_REFUSED;
  health_ = wire::HEALTH_FAILED;
  message_ = std::move(message);
  spdlog::warn("bench {}, run {}: refused: {}", bench_, run_, message_);
  readers_.clear();
  record_readers_.clear();
  publish_status();
}

void RunSession::publish_status() {
  wire::ServiceStatus status;
  status.service(identity_.service);
  status.run(run_);
  status.bench(bench_);
  status.health(health_);
  status.arm(arm_);
  status.message(message_);
  status.software(software_version());
  status.dds(identity_.dds);
  status.host(identity_.host);
  status.process_id(identity_.process_id);
  status.published_utc_ns(utc_now_ns());
  status.results_published(results_published_);
  status.transfer_functions_published(transfer_functions_published_);
  status.clock_reports_published(clock_reports_published_);
  status.contract_version(wire::CONTRACT_VERSION);
  write(status_writer_, status);
}

template <class T>
void RunSession::write(std::optional<bus::Writer<T>>& writer, const T& message) {
  if (writer->write(message) != bus::WriteOutcome::written) {
    spdlog::error("bench {}, run {}: a message could not be written to the network", bench_, run_);
  }
}

} // namespace dyncal::services
