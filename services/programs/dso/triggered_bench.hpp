// One bench of dyncal-dso: follows the excitation of the bench's runs, takes shots while a step is
// steady, and hands each as a pair of records to the publishers of its two sources, DsoRecord and
// TssRecord, with the same session and shot number.
//
// Per step `shots` pairs are taken, however often one fails in between, as long as the step is
// steady: a shot that fails is counted as rejected, named in the log and until the next step in the
// status of both sources, and repeated over new connections where these were lost. The first shot
// after a start is left out, which is no fault (trigger_count.hpp), and counted nowhere. While the
// devices cannot be reached both sources are SILENT. Shot numbers count the pairs of a session from
// 1; each names its run and step. The sensor describes its device and units only with a series; its
// channels are those that the bench calibrates, from the beginning.
//
// The thread that serves the devices never waits for the network: records go through the rings of
// the publishers. A pair that finds no room there is lost, counted as dropped_in_service, and
// repeated.
//
// Threads: run() belongs to one thread; `stop` may be requested from any.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "drivers/link/stop_signal.hpp"
#include "services/base/error.hpp"
#include "services/bench/file/bench_file.hpp"
#include "services/bus/bus.hpp"
#include "services/instruments/shot_device.hpp"
#include "services/stream/source_service.hpp"

#include "idl/dyncal.h"

namespace dyncal::inline programs::dso {

class TriggeredBench {
public:
  // Adds its two sources to `service`, which is to be started afterwards. Fails (bad_file) when the
  // bench file has no oscilloscope or time series sensor, (network) when the bus refuses.
  // `participant` and `service` outlive the bench.
  [[nodiscard]] static Expected<std::unique_ptr<TriggeredBench>>
  create(bus::Participant& participant, SourceService& service, const BenchFile& bench,
         RingLimits ring = {});

  void run(const std::stop_token& stop);

  // Pairs since it was created, those that found no room included. Any thread.
  [[nodiscard]] std::uint64_t shots_taken() const { return shot_; }

private:
  struct Source {
    SourceSettings settings;
    std::shared_ptr<SourcePublisher> publisher;
    bool described = false;
  };
  struct Step {
    std::string run;
    std::uint32_t step = 0;
    std::uint32_t attempt = 1;
    double frequency_hz = 0.0;
    int shots = 0;
  };

  TriggeredBench(const BenchFile& bench, Source oscilloscope, Source sensor,
                 bus::Reader<wire::Excitation> excitation, std::shared_ptr<bus::WakeUp> wake_up);
  void follow_excitation();
  void follow(const wire::Excitation& excitation);
  void take_shot();
  [[nodiscard]] Expected<ShotPair> with_bench_channels(ShotPair pair) const;
  void reject_shot(const Step& step, const std::string& reason);
  [[nodiscard]] bool publish(ShotPair pair, const Step& step);
  [[nodiscard]] bool in_step(const std::string& run, std::uint32_t step,
                             std::uint32_t attempt) const;
  void describe_oscilloscope();
  void describe_sensor(const drivers::tss::Series& series);
  void try_to_connect();
  void report();

  const std::string bench_;
  Source oscilloscope_;
  Source sensor_;
  std::vector<std::string> sensor_channels_; // that the bench file names
  const int shots_wanted_;
  const double first_frequency_hz_;
  bus::Reader<wire::Excitation> excitation_;
  std::shared_ptr<bus::WakeUp> wake_up_;
  drivers::StopSignal device_stop_;
  ShotDevice device_;
  bool connected_ = false;
  std::optional<Step> step_; // steady now
  std::atomic<std::uint64_t> shot_ = 0;
  drivers::SampleCounts counts_; // of shots, the same for both sources
  std::string connection_problem_;
  std::string shot_problem_; // the last one of this step
};

} // namespace dyncal::inline programs::dso
