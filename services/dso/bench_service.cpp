#include "services/dso/bench_service.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "analysis/base/frequency.hpp"
#include "drivers/utc_clock.hpp"
#include "services/contract/session_number.hpp"
#include "services/contract/topics.hpp"
#include "services/dso/series_channels.hpp"

namespace dyncal::services::dso {
namespace {

using namespace std::chrono_literals;

constexpr auto idle_wait = 100ms;
constexpr auto retry_wait = 500ms; // after a shot that failed

const SourceSettings* source_with(const BenchFile& bench, SourceDriver driver) {
  const auto found =
      std::find_if(bench.sources.begin(), bench.sources.end(),
                   [&](const SourceSettings& source) { return source.driver == driver; });
  return found == bench.sources.end() ? nullptr : &*found;
}

wire::ChannelDescription channel_message(const std::string& name, const std::string& quantity,
                                         const std::string& unit, double resolution) {
  wire::ChannelDescription channel;
  channel.name(name);
  channel.quantity(quantity);
  channel.unit(unit);
  channel.resolution(resolution);
  return channel;
}

} // namespace

Expected<std::unique_ptr<BenchService>> BenchService::create(bus::Participant& participant,
                                                             const BenchFile& bench) {
  const SourceSettings* oscilloscope = source_with(bench, SourceDriver::oscilloscope);
  const SourceSettings* sensor = source_with(bench, SourceDriver::series);
  if (oscilloscope == nullptr || sensor == nullptr) {
    return fail(
        ErrorCode::bad_file,
        fmt::format("{}: dyncal-dso needs a source with driver = \"oscilloscope\" and one with "
                    "driver = \"series\"",
                    bench.path.string()));
  }
  if (oscilloscope->address.empty()) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: source '{}' has no address; files of shots are for dyncal analyse",
                            oscilloscope->where, oscilloscope->name));
  }
  const std::uint64_t session = random_session();
  auto wake_up = std::make_shared<bus::WakeUp>();
  auto excitation = participant.reader<wire::Excitation>(bus::topics::excitation,
                                                         bus::Profile::state, bench.bench, wake_up);
  auto command = participant.reader<wire::Command>(bus::topics::command, bus::Profile::command,
                                                   bench.bench, wake_up);
  auto traces = RecordWriter::create(participant, bench.bench, oscilloscope->name,
                                     bus::topics::dso_record, wire::SOURCE_DSO, session);
  auto series = RecordWriter::create(participant, bench.bench, sensor->name,
                                     bus::topics::tss_record, wire::SOURCE_TSS, session);
  if (const auto error = first_error(excitation, command, traces, series)) {
    return fail(*error);
  }
  return std::unique_ptr<BenchService>(
      new BenchService(bench, *oscilloscope, *sensor, std::move(wake_up),
                       Endpoints{std::move(*excitation), std::move(*command), std::move(*traces),
                                 std::move(*series)}));
}

BenchService::BenchService(const BenchFile& bench, const SourceSettings& oscilloscope,
                           const SourceSettings& sensor, std::shared_ptr<bus::WakeUp> wake_up,
                           Endpoints endpoints)
    : bench_(bench.bench), oscilloscope_settings_(oscilloscope), sensor_settings_(sensor),
      shots_wanted_(bench.method.shots),
      first_frequency_hz_(analysis::Frequency::parse(bench.excitation.frequencies_hz.front())
                              ->hz()), // the bench file was checked
      wake_up_(std::move(wake_up)), endpoints_(std::move(endpoints)),
      device_(oscilloscope_settings_, sensor_settings_, device_stop_) {
  for (const ChannelName& channel : bench.method.dut) {
    if (channel.source == sensor.name) {
      sensor_channels_.push_back(channel.channel);
    }
  }
}

void BenchService::run(const std::stop_token& stop) {
  const std::stop_callback stop_devices(stop, [this] {
    device_stop_.raise();
    wake_up_->ring();
  });
  while (!stop.stop_requested()) {
    take_messages();
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
  endpoints_.oscilloscope.end();
  endpoints_.sensor.end();
}

void BenchService::report() {
  const wire::SourceState state = connected_ ? wire::SOURCE_RUNNING : wire::SOURCE_SILENT;
  const std::string& message = connection_problem_.empty() ? shot_problem_ : connection_problem_;
  const auto now = std::chrono::steady_clock::now();
  endpoints_.oscilloscope.status(state, message, now);
  endpoints_.sensor.status(state, message, now);
}

void BenchService::take_messages() {
  endpoints_.excitation.take([&](const wire::Excitation& excitation, const bus::SampleInfo& info) {
    if (info.valid) {
      follow(excitation);
    }
  });
  endpoints_.command.take([&](const wire::Command& command, const bus::SampleInfo& info) {
    if (!info.valid || command.kind() != wire::COMMAND_ARM || command.bench() != bench_) {
      return;
    }
    if (command.target().to_string() == oscilloscope_settings_.name &&
        endpoints_.oscilloscope.described()) {
      endpoints_.oscilloscope.answer(command.run());
    }
    if (command.target().to_string() == sensor_settings_.name && endpoints_.sensor.described()) {
      endpoints_.sensor.answer(command.run());
    }
  });
}

void BenchService::follow(const wire::Excitation& excitation) {
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
  if (frequency && !in_step(run, excitation.step())) {
    step_ = Step{run, excitation.step(), frequency->hz(), 0};
    shot_problem_.clear();
  }
}

bool BenchService::in_step(const std::string& run, std::uint32_t step) const {
  return step_ && step_->run == run && step_->step == step;
}

void BenchService::try_to_connect() {
  const auto connected = device_.connect(step_ ? step_->frequency_hz : first_frequency_hz_);
  if (!connected) {
    if (connection_problem_ != connected.error().message) {
      spdlog::warn("bench {}: {}", bench_, connected.error().message);
    }
    connection_problem_ = connected.error().message;
    return;
  }
  if (!endpoints_.oscilloscope.described() || !connection_problem_.empty()) {
    spdlog::info("bench {}: {} is ready", bench_, device_.oscilloscope_identity());
  }
  connected_ = true;
  connection_problem_.clear();
  wire::SourceDescription oscilloscope;
  oscilloscope.device(device_.oscilloscope_identity());
  oscilloscope.driver("oscilloscope");
  oscilloscope.channels().push_back(channel_message("sync", "Voltage", R"(\volt)", 0.0));
  endpoints_.oscilloscope.describe(std::move(oscilloscope));
  if (!endpoints_.sensor.described()) {
    describe_sensor({});
  }
}

void BenchService::take_shot() {
  const Step step = *step_;
  auto pair = device_.take(step.frequency_hz);
  if (pair) {
    auto selected =
        select_channels(std::move(pair->series), sensor_settings_.channels, sensor_channels_);
    pair = selected ? Expected<ShotPair>(ShotPair{std::move(pair->trace), std::move(*selected)})
                    : fail(selected.error());
  }
  take_messages();
  if (pair && !in_step(step.run, step.step)) {
    pair = fail(ErrorCode::device, "the excitation ended during the shot, which is left out");
  }
  if (!pair) {
    shot_problem_ = pair.error().message;
    spdlog::warn("bench {}, run {}, step {}: {}", bench_, step.run, step.step, shot_problem_);
    endpoints_.oscilloscope.count_rejected();
    endpoints_.sensor.count_rejected();
    connected_ = false;
    try_to_connect(); // says whether the devices can still be reached
    wake_up_->wait_until(std::chrono::steady_clock::now() + retry_wait);
    return;
  }
  ++step_->shots;
  publish(*pair, step);
}

// Before the first series only the names of the channels are known.
void BenchService::describe_sensor(const drivers::tss::Series& series) {
  wire::SourceDescription description;
  description.device(series.device);
  description.serial(series.serial);
  description.driver("series");
  description.nominal_rate_hz(series.nominal_rate_hz);
  for (std::size_t i = 0; i < sensor_channels_.size(); ++i) {
    const drivers::ChannelDescription channel =
        i < series.channels.size() ? series.channels[i] : drivers::ChannelDescription{};
    const auto unit = sensor_settings_.units.find(sensor_channels_[i]);
    description.channels().push_back(channel_message(
        sensor_channels_[i], channel.quantity,
        unit == sensor_settings_.units.end() ? channel.unit : unit->second, channel.resolution));
  }
  endpoints_.sensor.describe(std::move(description));
}

void BenchService::publish(ShotPair& pair, const Step& step) {
  describe_sensor(pair.series);
  ++shot_;
  const auto record = [&](std::size_t samples, std::size_t channels, double interval_s,
                          std::vector<double>& values) {
    wire::TriggeredRecord message;
    message.shot(shot_);
    message.run(step.run);
    message.step(step.step);
    message.trigger_utc_ns(pair.trace.triggered_utc_ns);
    message.interval_s(interval_s);
    message.sample_count(static_cast<std::uint32_t>(samples));
    message.channel_count(static_cast<std::uint32_t>(channels));
    message.values(std::move(values));
    message.received_utc_ns(utc_now_ns());
    return message;
  };
  std::vector<double>& volts = pair.trace.traces.front().volts;
  const std::size_t points = volts.size();
  wire::TriggeredRecord trace = record(points, 1, pair.trace.interval_s, volts);
  trace.first_sample_s(pair.trace.first_sample_s);
  wire::TriggeredRecord series = record(pair.series.samples, sensor_channels_.size(),
                                        1.0 / pair.series.nominal_rate_hz, pair.series.values);
  if (!endpoints_.oscilloscope.write(std::move(trace)) ||
      !endpoints_.sensor.write(std::move(series))) {
    spdlog::error("bench {}: shot {} could not be written to the network", bench_, shot_);
  }
}

} // namespace dyncal::services::dso
