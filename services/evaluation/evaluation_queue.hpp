// Evaluations of steps, one after the other in the caller's thread, or some at once in threads of
// their own; results come in the order in which the evaluations were begun, so that nothing depends
// on which of the two it was. Bounded: who begins one more than there may be at once waits for the
// oldest. The destructor asks those under way to stop and waits for them. Belongs to one thread;
// what an evaluation looks at must not change until its results were taken.
#pragma once

#include <cstddef>
#include <deque>
#include <future>
#include <stop_token>
#include <vector>

#include "services/evaluation/method/method.hpp"

namespace dyncal::inline evaluation {

class EvaluationQueue {
public:
  // `at_once` 0: in the caller's thread.
  explicit EvaluationQueue(std::size_t at_once) : at_once_(at_once) {}
  ~EvaluationQueue();
  EvaluationQueue(const EvaluationQueue&) = delete;
  EvaluationQueue& operator=(const EvaluationQueue&) = delete;

  [[nodiscard]] bool in_background() const { return at_once_ > 0; }
  // Whether one may begin without waiting.
  [[nodiscard]] bool has_room();
  // Whether the results of all that were begun are there.
  [[nodiscard]] bool is_idle() const;

  // Waits until one more may begin: before its samples are copied, so that no more of them are held
  // than are evaluated.
  void make_room();
  void begin(Evaluation evaluation);
  // Those under way and all that are begun from now on end soon, see Evaluation.
  void stop() { stop_.request_stop(); }
  [[nodiscard]] std::stop_token stop_token() const { return stop_.get_token(); }
  // Of all evaluations before the first one that is still under way.
  [[nodiscard]] std::vector<StepResult> take_finished();
  // Of all; waits for them.
  [[nodiscard]] std::vector<StepResult> take_all();

private:
  void keep_ready();
  void finish_oldest();
  void keep(std::vector<StepResult> results);

  std::size_t at_once_;
  std::stop_source stop_;
  std::deque<std::future<std::vector<StepResult>>> under_way_;
  std::vector<StepResult> finished_;
};

} // namespace dyncal::inline evaluation
