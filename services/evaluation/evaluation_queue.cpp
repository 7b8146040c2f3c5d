#include "services/evaluation/evaluation_queue.hpp"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <utility>

namespace dyncal::inline evaluation {

namespace {

bool is_ready(const std::future<std::vector<StepResult>>& evaluation) {
  return evaluation.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

} // namespace

EvaluationQueue::~EvaluationQueue() {
  stop();
}

bool EvaluationQueue::has_room() {
  keep_ready();
  return !in_background() || under_way_.size() < at_once_;
}

bool EvaluationQueue::is_idle() const {
  return std::all_of(under_way_.begin(), under_way_.end(), is_ready);
}

void EvaluationQueue::make_room() {
  while (!under_way_.empty() && under_way_.size() >= at_once_) {
    finish_oldest();
  }
}

void EvaluationQueue::begin(Evaluation evaluation) {
  if (!in_background()) {
    keep(evaluation(stop_.get_token()));
    return;
  }
  make_room();
  under_way_.push_back(std::async(std::launch::async, std::move(evaluation), stop_.get_token()));
}

std::vector<StepResult> EvaluationQueue::take_finished() {
  keep_ready();
  return std::exchange(finished_, {});
}

void EvaluationQueue::keep_ready() {
  while (!under_way_.empty() && is_ready(under_way_.front())) {
    finish_oldest();
  }
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

} // namespace dyncal::inline evaluation
