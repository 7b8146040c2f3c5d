#include "drivers/generator/by_hand_generator.hpp"

#include <array>
#include <cstdio>
#include <utility>

#include <poll.h>
#include <termios.h>
#include <unistd.h>

namespace dyncal::drivers::generator {
namespace {

// As many digits as a generator has.
std::string volts(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g V", value);
  return text.data();
}

std::string amplitude(double amplitude_v) {
  return volts(amplitude_v) + " amplitude (" + volts(2.0 * amplitude_v) + " peak to peak)";
}

} // namespace

ByHandGenerator::~ByHandGenerator() {
  if (on_ && !switching_off_) {
    show_("switch the generator's output off");
  }
}

void ByHandGenerator::ask(const std::string& what) {
  if (isatty(input_) != 0) {
    tcflush(input_, TCIFLUSH);
    unanswered_ = 0;
  }
  ++unanswered_;
  show_(what + ", then press Enter");
}

Expected<void> ByHandGenerator::set_frequency(const std::string& decimal_hz) {
  frequency_hz_ = decimal_hz;
  return {};
}

Expected<void> ByHandGenerator::set_amplitude_v(double amplitude_v) {
  const bool changed = amplitude_v != amplitude_v_;
  amplitude_v_ = amplitude_v;
  if (on_ && !switching_off_ && changed) {
    ask("generator: set " + amplitude(amplitude_v_));
  }
  return {};
}

Expected<void> ByHandGenerator::set_output(bool on) {
  if (on) {
    on_ = true; // from now on it may be
    switching_off_ = false;
    ask("generator: with the output off set sine, " + frequency_hz_ + " Hz, " +
        amplitude(amplitude_v_) + "; switch the output on");
  } else if (on_ && !switching_off_) {
    switching_off_ = true;
    ask("generator: switch the output off");
  }
  return {};
}

Expected<bool> ByHandGenerator::wait_for_effect(std::chrono::milliseconds limit) {
  if (unanswered_ == 0) {
    return true;
  }
  pollfd waiting{input_, POLLIN, 0};
  if (poll(&waiting, 1, static_cast<int>(limit.count())) <= 0) {
    return false; // nothing came, or a signal did
  }
  // One byte at a time: what follows the line end answers a later question.
  for (char byte = 0;;) {
    if (poll(&waiting, 1, 0) <= 0) {
      return false; // the rest of the line is still to come
    }
    if (read(input_, &byte, 1) != 1) {
      return fail(
          ErrorCode::disconnected,
          "generator by hand: standard input has ended, so the settings cannot be confirmed");
    }
    if (byte == '\n' && --unanswered_ == 0) {
      on_ = on_ && !std::exchange(switching_off_, false);
      return true;
    }
  }
}

} // namespace dyncal::drivers::generator
