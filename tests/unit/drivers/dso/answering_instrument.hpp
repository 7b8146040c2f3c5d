// An instrument on a TCP port of this machine that answers each line as a test tells it to: in
// pieces, late, wrongly, or not at all.
#pragma once

#include <chrono>
#include <functional>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "tests/unit/drivers/link/scripted_instrument.hpp"

namespace dyncal::drivers {

struct Piece {
  std::string bytes;
  std::chrono::milliseconds after{0}; // waits this long before it is sent
  bool close = false;                 // closes the connection after the bytes
};

class AnsweringInstrument {
public:
  // `answer` is called with every line that comes, in the instrument's thread.
  using Answer = std::function<std::vector<Piece>(const std::string& line)>;

  explicit AnsweringInstrument(Answer answer)
      : answer_(std::move(answer)),
        instrument_([this](int, ScriptedInstrument::Client& client) { converse(client); }) {}
  ~AnsweringInstrument() { stop_.raise(); }

  [[nodiscard]] std::string address() const { return instrument_.address(); }
  [[nodiscard]] std::vector<std::string> lines() const {
    const std::lock_guard lock(mutex_);
    return lines_;
  }

private:
  void converse(ScriptedInstrument::Client& client) {
    for (std::string line = client.hear(); !line.empty(); line = client.hear()) {
      {
        const std::lock_guard lock(mutex_);
        lines_.push_back(line);
      }
      for (const Piece& piece : answer_(line)) {
        if (stop_.wait_for(piece.after)) {
          return;
        }
        client.say(piece.bytes);
        if (piece.close) {
          return;
        }
      }
    }
  }

  Answer answer_;
  StopSignal stop_;
  mutable std::mutex mutex_;
  std::vector<std::string> lines_;
  ScriptedInstrument instrument_;
};

} // namespace dyncal::drivers
