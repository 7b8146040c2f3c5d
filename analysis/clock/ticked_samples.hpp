// The order of samples whose stamps are whole ticks of about a sample period, or of more than a
// quarter of one: which follow, where samples are missing, where the clock jumped.
//
// A sample that lies on no line with those before (tick_line.hpp) waits for 31 others. Then these
// are tried with 0 (the first had a wrong stamp), with k missing samples, k about what the distance
// says, and with a jump of the clock; what most of them, and at least three of four, agree with
// counts, of equals the first. Nothing of that: the first one counts for nothing; after 32 of them
// the next one begins a stretch. Stamps that went about a tick back or forth, three of these, widen
// the line by T / 2. Samples that are missing for less than a tick in all may not show.
// Units: ns. One thread.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "analysis/clock/first_stamps.hpp"
#include "analysis/clock/tick_line.hpp"

namespace dyncal::analysis {

enum class TickedStep : std::uint8_t { follows, missing, jump, begins_stretch };

struct TickedSample {
  TickedStep step = TickedStep::follows; // from the one before
  std::uint64_t number = 0;              // as it came
  std::int64_t stamp_ns = 0;
  std::uint64_t missing = 0; // before it, although the numbers do not show it
};

class TickedSamples {
public:
  // What is known of the period; the first sample of the line.
  TickedSamples(TickLine line, std::uint64_t number, std::int64_t stamp_ns);
  // A line that knows its samples, of which so many were missing.
  TickedSamples(TickLine line, std::uint64_t missing) : line_(std::move(line)), missing_(missing) {}

  // What is decided of it and of those before; valid until the next call.
  std::span<const TickedSample> add(std::uint64_t number, std::int64_t stamp_ns);
  std::span<const TickedSample> finish();
  // The next sample is the first of a new numbering.
  void begin(std::uint64_t number, std::int64_t stamp_ns);

  [[nodiscard]] double period_ns() const { return line_.period_ns(); }
  [[nodiscard]] bool is_wide() const { return line_.is_wide(); }

private:
  void take(const TimedSample& sample);
  void decide();
  void follow(const TimedSample& sample, TickedStep step, std::uint64_t missing);
  std::size_t follow_missing(const std::vector<TimedSample>& samples, std::uint64_t missing);
  [[nodiscard]] std::size_t agree(TickLine line, std::uint64_t missing) const;
  [[nodiscard]] std::uint64_t best_missing(std::size_t& agreeing) const;
  [[nodiscard]] bool widens(const TimedSample& sample);
  [[nodiscard]] TickLine begun(const TimedSample& sample) const;

  TickLine line_;
  std::uint64_t missing_ = 0; // since the line began
  std::vector<TimedSample> waiting_;
  std::uint32_t passed_over_ = 0;
  std::uint32_t strays_ = 0; // a tick off the line, until these widen it
  std::vector<TickedSample> decided_;
};

} // namespace dyncal::analysis
