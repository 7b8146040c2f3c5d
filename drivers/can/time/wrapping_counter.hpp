// Makes one growing number of a counter that wraps around.
//
// The step between two readings is known modulo the counter's range; which of the possible steps it
// was follows from the time that has passed, where the rate is known: also across a pause in which
// the counter went around several times. A step that no time explains means that the device has
// restarted. One thread.
#pragma once

#include <cstdint>
#include <optional>

namespace dyncal::drivers::can {

class WrappingCounter {
public:
  // `bits` of the counter, 1 ... 64; `rate_hz` of its steps, 0: not known.
  WrappingCounter(unsigned bits, double rate_hz) : bits_(bits), rate_hz_(rate_hz) {}

  enum class Step { first, forward, repeated, late, restarted };
  struct Reading {
    Step step;
    // 0 for the first; of a late one what it would have been in its turn; after a restart it goes
    // on one behind the last.
    std::int64_t value;
  };
  // `time_ns` of any clock that is right to some percent.
  Reading read(std::uint64_t raw, std::int64_t time_ns);

private:
  struct Last {
    std::uint64_t raw;
    std::int64_t time_ns;
    std::int64_t value;
  };
  // How far `raw` is behind the last one; 0: it is not late.
  [[nodiscard]] std::uint64_t late_by(std::uint64_t raw, double expected, double step) const;
  [[nodiscard]] std::uint64_t mask() const {
    return bits_ >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits_) - 1;
  }

  unsigned bits_;
  double rate_hz_;
  std::optional<Last> last_;
  unsigned late_in_a_row_ = 0;
};

} // namespace dyncal::drivers::can
