#include "services/records/capture/bench_intake.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "services/contract/contract_versions.hpp"
#include "services/contract/number_in_source.hpp"
#include "services/contract/session_number.hpp"
#include "services/contract/source_kind.hpp"
#include "services/records/capture/recorded_topics.hpp"

namespace dyncal::inline records::recording {
namespace {

using base::Expected;

constexpr std::chrono::milliseconds request_write_limit{50}; // it is repeated
// Answers to the ARM command reach everybody about when the run begins.
constexpr std::chrono::seconds beginning_patience{1};
constexpr std::size_t max_runs = 1000; // that are remembered

template <class T>
std::string run_of(const T& message) {
  if constexpr (requires { message.run().to_string(); } && !is_of_source<T>) {
    return message.run().to_string();
  } else {
    return "";
  }
}

template <class T>
constexpr bool is_result =
    std::is_same_v<T, wire::CalibrationResult> || std::is_same_v<T, wire::TransferFunction> ||
    std::is_same_v<T, wire::SampleClockReport>;

void remember(std::set<std::string>& names, const std::string& name) {
  if (names.size() < max_runs) {
    names.insert(name);
  }
}

} // namespace

BenchIntake::BenchIntake(bus::Participant& participant, bus::Clock& clock, std::string bench,
                         std::string run, std::shared_ptr<bus::WakeUp> wake_up, Sink sink)
    : participant_(participant), clock_(clock), bench_(std::move(bench)), only_run_(std::move(run)),
      reads_results_of_bench_(only_run_.empty()),
      asker_(fmt::format("{}/recorder/{:016x}", bench_, contract::random_session())),
      wake_up_(std::move(wake_up)), sink_(std::move(sink)) {}

Expected<std::unique_ptr<BenchIntake>>
BenchIntake::open(bus::Participant& participant, bus::Clock& clock, std::string bench,
                  std::string run, std::shared_ptr<bus::WakeUp> wake_up, Sink sink) {
  std::unique_ptr<BenchIntake> intake(new BenchIntake(
      participant, clock, std::move(bench), std::move(run), std::move(wake_up), std::move(sink)));
  DYNCAL_TRY(intake->open_readers());
  return intake;
}

Expected<void> BenchIntake::open_readers() {
  DYNCAL_TRY(auto requests, participant_.writer(bus::topics::catch_up_request, bench_));
  requests_.emplace(std::move(requests));
  Expected<void> opened;
  for_each_recorded_topic([&]<class T>(const bus::Topic<T>& topic) {
    if (opened) {
      opened = open_reader(topic);
    }
  });
  return opened;
}

template <class T>
Expected<void> BenchIntake::open_reader(const bus::Topic<T>& topic) {
  const auto profile = is_of_source<T> ? bus::Profile::live_samples : topic.profile;
  DYNCAL_TRY(auto reader, is_result<T> && !reads_results_of_bench_
                              ? participant_.reader_of_run(topic, bench_, only_run_, wake_up_)
                              : participant_.reader<T>(topic.name, profile, bench_, wake_up_));
  readers_.push_back([this, &channel = channel_of(topic.name),
                      shared = std::make_shared<bus::Reader<T>>(std::move(reader))] {
    shared->take_with_bytes([&](const T& message, std::string_view bytes) {
      if (message.bench() == bench_) {
        take(channel, message, bytes);
      }
    });
  });
  return {};
}

void BenchIntake::take() {
  for (const auto& take_from_reader : readers_) {
    take_from_reader();
  }
  if (answers_) {
    const auto again = [&](const auto& message, std::string_view bytes) {
      take_again(message, bytes);
    };
    answers_->blocks.take_with_bytes(again);
    answers_->records.take_with_bytes(again);
  }
}

template <class T>
void BenchIntake::take(const Channel& channel, const T& message, std::string_view bytes) {
  if (const std::string run = run_of(message);
      !only_run_.empty() && !run.empty() && run != only_run_) {
    return;
  }
  if constexpr (std::is_same_v<T, wire::Measurement> ||
                std::is_same_v<T, wire::SourceDescription> ||
                std::is_same_v<T, wire::ServiceStatus>) {
    look_at(message);
  }
  if constexpr (is_of_source<T>) {
    Source& from = source(message.source().to_string());
    from.channel = &channel;
    if (!message.acknowledged_run().empty()) {
      remember(from.answered, message.acknowledged_run());
    }
    const std::uint64_t number = contract::number_in_source(message);
    const bool has_number = std::is_same_v<T, wire::SampleBlock> || number != 0;
    const SourceGaps::Place place{message.session(), number, contract::first_number(message)};
    if (has_number && !from.gaps.take_live(place, clock_.now())) {
      return;
    }
  }
  store(channel, message, bytes);
}

template <class T>
void BenchIntake::take_again(const T& message, std::string_view bytes) {
  const auto found =
      message.bench() == bench_ ? sources_.find(message.source().to_string()) : sources_.end();
  if (found == sources_.end()) {
    return;
  }
  Source& from = found->second;
  if (message.sample_count() == 0 && message.acknowledged_run().rfind(asker_, 0) == 0) {
    from.gaps.end_of_answer(message.acknowledged_run());
    return;
  }
  if (from.channel != nullptr &&
      from.gaps.take_again(message.session(), contract::number_in_source(message), clock_.now())) {
    store(*from.channel, message, bytes);
  }
}

template <class T>
void BenchIntake::store(const Channel& channel, const T& message, std::string_view bytes) {
  // What a program of another contract sent is brought into the form that the schema describes.
  const bool as_sent = bus::is_whole(bus::type_support<T>(), &message, bytes);
  const std::string encoded = as_sent ? "" : encode(message);
  const std::int64_t now_ns = clock_.utc_now_ns();
  const std::int64_t written_ns = written_utc_ns(message);
  TakenMessage taken{channel, {}, is_result<T>};
  taken.message.channel_id = channel.id;
  taken.message.log_time = static_cast<std::uint64_t>(now_ns);
  taken.message.publish_time = static_cast<std::uint64_t>(written_ns > 0 ? written_ns : now_ns);
  taken.message.data = as_sent ? bytes : std::string_view(encoded);
  if constexpr (is_of_source<T>) {
    taken.message.sequence = static_cast<std::uint32_t>(contract::number_in_source(message));
  } else {
    taken.message.sequence = ++counts_[channel.id];
  }
  sink_.store(taken);
}

void BenchIntake::look_at(const wire::Measurement& measurement) {
  const std::string name = measurement.run().to_string();
  if (!measurement.recipe().empty() && !attached_.contains(name)) {
    remember(attached_, name);
    sink_.attach({static_cast<std::uint64_t>(clock_.utc_now_ns()),
                  attached_.size() == 1 ? "recipe.toml" : fmt::format("recipe {}.toml", name),
                  "application/toml", measurement.recipe()});
  }
  if (measurement.state() != wire::MEASUREMENT_RUNNING) {
    if (run_ && run_->name == name) {
      run_->over = true;
    }
    return;
  }
  if (run_ && run_->name == name) {
    run_->over = false; // it may be resumed
    return;
  }
  run_ = Run{name, {}, clock_.now()};
  for (const wire::PlannedSource& planned : measurement.sources()) {
    run_->sources.push_back(planned.source());
  }
}

void BenchIntake::look_at(const wire::SourceDescription& description) {
  source(description.source().to_string()).channel =
      &channel_of(contract::sample_topic(contract::from_wire(description.kind())));
}

void BenchIntake::look_at(const wire::ServiceStatus& status) {
  const bool of_run = status.run() == only_run_;
  older_analysis_ = older_analysis_ ||
                    (of_run && status.contract_version() < contract_versions::partitions_of_runs);
}

// Those of the run have nothing to hear then.
Expected<void> BenchIntake::read_results_of_bench() {
  reads_results_of_bench_ = true;
  Expected<void> opened = open_reader(bus::topics::calibration_result);
  opened = opened ? open_reader(bus::topics::transfer_function) : opened;
  return opened ? open_reader(bus::topics::sample_clock_report) : opened;
}

BenchIntake::Source& BenchIntake::source(const std::string& name) {
  return sources_.try_emplace(name, fmt::format("{} {}", asker_, name)).first->second;
}

// Of a run whose beginning in a source was not heard.
void BenchIntake::ask_for_beginnings(Instant now) {
  if (!run_ || (!run_->over && now - run_->since < beginning_patience)) {
    return;
  }
  for (const std::string& name : run_->sources) {
    const auto found = sources_.find(name);
    if (found != sources_.end() && !found->second.answered.contains(run_->name) &&
        !found->second.asked_all.contains(run_->name)) {
      remember(found->second.asked_all, run_->name);
      found->second.gaps.ask_for_all(now);
    }
  }
}

bool BenchIntake::beginnings_are_asked_for() const {
  return std::ranges::all_of(run_->sources, [&](const std::string& name) {
    const auto found = sources_.find(name);
    return found != sources_.end() && (found->second.answered.contains(run_->name) ||
                                       found->second.asked_all.contains(run_->name));
  });
}

bool BenchIntake::catches_up() const {
  return (run_ && run_->over && !beginnings_are_asked_for()) ||
         std::ranges::any_of(sources_, [](const auto& one) { return one.second.gaps.waits(); });
}

Expected<void> BenchIntake::open_answer_readers() {
  DYNCAL_TRY(auto blocks, participant_.reader(bus::topics::catch_up_samples, asker_, wake_up_));
  DYNCAL_TRY(auto records, participant_.reader(bus::topics::catch_up_records, asker_, wake_up_));
  answers_.emplace(AnswerReaders{std::move(blocks), std::move(records)});
  return {};
}

Expected<void> BenchIntake::ask() {
  if (older_analysis_ && !reads_results_of_bench_) {
    DYNCAL_TRY(read_results_of_bench());
  }
  const Instant now = clock_.now();
  ask_for_beginnings(now);
  for (auto& [name, from] : sources_) {
    const auto due = from.gaps.due(now);
    if (!due) {
      continue;
    }
    if (!answers_) {
      DYNCAL_TRY(open_answer_readers());
    }
    wire::CatchUpRequest request;
    request.bench(bench_);
    request.source(name);
    request.asker(asker_);
    request.request(due->name);
    request.run(run_ ? run_->name : only_run_);
    request.session(due->session);
    request.after(due->number);
    requests_->write(request, request_write_limit);
  }
  if (run_ && run_->over && !catches_up()) {
    run_.reset();
  }
  return {};
}

TextMap BenchIntake::losses() const {
  TextMap losses;
  for (const auto& [name, from] : sources_) {
    losses[name + ".messages"] = fmt::format("{}", from.gaps.messages());
    losses[name + ".missing"] = fmt::format("{}", from.gaps.missing());
    losses[name + ".recovered"] = fmt::format("{}", from.gaps.recovered());
  }
  return losses;
}

std::uint64_t BenchIntake::missing() const {
  std::uint64_t missing = 0;
  for (const auto& [name, from] : sources_) {
    missing += from.gaps.missing();
  }
  return missing;
}

std::uint64_t BenchIntake::recovered() const {
  std::uint64_t recovered = 0;
  for (const auto& [name, from] : sources_) {
    recovered += from.gaps.recovered();
  }
  return recovered;
}

} // namespace dyncal::inline records::recording
