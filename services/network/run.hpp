// A run of a bench: its plan and how far it is (from the conductor), and its results (from the
// analysis). Of results the newest of every key is held, but none of an earlier attempt.
//
// The plan is there only while the conductor lives or was heard; results and the analysis' report
// also come to who listens later. Plain data and functions; one thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "idl/dyncal.h"
#include "services/bus/clock.hpp"
#include "services/contract/evaluation_method.hpp"
#include "services/evaluation/result/clock_report.hpp"
#include "services/evaluation/result/step_result.hpp"
#include "services/evaluation/result/transfer_function.hpp"
#include "services/network/condition.hpp"
#include "services/network/limits.hpp"

namespace dyncal::network {

enum class RunState { unknown, planned, running, done, aborted };
[[nodiscard]] const char* to_string(RunState state);

enum class StepState { open, settling, steady, done, aborted };
[[nodiscard]] const char* to_string(StepState state);

struct Step {
  std::uint32_t step = 0; // from 1
  std::string frequency_text_hz;
  double level_m_s2 = 0.0;
  std::uint32_t repetition = 0;
  double settling_s = 0.0;
  double duration_s = 0.0;
  StepState state = StepState::open;
  std::uint32_t attempt = 0; // 0: not yet excited
};

// As the conductor announced it.
struct Plan {
  EvaluationMethod method = EvaluationMethod::sample_timestamping;
  std::string reference; // "source/channel"; empty: none
  std::string sync_acs;
  std::string sync_dau;
  std::string sync_dso;
  std::vector<std::string> dut; // empty: all of the source of sync_dau
  std::string recipe_sha256;
  std::string conductor; // "host:process"
  std::vector<Step> steps;
};

// The newest excitation, even if the plan is not known.
struct Excitation {
  Step step;
  std::int64_t begin_utc_ns = 0;               // 0: not yet
  std::int64_t end_utc_ns = 0;                 // 0: not yet, or not known
  bus::Clock::Instant began{};                 // when it was first heard of
  std::optional<bus::Clock::Instant> steady{}; // when it was first heard to be steady
  bus::Clock::Instant heard{};
};

enum class AnalysisState { waiting, armed, refused, finished };
// "armed"
[[nodiscard]] const char* to_string(AnalysisState state);
enum class Health { ok, failed, waiting };
// "ok"
[[nodiscard]] const char* to_string(Health health);

struct AnalysisReport {
  std::string service;
  AnalysisState state = AnalysisState::waiting;
  Health health = Health::ok;
  std::string message;
  std::uint64_t results = 0; // published
  std::int64_t published_utc_ns = 0;
  bus::Clock::Instant heard{};
};

// Of the conductor, to a Command.
struct CommandAnswer {
  std::uint64_t command = 0; // its id; 0: none was answered
  std::string refusal;       // empty: it is obeyed
};

struct Run {
  using Instant = bus::Clock::Instant;
  using ResultKey = std::tuple<std::uint32_t, std::uint32_t, std::string>; // step, repetition,
                                                                           // channel

  std::string name;
  std::uint64_t place = 0; // among all runs, in the order in which they were first heard of
  std::optional<RunState> announced; // by the conductor
  std::string message;               // why it was aborted, or why nothing is excited for now
  std::int64_t planned_utc_ns = 0;   // 0: not known
  std::optional<Plan> plan;
  CommandAnswer answer{}; // the last one
  std::optional<Excitation> now;
  std::optional<AnalysisReport> analysis;
  std::map<ResultKey, StepResult> results;
  std::optional<ResultKey> newest_result;
  std::map<std::string, TransferFunction> transfer_functions; // by channel
  std::map<std::string, ClockReport> clock_reports;           // by source
  Instant heard{};                                            // of anything
  std::optional<Instant> conductor_heard;
  // Another one, and a higher, after every change of results, functions and reports. No two runs of
  // a laboratory ever have the same, nor has one that was dropped and is heard of again.
  std::uint64_t results_number = 0;

  // By the conductor; if that was not heard, by the analysis.
  [[nodiscard]] RunState state() const;
  [[nodiscard]] bool is_over() const;
  // Nothing is excited for now: something is away, or somebody asked for it.
  [[nodiscard]] bool is_paused() const;
  // Its conductor was heard, lives no more, and has not ended it.
  [[nodiscard]] bool is_left_alone(Instant at) const;
  // When it was planned; else when the analysis reported last of it.
  [[nodiscard]] std::int64_t time_utc_ns() const;
  // Of the steps that are to come, with what is left of the one that is excited; nothing unless it
  // is being conducted.
  [[nodiscard]] std::optional<double> time_left_s(Instant at) const;
  [[nodiscard]] std::size_t steps_done() const;
  [[nodiscard]] std::size_t invalid_results() const;
  [[nodiscard]] std::size_t flagged_results() const;

  void take(const wire::Measurement& measurement, const Limits& limits, Instant at);
  void take(const wire::Excitation& excitation, Instant at);
  void take(const wire::ServiceStatus& status, Instant at);
};

} // namespace dyncal::network
