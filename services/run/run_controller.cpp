#include "services/run/run_controller.hpp"

#include <algorithm>
#include <tuple>

#include <fmt/format.h>

#include "drivers/utc_clock.hpp"
#include "services/contract/topics.hpp"
#include "services/evaluation/recipe.hpp"
#include "services/run/run_plan.hpp"

namespace dyncal::services {
namespace {

using namespace std::chrono_literals;

constexpr auto answer_limit = 4s;    // for an analysis service to say anything about the run
constexpr auto armed_limit = 9s;     // to be armed or refused
constexpr auto analysis_limit = 10s; // between two of its lines
constexpr auto results_limit = 25s;  // from the end of the excitation to the last result
constexpr auto alive_interval = 2s;

template <class T>
void keep_newest(std::vector<T>& all, const T& one, bool (*same)(const T&, const T&)) {
  const auto known =
      std::find_if(all.begin(), all.end(), [&](const T& other) { return same(other, one); });
  if (known == all.end()) {
    all.push_back(one);
  } else {
    *known = one;
  }
}

} // namespace

RunController::RunController(bus::Participant& participant, const BenchFile& bench, std::string run,
                             ShowProgress show_progress)
    : participant_(participant), bench_(bench), run_(std::move(run)),
      show_progress_(std::move(show_progress)), wake_up_(std::make_shared<bus::WakeUp>()) {}

Expected<RunOutcome>
RunController::conduct(const std::vector<analysis::AdcCalibrationPoint>& adc_calibration,
                       const std::stop_token& stop) {
  outcome_ = {};
  outcome_.measurement = plan_measurement(bench_, run_, utc_now_ns(), adc_calibration);
  if (const auto ready = open_endpoints().and_then([&] { return open_excitation(); }); !ready) {
    return fail(ready.error());
  }
  set_state(wire::MEASUREMENT_PLANNED);
  if (const auto armed = wait_until_armed(stop); !armed) {
    set_state(wire::MEASUREMENT_ABORTED);
    return fail(armed.error());
  }
  set_state(wire::MEASUREMENT_RUNNING);
  Expected<void> excited = excite(stop);
  if (excitation_) {
    excitation_->end();
  }
  outcome_.interrupted = stop.stop_requested();
  if (!excited) {
    outcome_.problem = excited.error().message;
  }
  outcome_.measurement.message(outcome_.interrupted ? "interrupted by the user" : outcome_.problem);
  const bool from_files = excitation_ == nullptr;
  if (!from_files || outcome_.interrupted || !excited) {
    set_state(outcome_.interrupted || !excited ? wire::MEASUREMENT_ABORTED
                                               : wire::MEASUREMENT_DONE);
  }
  const Expected<void> collected = wait_for_results(stop);
  if (!collected && outcome_.problem.empty()) {
    outcome_.problem = collected.error().message;
  }
  outcome_.interrupted = outcome_.interrupted || stop.stop_requested();
  set_state(outcome_.interrupted || !excited ? wire::MEASUREMENT_ABORTED : wire::MEASUREMENT_DONE);
  endpoints_->measurement.wait_for_acknowledgments(2s);
  const auto key = [](const wire::CalibrationResult& result) {
    return std::tuple(result.step(), result.repetition(), result.channel().to_string());
  };
  std::stable_sort(outcome_.results.begin(), outcome_.results.end(),
                   [&](const auto& a, const auto& b) { return key(a) < key(b); });
  std::sort(outcome_.transfer_functions.begin(), outcome_.transfer_functions.end(),
            [](const wire::TransferFunction& a, const wire::TransferFunction& b) {
              return a.channel().to_string() < b.channel().to_string();
            });
  return std::move(outcome_);
}

Expected<void> RunController::open_endpoints() {
  const std::string& bench = bench_.bench;
  auto measurement =
      participant_.writer<wire::Measurement>(bus::topics::measurement, bus::Profile::state, bench);
  auto excitation =
      participant_.writer<wire::Excitation>(bus::topics::excitation, bus::Profile::state, bench);
  auto status = participant_.reader<wire::ServiceStatus>(bus::topics::service_status,
                                                         bus::Profile::state, bench, wake_up_);
  auto results = participant_.reader<wire::CalibrationResult>(
      bus::topics::calibration_result, bus::Profile::results, bench, wake_up_);
  auto transfer = participant_.reader<wire::TransferFunction>(
      bus::topics::transfer_function, bus::Profile::results, bench, wake_up_);
  auto clocks = participant_.reader<wire::SampleClockReport>(
      bus::topics::sample_clock_report, bus::Profile::results, bench, wake_up_);
  if (!measurement || !excitation || !status || !results || !transfer || !clocks) {
    for (const Error* error :
         {measurement ? nullptr : &measurement.error(), excitation ? nullptr : &excitation.error(),
          status ? nullptr : &status.error(), results ? nullptr : &results.error(),
          transfer ? nullptr : &transfer.error(), clocks ? nullptr : &clocks.error()}) {
      if (error != nullptr) {
        return fail(*error);
      }
    }
  }
  endpoints_ = std::make_unique<Endpoints>(
      Endpoints{std::move(*measurement), std::move(*excitation), std::move(*status),
                std::move(*results), std::move(*transfer), std::move(*clocks)});
  return {};
}

Expected<void> RunController::open_excitation() {
  if (bench_.generator.driver == "none") {
    return {};
  }
  auto excitation = StepExcitation::open(
      participant_, bench_, outcome_.measurement, wake_up_,
      {.announce = [this](const wire::PlannedStep& step,
                          wire::ExcitationState state) { announce(step, state); },
       .show = [this](const std::string& phase) { show(phase); },
       .ask = [this](const std::string& request) { show("asking", request); },
       .attend = [this] { return attend(); }});
  if (!excitation) {
    return fail(excitation.error());
  }
  excitation_ = std::move(*excitation);
  return {};
}

Expected<void> RunController::wait_until_armed(const std::stop_token& stop) {
  const auto began = Clock::now();
  while (!stop.stop_requested()) {
    show("waiting for the analysis");
    wake_up_->wait_until(Clock::now() + 200ms);
    take_messages();
    keep_alive();
    if (analysis_ && analysis_->arm() == wire::ARM_ARMED) {
      return {};
    }
    if (analysis_ && analysis_->arm() == wire::ARM_REFUSED) {
      return fail(ErrorCode::no_source, analysis_->message());
    }
    const auto waited = Clock::now() - began;
    if (!analysis_ && waited > answer_limit) {
      return fail(ErrorCode::no_analysis,
                  fmt::format("no analysis service answers for bench '{}'; is "
                              "dyncal-analysis running in the same DDS domain?",
                              bench_.bench));
    }
    if (waited > armed_limit) {
      return fail(ErrorCode::no_analysis,
                  fmt::format("the analysis service {} has not armed for bench '{}'",
                              analysis_->service().c_str(), bench_.bench));
    }
  }
  return fail(ErrorCode::interrupted, "interrupted before the first step; nothing was excited");
}

Expected<void> RunController::excite(const std::stop_token& stop) {
  if (!excitation_) {
    return {};
  }
  if (const auto ready = excitation_->begin(); !ready) {
    return ready;
  }
  first_step_began_ = Clock::now();
  for (const wire::PlannedStep& step : outcome_.measurement.steps()) {
    ++step_;
    if (const auto excited = excitation_->excite(step, stop); !excited || stop.stop_requested()) {
      return excited;
    }
  }
  return {};
}

Expected<void> RunController::attend() {
  keep_alive();
  take_messages();
  if (analysis_->health() == wire::HEALTH_FAILED) {
    return fail(ErrorCode::no_source, analysis_->message());
  }
  if (Clock::now() - analysis_heard_ > analysis_limit) {
    return fail(ErrorCode::no_analysis, fmt::format("the analysis service {} has gone silent",
                                                    analysis_->service().c_str()));
  }
  return {};
}

// Topics have no order among each other: FINISHED may come before the results that were written
// before it.
bool RunController::everything_has_come() const {
  return analysis_ && analysis_->arm() == wire::ARM_FINISHED &&
         outcome_.results.size() >= analysis_->results_published() &&
         outcome_.transfer_functions.size() >= analysis_->transfer_functions_published() &&
         outcome_.clock_reports.size() >= analysis_->clock_reports_published();
}

Expected<void> RunController::wait_for_results(const std::stop_token& stop) {
  const bool already_stopped = stop.stop_requested();
  const bool from_files = excitation_ == nullptr;
  auto deadline = Clock::now() + results_limit;
  std::size_t results_before = outcome_.results.size();
  while (!everything_has_come()) {
    show("evaluating");
    wake_up_->wait_until(Clock::now() + 200ms);
    take_messages();
    keep_alive();
    if (!already_stopped && stop.stop_requested() &&
        outcome_.measurement.state() != wire::MEASUREMENT_ABORTED) {
      set_state(wire::MEASUREMENT_ABORTED);
    }
    if (outcome_.results.size() != results_before ||
        (from_files && outcome_.measurement.state() == wire::MEASUREMENT_RUNNING &&
         analysis_->health() == wire::HEALTH_OK)) {
      results_before = outcome_.results.size();
      deadline = Clock::now() + results_limit;
    }
    if (Clock::now() - analysis_heard_ > analysis_limit) {
      return fail(ErrorCode::no_analysis, fmt::format("the analysis service {} has gone silent",
                                                      analysis_->service().c_str()));
    }
    if (analysis_->health() == wire::HEALTH_FAILED && from_files &&
        outcome_.measurement.state() == wire::MEASUREMENT_RUNNING) {
      outcome_.problem = analysis_->message();
      set_state(wire::MEASUREMENT_ABORTED);
    }
    if (Clock::now() > deadline) {
      return fail(ErrorCode::no_result, "the last results have not come from the analysis service");
    }
  }
  return {};
}

void RunController::announce(const wire::PlannedStep& step, wire::ExcitationState state) {
  if (state == wire::EXCITATION_SETTLING) {
    window_begin_utc_ns_ = utc_now_ns();
  }
  wire::Excitation excitation;
  excitation.bench(bench_.bench);
  excitation.run(run_);
  excitation.step(step.step());
  excitation.frequency_text_hz(step.frequency_text_hz());
  excitation.level_m_s2(step.level_m_s2());
  excitation.repetition(step.repetition());
  excitation.state(state);
  excitation.window_begin_utc_ns(window_begin_utc_ns_);
  excitation.window_end_utc_ns(
      state == wire::EXCITATION_DONE || state == wire::EXCITATION_ABORTED ? utc_now_ns() : 0);
  endpoints_->excitation.write(excitation);
}

void RunController::set_state(wire::MeasurementState state) {
  outcome_.measurement.state(state);
  endpoints_->measurement.write(outcome_.measurement);
  last_alive_ = Clock::now();
}

void RunController::keep_alive() {
  if (Clock::now() - last_alive_ > alive_interval) {
    set_state(outcome_.measurement.state());
  }
}

void RunController::take_messages() {
  const auto of_this_run = [&](const auto& message, const bus::SampleInfo& info) {
    return info.valid && message.run().to_string() == run_;
  };
  endpoints_->results.take([&](const wire::CalibrationResult& result, const bus::SampleInfo& info) {
    if (of_this_run(result, info)) {
      keep_newest<wire::CalibrationResult>(
          outcome_.results, result, [](const auto& a, const auto& b) {
            return a.step() == b.step() && a.repetition() == b.repetition() &&
                   a.channel() == b.channel();
          });
    }
  });
  endpoints_->transfer_functions.take(
      [&](const wire::TransferFunction& function, const bus::SampleInfo& info) {
        if (of_this_run(function, info)) {
          keep_newest<wire::TransferFunction>(
              outcome_.transfer_functions, function,
              [](const auto& a, const auto& b) { return a.channel() == b.channel(); });
        }
      });
  endpoints_->clock_reports.take(
      [&](const wire::SampleClockReport& report, const bus::SampleInfo& info) {
        if (of_this_run(report, info)) {
          keep_newest<wire::SampleClockReport>(
              outcome_.clock_reports, report,
              [](const auto& a, const auto& b) { return a.source() == b.source(); });
        }
      });
  endpoints_->status.take([&](const wire::ServiceStatus& status, const bus::SampleInfo& info) {
    if (of_this_run(status, info)) {
      analysis_ = status;
      analysis_heard_ = Clock::now();
      outcome_.analysis_dds = status.dds();
    }
  });
}

void RunController::show(const std::string& phase, const std::string& request) {
  RunProgress progress;
  progress.request = request;
  progress.step = step_;
  progress.steps = outcome_.measurement.steps().size();
  progress.phase = phase;
  progress.results = outcome_.results.size();
  if (step_ > 0 && step_ <= progress.steps) {
    progress.frequency_hz = outcome_.measurement.steps()[step_ - 1].frequency_text_hz();
  }
  if (step_ > 1) {
    const double per_step_s =
        std::chrono::duration<double>(Clock::now() - first_step_began_).count() /
        static_cast<double>(step_ - 1);
    progress.seconds_left = per_step_s * static_cast<double>(progress.steps - step_ + 1);
  }
  show_progress_(progress);
}

} // namespace dyncal::services
