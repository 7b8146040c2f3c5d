#include "services/evaluation/evaluation_queue.hpp"

#include <chrono>
#include <iterator>
#include <utility>

namespace dyncal::services {

void EvaluationQueue::make_room() {
  while (!under_way_.empty() && under_way_.size() >= at_once_) {
    finish_oldest();
  }
}

void EvaluationQueue::begin(Evaluation evaluation) {
  if (!in_background()) {
    keep(evaluation());
    return;
  }
  make_room();
  under_way_.push_back(std::async(std::launch::async, std::move(evaluation)));
}

std::vector<StepResult> EvaluationQueue::take_finished() {
  while (!under_way_.empty() &&
         under_way_.front().wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    finish_oldest();
  }
  return std::exchange(finished_, {});
}

std::vector<StepResult> EvaluationQueue::take_all() {
  while (!under_way_.empty()) {
    finish_oldest();
  }
  return std::exchange(finished_, {});
}

void EvaluationQueue::finish_oldest() {
  keep(under_way_.front().get());
  under_way_.pop_front();
}

void EvaluationQueue::keep(std::vector<StepResult> results) {
  finished_.insert(finished_.end(), std::make_move_iterator(results.begin()),
                   std::make_move_iterator(results.end()));
}

} // namespace dyncal::services
