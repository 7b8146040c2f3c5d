// What one source has sent in a run, as long as it may still be needed: stamps, flags and columns,
// in the source's own clock, and what was lost on the way.
//
// Samples are only ever appended as they come and forgotten from the front; how the stream was cut
// into blocks leaves no trace. A new session of the source (it was restarted) drops what was
// buffered, since sample numbers and perhaps the clock begin anew.
//
// This is the one place where losses of a source are counted. Lost are samples that the numbering
// shows to be missing (never sent, or in a block that did not come or could not be used), those
// that stamps show to be missing where the numbering does not (a source that has none), and those
// that the bounded buffer dropped before they were evaluated: beyond `capacity` samples the oldest
// go. Each loss stands between two stamps, so that it counts for the steps it belongs to.
//
// Belongs to one thread.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "drivers/sample_block.hpp"
#include "services/contract/sample_continuity.hpp"
#include "services/contract/source_block.hpp"
#include "services/evaluation/record/time_interval.hpp"

namespace dyncal::analysis {
class PeriodCount;
}

namespace dyncal::inline evaluation {

struct SampleLoss {
  std::uint64_t missing = 0;    // did not come
  std::uint64_t unusable = 0;   // came in a block that could not be used
  std::uint64_t overflowed = 0; // came and were dropped before they were evaluated

  [[nodiscard]] std::uint64_t all() const { return missing + unusable + overflowed; }
  friend bool operator==(const SampleLoss&, const SampleLoss&) = default;
};

class SourceRecord {
public:
  static constexpr std::size_t default_capacity = std::size_t{1} << 24U;

  explicit SourceRecord(std::string source, std::size_t capacity = default_capacity);
  ~SourceRecord();
  SourceRecord(SourceRecord&&) noexcept;
  SourceRecord& operator=(SourceRecord&&) noexcept;

  [[nodiscard]] const std::string& source() const { return source_; }

  void describe(drivers::SourceDescription description) { description_ = std::move(description); }
  [[nodiscard]] bool described() const { return description_.has_value(); }
  [[nodiscard]] const drivers::SourceDescription& description() const {
    return *description_;
  } // REQUIRES: described()
  // Its place among the columns.
  [[nodiscard]] std::optional<std::size_t> channel(const std::string& name) const;

  // Only these channels are kept from now on, for nothing else is asked for; what was not kept so
  // far counts as not measured.
  void keep_only(std::set<std::size_t> channels);

  // Appends the block's samples. Returns false if it has none to use: a duplicate, an empty block,
  // or one whose sizes contradict each other or earlier blocks; samples of the last are lost.
  bool add(const SourceBlock& block);

  // A block of the session came from another program than the others, and is not added: something
  // else sends as this source now.
  void note_second_writer();

  // Whether a block of this session would drop what is held.
  [[nodiscard]] bool is_new_session(std::uint64_t session) const {
    return continuity_.is_new_session(session);
  }

  [[nodiscard]] std::span<const std::int64_t> stamps_ns() const {
    return std::span(stamps_ns_).subspan(first_);
  }
  [[nodiscard]] std::span<const std::uint8_t> flags() const {
    return std::span(flags_).subspan(first_);
  }
  // Empty when the samples so far have no such column, or it is not kept.
  [[nodiscard]] std::span<const double> column(std::size_t channel) const;
  // Samples ever dropped from the front or by a restart: index i of stamps_ns() is the (forgotten()
  // + i)-th sample received.
  [[nodiscard]] std::uint64_t forgotten() const { return forgotten_; }

  void forget_before(std::int64_t stamp_ns);

  // A record of its own that reports the same of this interval, while this one goes on.
  [[nodiscard]] SourceRecord part(const TimeInterval& interval) const;

  // Standard uncertainty of the stamps in the interval in the time base of the source: the mean of
  // what they carry themselves, and at least what the description gives. 0: neither is known.
  // REQUIRES: described()
  [[nodiscard]] double stamp_uncertainty_s(const TimeInterval& interval) const;

  // Samples known to be lost in the interval.
  [[nodiscard]] SampleLoss lost_in(const TimeInterval& interval) const;

  // Whether a second writer was noted while samples of the interval came.
  [[nodiscard]] bool has_second_writer_in(const TimeInterval& interval) const;

  [[nodiscard]] bool ended() const { return ended_; }
  [[nodiscard]] std::uint32_t restarts() const { return restarts_; }
  // Samples that never came in a form that could be used.
  [[nodiscard]] std::uint64_t lost() const {
    return continuity_.counts().missing_samples + continuity_.pending_samples() + unnumbered_;
  }
  [[nodiscard]] std::uint64_t overflowed() const { return overflowed_; }
  [[nodiscard]] std::uint64_t unusable_blocks() const {
    return continuity_.counts().unusable_blocks;
  }
  // By how much the trusted stamps of this session have gone back at most: its clock was set back.
  [[nodiscard]] std::int64_t set_back_ns() const { return set_back_ns_; }
  // First stamp of its session, which may be forgotten.
  [[nodiscard]] std::optional<std::int64_t> began_ns() const { return began_ns_; }
  // Nothing before the first sample of its session.
  [[nodiscard]] std::optional<std::int64_t> newest_stamp_ns() const { return newest_ns_; }

private:
  struct Gap { // what was lost lies between these stamps, both excluded
    std::int64_t before_ns;
    std::int64_t after_ns;
    SampleLoss loss;
  };

  static void add_gap(std::deque<Gap>& gaps, const Gap& gap);
  // Behind the newest sample; nothing when none is known to be missing there.
  [[nodiscard]] std::optional<Gap> open_gap() const;

  [[nodiscard]] bool keeps(std::size_t channel) const {
    return !kept_channels_ || kept_channels_->contains(channel);
  }
  [[nodiscard]] BlockUse use_of(const SourceBlock& block) const;
  void append(const SourceBlock& block);
  void append_stamps(const SourceBlock& block);
  void append_stamp_uncertainties(const SourceBlock& block);
  void find_unnumbered_gaps(const SourceBlock& block);
  void drop_overflow();
  void restart();
  void forget(std::size_t samples);

  std::string source_;
  std::size_t capacity_;
  std::optional<drivers::SourceDescription> description_;
  std::optional<std::set<std::size_t>> kept_channels_; // all when there is no set
  SampleContinuity continuity_;
  std::unique_ptr<analysis::PeriodCount> periods_;
  std::uint64_t unnumbered_ = 0; // missing by their stamps alone
  std::size_t first_ = 0;
  std::vector<std::int64_t> stamps_ns_;
  std::vector<std::uint8_t> flags_;
  // 0: not known for this sample; empty while none is known.
  std::vector<std::uint32_t> stamp_uncertainties_ns_;
  std::vector<std::vector<double>> columns_;
  std::deque<Gap> gaps_;                      // samples that did not come, in their order
  std::deque<Gap> overflow_;                  // samples that the buffer dropped, in their order
  std::deque<std::int64_t> second_writer_ns_; // the newest stamps when one was noted
  std::optional<std::int64_t> began_ns_;
  std::optional<std::int64_t> newest_ns_;
  std::optional<std::int64_t> latest_ns_; // of the trusted stamps
  std::int64_t set_back_ns_ = 0;
  std::uint64_t forgotten_ = 0;
  std::uint64_t overflowed_ = 0;
  std::uint32_t restarts_ = 0;
  bool ended_ = false;
};

} // namespace dyncal::inline evaluation
