// One bench of dyncal-dso: follows the excitation of the bench's runs, takes shots while a step is
// steady, and publishes each as a pair of records, DsoRecord and TssRecord, with the same session
// and shot number.
//
// Per step `shots` pairs are taken, however often one fails in between, as long as the step is
// steady: a shot that fails is counted as rejected, named in the log and until the next step in the
// status of both sources, and repeated over new connections where these were lost. While the
// devices cannot be reached both sources are silent. Shot numbers count the pairs of a session from
// 1; each names its run and step. The sensor tells its device and units only with a series; its
// channels are those that the bench calibrates, from the beginning. run() belongs to one thread;
// `stop` may be requested from any.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "services/bench/bench_file.hpp"
#include "services/bus/bus.hpp"
#include "services/dso/record_writer.hpp"
#include "services/dso/shot_device.hpp"
#include "services/error.hpp"

#include "drivers/link/stop_signal.hpp"
#include "idl/dyncal.h"

namespace dyncal::services::dso {

class BenchService {
public:
  // Fails (bad_file) when the bench file has no oscilloscope or time series sensor, (network) when
  // the bus refuses.
  [[nodiscard]] static Expected<std::unique_ptr<BenchService>> create(bus::Participant& participant,
                                                                      const BenchFile& bench);

  void run(const std::stop_token& stop);

private:
  struct Endpoints {
    bus::Reader<wire::Excitation> excitation;
    bus::Reader<wire::Command> command;
    RecordWriter oscilloscope;
    RecordWriter sensor;
  };
  struct Step {
    std::string run;
    std::uint32_t step = 0;
    double frequency_hz = 0.0;
    int shots = 0;
  };

  BenchService(const BenchFile& bench, const SourceSettings& oscilloscope,
               const SourceSettings& sensor, std::shared_ptr<bus::WakeUp> wake_up,
               Endpoints endpoints);
  void take_messages();
  void follow(const wire::Excitation& excitation);
  void take_shot();
  void publish(ShotPair& pair, const Step& step);
  [[nodiscard]] bool in_step(const std::string& run, std::uint32_t step) const;
  void describe_sensor(const drivers::tss::Series& series);
  void try_to_connect();
  void report();

  const std::string bench_;
  const SourceSettings oscilloscope_settings_;
  const SourceSettings sensor_settings_;
  std::vector<std::string> sensor_channels_; // that the bench file names
  const int shots_wanted_;
  const double first_frequency_hz_;
  std::shared_ptr<bus::WakeUp> wake_up_;
  Endpoints endpoints_;
  drivers::StopSignal device_stop_;
  ShotDevice device_;
  bool connected_ = false;
  std::optional<Step> step_; // steady now
  std::uint64_t shot_ = 0;
  std::string connection_problem_;
  std::string shot_problem_; // the last one of this step
};

} // namespace dyncal::services::dso
