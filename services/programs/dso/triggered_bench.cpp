#include "services/programs/dso/triggered_bench.hpp"

#include <algorithm>
#include <utility>

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include "analysis/base/frequency.hpp"
#include "drivers/link/scpi_answer.hpp"
#include "drivers/utc_clock.hpp"
#include "services/contract/session_number.hpp"
#include "services/contract/topics.hpp"
#include "services/instruments/series_channels.hpp"

namespace dyncal::inline programs::dso {
namespace {

using namespace std::chrono_literals;

constexpr auto idle_wait = 100ms;
constexpr auto retry_wait = 500ms; // after a shot that failed

template <class Driver>
const SourceSettings* source_with(const BenchFile& bench) {
  const auto found = std::ranges::find_if(
      bench.sources, [](const SourceSettings& source) { return source.is<Driver>(); });
  return found == bench.sources.end() ? nullptr : &*found;
}

struct Publishers {
  std::shared_ptr<SourcePublisher> oscilloscope;
  std::shared_ptr<SourcePublisher> sensor;
};

// Records of the two sources belong together by session and shot.
Expected<Publishers> add_sources(SourceService& service, const BenchFile& bench,
                                 const SourceSettings& oscilloscope, const SourceSettings& sensor,
                                 RingLimits ring) {
  SourceOptions options{.bench = bench.bench,
                        .source = oscilloscope.name,
                        .kind = SourceKind::dso,
                        .identity = oscilloscope.identity,
                        .origin = oscilloscope.origin,
                        .silent_after = 0s,
                        .ring = ring,
                        .session = random_session()};
  DYNCAL_TRY(auto first, service.add(options));
  options.source = sensor.name;
  options.kind = SourceKind::tss;
  options.identity = sensor.identity;
  options.origin = sensor.origin;
  DYNCAL_TRY(auto second, service.add(options));
  return Publishers{std::move(first), std::move(second)};
}

} // namespace

Expected<std::unique_ptr<TriggeredBench>> TriggeredBench::create(bus::Participant& participant,
                                                                 SourceService& service,
                                                                 const BenchFile& bench,
                                                                 RingLimits ring) {
  const SourceSettings* oscilloscope = source_with<OscilloscopeSourceSettings>(bench);
  const SourceSettings* sensor = source_with<SeriesSourceSettings>(bench);
  if (oscilloscope == nullptr || sensor == nullptr) {
    return fail(
        ErrorCode::bad_file,
        fmt::format("{}: dyncal-dso needs a source with driver = \"oscilloscope\" and one with "
                    "driver = \"series\"",
                    bench.path.string()));
  }
  if (oscilloscope->as<OscilloscopeSourceSettings>()->address.empty()) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: source '{}' has no address; files of shots are for dyncal analyse",
                            oscilloscope->where, oscilloscope->name));
  }
  auto wake_up = std::make_shared<bus::WakeUp>();
  DYNCAL_TRY(auto excitation,
             participant.reader<wire::Excitation>(bus::topics::excitation, bus::Profile::state,
                                                  bench.bench, wake_up));
  DYNCAL_TRY(auto publishers, add_sources(service, bench, *oscilloscope, *sensor, ring));
  return std::unique_ptr<TriggeredBench>(new TriggeredBench(
      bench, Source{*oscilloscope, std::move(publishers.oscilloscope)},
      Source{*sensor, std::move(publishers.sensor)}, std::move(excitation), std::move(wake_up)));
}

TriggeredBench::TriggeredBench(const BenchFile& bench, Source oscilloscope, Source sensor,
                               bus::Reader<wire::Excitation> excitation,
                               std::shared_ptr<bus::WakeUp> wake_up)
    : bench_(bench.bench), oscilloscope_(std::move(oscilloscope)), sensor_(std::move(sensor)),
      shots_wanted_(bench.method.shots),
      first_frequency_hz_(analysis::Frequency::parse(bench.excitation.frequencies_hz.front())
                              ->hz()), // the bench file was checked
      excitation_(std::move(excitation)), wake_up_(std::move(wake_up)),
      device_(*oscilloscope_.settings.as<OscilloscopeSourceSettings>(),
              *sensor_.settings.as<SeriesSourceSettings>(), device_stop_) {
  for (const ChannelName& channel : bench.method.dut) {
    if (channel.source == sensor_.settings.name) {
      sensor_channels_.push_back(channel.channel);
    }
  }
}

void TriggeredBench::run(const std::stop_token& stop) {
  const std::stop_callback stop_devices(stop, [this] {
    device_stop_.raise();
    wake_up_->ring();
  });
  while (!stop.stop_requested()) {
    follow_excitation();
    if (!connected_) {
      try_to_connect();
    }
    if (connected_ && step_ && step_->shots < shots_wanted_) {
      take_shot();
    } else {
      wake_up_->wait_until(std::chrono::steady_clock::now() +
                           (connected_ ? idle_wait : retry_wait));
    }
    report();
  }
  for (const Source* source : {&oscilloscope_, &sensor_}) {
    source->publisher->set_message("");
    source->publisher->end();
  }
}

void TriggeredBench::report() {
  const std::string& message = connection_problem_.empty() ? shot_problem_ : connection_problem_;
  for (const Source* source : {&oscilloscope_, &sensor_}) {
    source->publisher->count(counts_);
    source->publisher->set_message(message);
    source->publisher->set_reachable(connected_);
  }
}

void TriggeredBench::follow_excitation() {
  excitation_.take([&](const wire::Excitation& excitation) { follow(excitation); });
}

void TriggeredBench::follow(const wire::Excitation& excitation) {
  const std::string run = excitation.run().to_string();
  if (excitation.state() != wire::EXCITATION_STEADY) {
    // Only the newest state is kept on the way: whatever is not steady ends the step of its run, be
    // it that step's end or the next one.
    if (step_ && step_->run == run) {
      step_.reset();
    }
    return;
  }
  const auto frequency = analysis::Frequency::parse(excitation.frequency_text_hz());
  if (frequency && !in_step(run, excitation.step(), excitation.attempt())) {
    step_ = Step{run, excitation.step(), excitation.attempt(), frequency->hz(), 0};
    shot_problem_.clear();
  }
}

bool TriggeredBench::in_step(const std::string& run, std::uint32_t step,
                             std::uint32_t attempt) const {
  return step_ && step_->run == run && step_->step == step && step_->attempt == attempt;
}

void TriggeredBench::try_to_connect() {
  const auto connected = device_.connect(step_ ? step_->frequency_hz : first_frequency_hz_);
  if (!connected) {
    if (connection_problem_ != connected.error().message) {
      spdlog::warn("bench {}: {}", bench_, connected.error().message);
    }
    connection_problem_ = connected.error().message;
    return;
  }
  if (!oscilloscope_.described || !connection_problem_.empty()) {
    spdlog::info("bench {}: {} is ready", bench_, device_.oscilloscope_identity());
  }
  connected_ = true;
  connection_problem_.clear();
  describe_oscilloscope();
  if (!sensor_.described) {
    describe_sensor({});
  }
}

void TriggeredBench::describe_oscilloscope() {
  drivers::SourceDescription description;
  const auto identity = drivers::parse_instrument_identity(device_.oscilloscope_identity());
  description.device = identity.device;
  description.serial = identity.serial;
  description.firmware = identity.firmware;
  description.driver = "oscilloscope";
  description.stamp_instant = drivers::StampInstant::trigger_edge;
  description.channels.push_back({.name = "sync", .quantity = "Voltage", .unit = R"(\volt)"});
  oscilloscope_.publisher->describe(description);
  oscilloscope_.described = true;
}

// Before the first series only the names of the channels are known.
void TriggeredBench::describe_sensor(const drivers::tss::Series& series) {
  drivers::SourceDescription description;
  description.device = series.device;
  description.serial = series.serial;
  description.firmware = series.firmware;
  description.driver = "series";
  description.stamp_instant = drivers::StampInstant::trigger_edge;
  description.nominal_rate_hz = series.nominal_rate_hz;
  for (std::size_t i = 0; i < sensor_channels_.size(); ++i) {
    drivers::ChannelDescription channel =
        i < series.channels.size() ? series.channels[i] : drivers::ChannelDescription{};
    channel.name = sensor_channels_[i];
    if (const auto unit = sensor_.settings.units.find(channel.name);
        unit != sensor_.settings.units.end()) {
      channel.unit = unit->second;
    }
    description.channels.push_back(std::move(channel));
  }
  sensor_.publisher->describe(description);
  sensor_.described = true;
}

void TriggeredBench::take_shot() {
  const Step step = *step_;
  auto taken = device_.take(step.frequency_hz);
  if (taken && !*taken) {
    spdlog::info("bench {}: the first shot after a start is left out; it tells how many triggers "
                 "the sensor has counted",
                 bench_);
    return;
  }
  auto pair = taken ? with_bench_channels(std::move(**taken)) : fail(taken.error());
  follow_excitation();
  if (pair && !in_step(step.run, step.step, step.attempt)) {
    pair = fail(ErrorCode::device, "the excitation ended during the shot, which is left out");
  }
  ++counts_.received;
  if (!pair) {
    reject_shot(step, pair.error().message);
  } else if (publish(std::move(*pair), step)) {
    ++step_->shots;
  }
}

Expected<ShotPair> TriggeredBench::with_bench_channels(ShotPair pair) const {
  DYNCAL_TRY(auto selected,
             select_channels(std::move(pair.series), sensor_.settings.channels, sensor_channels_));
  return ShotPair{std::move(pair.trace), std::move(selected)};
}

void TriggeredBench::reject_shot(const Step& step, const std::string& reason) {
  shot_problem_ = reason;
  spdlog::warn("bench {}, run {}, step {}: {}", bench_, step.run, step.step, reason);
  ++counts_.rejected;
  connected_ = false;
  try_to_connect(); // finds out whether the devices can still be reached
  wake_up_->wait_until(std::chrono::steady_clock::now() + retry_wait);
}

// Returns false if the network has taken nothing for so long that there is no room for the pair.
bool TriggeredBench::publish(ShotPair pair, const Step& step) {
  describe_sensor(pair.series);
  Shot shot{.number = ++shot_,
            .run = step.run,
            .step = step.step,
            .attempt = step.attempt,
            .trigger_utc_ns = pair.trace.triggered_utc_ns,
            .first_sample_s = 0.0,
            .interval_s = 1.0 / pair.series.nominal_rate_hz};
  drivers::SampleBlock series;
  series.samples = pair.series.samples;
  series.values = std::move(pair.series.values);
  series.received_utc_ns = utc_now_ns();
  Shot of_trace = shot;
  of_trace.first_sample_s = pair.trace.first_sample_s;
  of_trace.interval_s = pair.trace.interval_s;
  drivers::SampleBlock trace;
  trace.values = std::move(pair.trace.traces.front().volts);
  trace.samples = trace.values.size();
  trace.received_utc_ns = series.received_utc_ns;
  const bool trace_taken =
      oscilloscope_.publisher->take_shot(std::move(of_trace), std::move(trace));
  const bool series_taken = sensor_.publisher->take_shot(std::move(shot), std::move(series));
  if (!trace_taken || !series_taken) {
    shot_problem_ =
        fmt::format("shot {} was dropped: the network does not take the records", shot_.load());
    spdlog::error("bench {}: {}", bench_, shot_problem_);
    wake_up_->wait_until(std::chrono::steady_clock::now() + retry_wait);
  }
  return trace_taken && series_taken;
}

} // namespace dyncal::inline programs::dso
