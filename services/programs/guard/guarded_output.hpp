// The output that a guard guards, as the guard uses it: it switches off and waits for that, but
// does not wait for answers to its questions, since it must hear its run meanwhile.
//
// GeneratorOutput asks in a thread of its own. Used by the guard's thread alone.
#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "drivers/generator/generator_output.hpp"
#include "services/base/error.hpp"

namespace dyncal::inline programs {

class GuardedOutput {
public:
  virtual ~GuardedOutput() = default;
  // Returns when the output has answered that it is off; may take seconds. Answers to questions
  // that were asked before are forgotten.
  [[nodiscard]] virtual Expected<void> switch_off() = 0;
  // Passed over while a question has no answer yet.
  virtual void ask() = 0;
  // Each answer once.
  [[nodiscard]] virtual std::optional<Expected<drivers::generator::OutputReading>> answer() = 0;
};

class GeneratorOutput : public GuardedOutput {
public:
  explicit GeneratorOutput(std::string address);

  [[nodiscard]] Expected<void> switch_off() override;
  void ask() override;
  [[nodiscard]] std::optional<Expected<drivers::generator::OutputReading>> answer() override;

private:
  void answer_questions(const std::stop_token& stop);

  std::string address_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  bool is_asked_ = false;    // and no answer was taken
  bool is_outdated_ = false; // what the answer will say
  std::optional<Expected<drivers::generator::OutputReading>> answer_;
  std::jthread thread_; // the last member: it uses the others
};

} // namespace dyncal::inline programs
