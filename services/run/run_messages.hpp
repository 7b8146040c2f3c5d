// The messages of one run as its conductor sends and receives them: the plan and the excitation go
// out, status and results of the analysis come in.
//
// The analysis of the run is the participant whose ServiceStatus has armed it; when it is not heard
// any more, the one that takes the run over, for the same conductor and recipe. What other
// participants say as an analysis of this run is left out and counted, their results too; when one
// of them becomes the analysis, it is asked for once more.
//
// Of everything that comes the newest of every key is kept, but no result of an earlier attempt at
// its step (an analysis that was restarted publishes them all again); messages of other runs on the
// bench are left out, and results of them not even asked for: an analysis keeps those of some runs,
// and a slow link would be full of them when a run begins. So are results of steps, channels and
// sources that the recipe does not have, and of attempts at a step that were never made, which are
// counted: what is kept is no more than was planned and excited. A source that becomes another
// instrument in the run leaves the description as the run began with it. Belongs to one thread.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "idl/dyncal.h"
#include "services/base/error.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"
#include "services/bus/participant_name.hpp"
#include "services/evaluation/result/run_outcome.hpp"
#include "services/run/attendance_links.hpp"
#include "services/run/guard_watch.hpp"

namespace dyncal::inline run {

class RunMessages {
public:
  // `generator`: the address that the run drives, as GuardWatch wants it; empty: none that a guard
  // could switch off. `participant` and `clock` outlive the object. Fails (network) as writers and
  // readers do, and as AttendanceLinks.
  [[nodiscard]] static Expected<RunMessages> open(bus::Participant& participant, bus::Clock& clock,
                                                  const std::string& bench, std::string run,
                                                  std::string generator,
                                                  const std::shared_ptr<bus::WakeUp>& wake_up);

  void publish(wire::Measurement measurement);
  // `state` of the step that is excited, or was to be. One that is over while the output may be on
  // has no end of its window yet.
  void announce(const wire::PlannedStep& step, std::uint32_t attempt, wire::ExcitationState state,
                bool output_may_be_on = false);
  // The output is known to be off now: the announcement once more, if it had to leave that open.
  void confirm_off();
  // Shows dyncal-guard that somebody attends: the newest announcement again while the exciter is
  // driven, at most every 500 ms; not when the conductor has lost hold of the generator.
  void repeat_announcement();
  void wait_for_acknowledgments(std::chrono::nanoseconds limit);

  // Takes what has come, results and the descriptions of the recipe's sources into `outcome`.
  // Returns how many results have come, transfer functions and reports of clocks among them.
  std::size_t take(RunOutcome& outcome);
  // Results and the last status of the analysis come once more, to readers that are opened anew.
  // For what a reader cannot get otherwise: DDS delivers a message to it once, and a packet that
  // was changed on the way may have taken its place. The readers stay when none can be opened.
  void collect_again();
  // How many results have come, those that came again too, and how often the analysis has reported
  // something new of its work.
  [[nodiscard]] std::size_t signs_of_work() const { return signs_of_work_; }
  [[nodiscard]] bool has_other_recipe() const { return other_recipe_; }
  // Sources of the recipe that have described themselves.
  [[nodiscard]] std::size_t described() const { return described_.size(); }
  // One sentence about a source that is another instrument now than the run began with; empty:
  // none is.
  [[nodiscard]] std::string other_instrument() const {
    return other_instruments_.empty() ? "" : other_instruments_.begin()->second;
  }
  // Results of this run that it did not plan or excite.
  [[nodiscard]] std::size_t unplanned() const { return unplanned_; }
  // Statuses and results of this run from others than its analysis.
  [[nodiscard]] std::size_t of_others() const { return of_others_; }
  // The first of those others, for people.
  [[nodiscard]] std::string other_publisher() const {
    return bus::name_of(participant_->discovered(), other_publisher_);
  }
  // The newest status of the analysis service that evaluates this run; nothing before the first. It
  // is the one that is armed, until it has been silent for attention_limit; then whichever reports.
  [[nodiscard]] const std::optional<wire::ServiceStatus>& analysis() const { return analysis_; }
  // Empty before the first.
  [[nodiscard]] const std::string& analysis_participant() const { return analysis_participant_; }
  [[nodiscard]] bus::Clock::Instant analysis_heard() const { return analysis_heard_; }

  // What is to be told of who guards the exciter.
  [[nodiscard]] std::optional<std::string> notice_of_guard() {
    return guard_.notice(clock_->now());
  }
  // Why a guard watches in vain; empty: none does.
  [[nodiscard]] std::string deafness_of_guard() const {
    return guard_.deafness(run_, clock_->now());
  }

private:
  static constexpr std::size_t max_left_out = 100; // participants to know

  struct ResultReaders {
    bus::Reader<wire::CalibrationResult> results;
    bus::Reader<wire::TransferFunction> transfer_functions;
    bus::Reader<wire::SampleClockReport> clock_reports;
  };
  struct Endpoints {
    bus::Writer<wire::Measurement> measurement;
    bus::Writer<wire::Excitation> excitation;
    bus::Reader<wire::ServiceStatus> status;
    bus::Reader<wire::SourceDescription> sources;
  };

  RunMessages(bus::Participant& participant, bus::Clock& clock, GuardWatch guard,
              std::optional<AttendanceLinks> links, std::string bench, std::string run,
              std::shared_ptr<bus::WakeUp> wake_up, Endpoints endpoints, ResultReaders published)
      : participant_(&participant), clock_(&clock), bench_(std::move(bench)), run_(std::move(run)),
        guard_(std::move(guard)), links_(std::move(links)), wake_up_(std::move(wake_up)),
        endpoints_(std::move(endpoints)), published_(std::move(published)) {}
  // Without a run: of all of the bench.
  static Expected<ResultReaders> open_readers(bus::Participant& participant,
                                              const std::string& bench,
                                              const std::optional<std::string>& run,
                                              const std::shared_ptr<bus::WakeUp>& wake_up);
  void write_announcement();
  void take_sources(RunOutcome& outcome);
  void take_status(RunOutcome& outcome);
  void take_source(RunSource source, std::vector<RunSource>& sources);
  [[nodiscard]] bool was_excited(const Recipe& planned, const StepResult& result,
                                 const std::vector<StepResult>& known) const;
  template <class Result> // of a whole run
  [[nodiscard]] static bool was_excited(const Recipe& /*planned*/, const Result& /*result*/,
                                        const std::vector<Result>& /*known*/) {
    return true;
  }
  [[nodiscard]] bool follows(const wire::ServiceStatus& status, const bus::WriterId& writer) const;
  void follow(const wire::ServiceStatus& status, const std::string& participant);
  void leave_out(const bus::WriterId& writer);
  template <class Message, class Result, class SameKey>
  std::size_t take_newest(bus::Reader<Message>& reader, std::vector<Result>& all,
                          const std::optional<Recipe>& planned,
                          SameKey same_key); // how many came

  bus::Participant* participant_;
  bus::Clock* clock_;
  std::string bench_;
  std::string run_;
  GuardWatch guard_;
  std::optional<AttendanceLinks> links_; // of a run that a guard may watch over
  std::shared_ptr<bus::WakeUp> wake_up_;
  Endpoints endpoints_;
  ResultReaders published_;
  bool reads_whole_bench_ = false; // because of an analysis of an older contract
  std::optional<wire::ServiceStatus> analysis_;
  std::string analysis_participant_;
  std::set<std::string> left_out_; // participants, at most max_left_out
  std::size_t of_others_ = 0;
  std::string other_publisher_;
  bus::Clock::Instant analysis_heard_;
  std::size_t signs_of_work_ = 0;
  std::string conductor_; // by its Measurement
  std::string recipe_sha256_;
  bool other_recipe_ = false; // in a result of this run
  std::size_t unplanned_ = 0;
  bool was_planned_here_ = false; // else the run is resumed, and another made attempts before
  bool has_begun_ = false;        // RUNNING
  std::set<std::string> described_;
  std::map<std::string, std::string> other_instruments_; // sentences by source
  std::map<std::uint32_t, std::uint32_t> attempts_;      // announced, by step
  wire::Excitation excitation_;                          // as announced last
  bus::Clock::Instant announced_{};
};

} // namespace dyncal::inline run
