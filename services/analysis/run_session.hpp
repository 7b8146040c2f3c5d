// One run at the analysis service: from the Measurement message over the armed handshake to the
// last result.
//
// Armed means: every source of the recipe has described itself with the channels needed, is not
// silent, and has answered the ARM command in its own sample stream, so commands arrive there and
// samples arrive here (idl/README.md, "The run protocol"). Samples before a source's answer are not
// of this run. A run that cannot be armed within `arm_limit` is refused with one sentence. While
// the run is on, a live source that has sent nothing for `silence_limit` fails it. When the
// excitation is done and nothing moves any more for `quiet_limit`, the run ends with what there is.
// Results stay readable for late joiners as long as the session lives. Belongs to the service's one
// thread; ends with its destruction.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "idl/dyncal.h"
#include "services/bus/bus.hpp"
#include "services/evaluation/run_evaluator.hpp"

namespace dyncal::services {

struct AnalysisIdentity {
  std::string service; // key of ServiceStatus
  std::string host;
  std::uint32_t process_id = 0;
  std::string dds; // word of the vendor
};

// What the service knows of the sources of a bench.
struct KnownSource {
  std::optional<wire::SourceDescription> description;
  std::optional<wire::SourceStatus> status;
};
using KnownSources = std::map<std::string, KnownSource>;

class RunSession {
public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds arm_limit{6};
  static constexpr std::chrono::seconds silence_limit{5};
  static constexpr std::chrono::seconds quiet_limit{8};
  static constexpr std::chrono::seconds runner_limit{15};

  [[nodiscard]] static Expected<std::unique_ptr<RunSession>>
  create(bus::Participant& participant, std::shared_ptr<bus::WakeUp> wake_up,
         const AnalysisIdentity& identity, const wire::Measurement& measurement,
         Clock::time_point now);

  [[nodiscard]] const std::string& bench() const { return bench_; }
  [[nodiscard]] const std::string& run() const { return run_; }
  [[nodiscard]] bool finished() const {
    return arm_ == wire::ARM_FINISHED || arm_ == wire::ARM_REFUSED;
  }

  void update(const wire::Measurement& measurement, Clock::time_point now);
  void announce(const wire::Excitation& excitation);
  // Does what is due: takes samples, asks sources to answer, evaluates, publishes.
  void work(const KnownSources& sources, Clock::time_point now);

private:
  struct SourceLink {
    bool described = false;
    bool answered = false;
    bool ended = false;
    bool triggered = false; // sends records when there is a shot, and may be silent else
    std::optional<wire::SourceDescription> description; // as the evaluation knows it
    Clock::time_point last_block;
  };

  RunSession(bus::Participant& participant, std::shared_ptr<bus::WakeUp> wake_up,
             const AnalysisIdentity& identity, const wire::Measurement& measurement,
             Clock::time_point now);
  Expected<void> open_writers();
  void take_descriptions(const KnownSources& sources);
  void open_reader(wire::SourceKind kind);
  void open_record_reader(wire::SourceKind kind);
  [[nodiscard]] SourceLink* link_of(const std::string& source, const std::string& answers_run);
  void take_samples(Clock::time_point now);
  void take_block(const wire::SampleBlock& block, Clock::time_point now);
  void arm(const KnownSources& sources, Clock::time_point now);
  [[nodiscard]] std::string what_is_missing(const KnownSources& sources) const;
  void evaluate(Clock::time_point now);
  void watch_sources(Clock::time_point now);
  void report_failure(std::string message);
  void refuse(std::string message);
  void publish_status();
  template <class T>
  void write(std::optional<bus::Writer<T>>& writer, const T& message);

  bus::Participant& participant_;
  std::shared_ptr<bus::WakeUp> wake_up_;
  AnalysisIdentity identity_;
  std::string bench_;
  std::string run_;
  wire::MeasurementState state_;
  wire::ArmState arm_ = wire::ARM_WAITING;
  wire::HealthState health_ = wire::HEALTH_OK;
  std::string message_;
  std::uint64_t results_published_ = 0;
  std::uint64_t transfer_functions_published_ = 0;
  std::uint64_t clock_reports_published_ = 0;
  bool excited_by_steps_ =
      false; // a generator is announced; files and hand-made excitation are not
  std::unique_ptr<RunEvaluator> evaluator_;
  std::map<std::string, SourceLink> links_;
  std::map<wire::SourceKind, bus::Reader<wire::SampleBlock>> readers_;
  std::map<wire::SourceKind, bus::Reader<wire::TriggeredRecord>> record_readers_;
  std::optional<bus::Writer<wire::Command>> command_writer_;
  std::optional<bus::Writer<wire::ServiceStatus>> status_writer_;
  std::optional<bus::Writer<wire::CalibrationResult>> result_writer_;
  std::optional<bus::Writer<wire::TransferFunction>> transfer_writer_;
  std::optional<bus::Writer<wire::SampleClockReport>> clock_writer_;
  Clock::time_point created_;
  Clock::time_point last_heard_of_run_;
  Clock::time_point last_progress_;
  Clock::time_point next_command_;
  Clock::time_point next_status_;
};

} // namespace dyncal::services
