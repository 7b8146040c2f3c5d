#include "drivers/smartup/sample_numbering.hpp"

namespace dyncal::drivers::smartup {

void SampleNumbering::forget() {
  seen_.fill({});
  odd_in_a_row_ = 0;
}

Place SampleNumbering::accept(Arrival arrival, std::uint32_t number, std::int64_t stamp_ns,
                              std::uint64_t sample, std::uint64_t missing) {
  started_ = true;
  last_number_ = number;
  last_stamp_ns_ = stamp_ns;
  last_sample_ = sample;
  seen_[number % remembered] = {number, stamp_ns, true};
  odd_in_a_row_ = 0;
  return {arrival, sample, missing};
}

// A number that does not fit: `stale`, unless enough of them have come in a row to be a numbering
// of their own.
Arrival SampleNumbering::unless_it_continues(std::uint32_t number) {
  odd_in_a_row_ = number == next_odd_number_ ? odd_in_a_row_ + 1 : 1;
  next_odd_number_ = number + 1;
  return odd_in_a_row_ > new_numbering_proof ? Arrival::restart : Arrival::stale;
}

Arrival SampleNumbering::look_back(std::uint32_t number, std::int64_t stamp_ns) {
  const Seen& seen = seen_[number % remembered];
  const bool known = seen.valid && seen.number == number;
  if (known && seen.stamp_ns == stamp_ns) {
    return Arrival::duplicate;
  }
  const std::uint32_t back = last_number_ - number;
  if (!known && back < remembered && stamp_ns < last_stamp_ns_) {
    return Arrival::late;
  }
  if (number == 1 || stamp_ns > last_stamp_ns_) {
    return Arrival::restart;
  }
  return unless_it_continues(number);
}

Place SampleNumbering::place(std::uint32_t number, std::int64_t stamp_ns) {
  if (!started_) {
    return accept(Arrival::next, number, stamp_ns, number, 0);
  }
  const std::uint32_t ahead = number - last_number_;
  if (ahead == 1) {
    return accept(Arrival::next, number, stamp_ns, last_sample_ + 1, 0);
  }
  Arrival arrival = Arrival::after_gap;
  if (ahead == 0 || ahead > UINT32_MAX / 2) {
    arrival = look_back(number, stamp_ns);
  } else if (ahead > max_gap) {
    arrival = Arrival::restart;
  } else if (ahead > plain_gap && stamp_ns < last_stamp_ns_ - clearly_earlier_ns) {
    arrival = unless_it_continues(number);
  }

  if (arrival == Arrival::after_gap) {
    return accept(arrival, number, stamp_ns, last_sample_ + ahead, ahead - 1);
  }
  if (arrival == Arrival::restart) {
    forget();
    return accept(arrival, number, stamp_ns, number, 0);
  }
  return {arrival, 0, 0};
}

bool SampleNumbering::skip(std::uint32_t number) {
  if (!started_ || number - last_number_ != 1) {
    return false;
  }
  last_number_ = number;
  ++last_sample_;
  return true;
}

} // namespace dyncal::drivers::smartup
