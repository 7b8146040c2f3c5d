// The last state of a run: nothing is excited any more, and the last results are waited for.
//
//   all that the analysis has published is there                           ends
//   it refuses the run, as one that took it over and could not go on does  fails with its reason
//   a result names another bench file                                      fails: bad_file
//   it has been silent for StepSequence::away_limit                        fails: no_analysis
//   nothing came for StepSequence::results_limit                           fails: no_result
//   nothing came for StepSequence::missed_limit        all results are collected once more, once
//   recorded files are played, and the run cannot go on                    it is aborted
//   it is stopped                        it is aborted; what is evaluated still counts
//
// The limit begins again with every sign of work, and while the analysis is silent, waits itself,
// or plays files well. Belongs to the conductor's thread.
#pragma once

#include <stop_token>

#include "services/base/error.hpp"
#include "services/run/run_watch.hpp"

namespace dyncal::inline run {

class ResultsWait {
public:
  // `excites`: else recorded files take the place of the excitation. REQUIRES: watch.analysis().
  ResultsWait(RunWatch& watch, bool excites)
      : watch_(watch), excites_(excites), changed_(watch.clock().now()), at_work_(changed_),
        signs_before_(watch.signs_of_work()) {}

  [[nodiscard]] Expected<void> wait(const std::stop_token& stop);

private:
  [[nodiscard]] bool has_everything() const;
  [[nodiscard]] bool has_finished() const;
  [[nodiscard]] bool is_attended() const;
  [[nodiscard]] bool plays_files() const;
  void note_work(bool is_attended, const RunOutlook& outlook, bool stopped);
  [[nodiscard]] Expected<void> ending() const;
  void abort_of(const RunOutlook& outlook);

  RunWatch& watch_;
  bool excites_;
  RunWatch::Instant changed_; // the limit counts from here
  RunWatch::Instant at_work_; // since when the analysis shows no work
  std::size_t signs_before_;
  bool collected_again_ = false;
};

} // namespace dyncal::inline run
