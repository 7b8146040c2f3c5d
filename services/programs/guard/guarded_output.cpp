#include "services/programs/guard/guarded_output.hpp"

#include <utility>

#include "services/base/device_error.hpp"

namespace dyncal::inline programs {

using drivers::generator::OutputReading;

GeneratorOutput::GeneratorOutput(std::string address)
    : address_(std::move(address)),
      thread_([this](const std::stop_token& stop) { answer_questions(stop); }) {}

void GeneratorOutput::answer_questions(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [this] { return is_asked_ && !answer_; })) {
    lock.unlock();
    auto reading = drivers::generator::read_output(address_).map_error(device_error);
    lock.lock();
    answer_.emplace(std::move(reading));
  }
}

Expected<void> GeneratorOutput::switch_off() {
  auto off = drivers::generator::switch_output_off(address_).map_error(device_error);
  const std::lock_guard lock(mutex_);
  is_outdated_ = is_asked_;
  return off;
}

void GeneratorOutput::ask() {
  const std::lock_guard lock(mutex_);
  is_asked_ = true;
  changed_.notify_all();
}

std::optional<Expected<OutputReading>> GeneratorOutput::answer() {
  const std::lock_guard lock(mutex_);
  if (!answer_) {
    return std::nullopt;
  }
  is_asked_ = false;
  auto taken = std::exchange(answer_, std::nullopt);
  return std::exchange(is_outdated_, false) ? std::nullopt : std::move(taken);
}

} // namespace dyncal::inline programs
