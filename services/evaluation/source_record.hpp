// What one source has sent in a run, as long as it may still be needed: stamps, flags and columns,
// in the source's own clock, and what was lost on the way.
//
// Samples are only ever appended as they come and forgotten from the front; how the stream was cut
// into blocks leaves no trace. A new session of the source (it was restarted) drops what was
// buffered, since sample numbers and perhaps the clock begin anew. The buffer is bounded: beyond
// `capacity` samples the oldest are dropped and counted. Belongs to one thread.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "drivers/sample_block.hpp"
#include "idl/dyncal.h"
#include "services/contract/sample_continuity.hpp"

namespace dyncal::services {

class SourceRecord {
public:
  static constexpr std::size_t default_capacity = std::size_t{1} << 24U;

  explicit SourceRecord(std::string source, std::size_t capacity = default_capacity)
      : source_(std::move(source)), capacity_(capacity) {}

  [[nodiscard]] const std::string& source() const { return source_; }

  void describe(const wire::SourceDescription& description);
  [[nodiscard]] bool described() const { return description_.has_value(); }
  [[nodiscard]] const wire::SourceDescription& description() const {
    return *description_;
  } // REQUIRES: described()
  [[nodiscard]] std::optional<std::size_t> channel(const std::string& name) const;

  // Only these channels are kept from now on, for nothing else is asked for; what was not kept so
  // far counts as not measured.
  void keep_only(std::set<std::size_t> channels);

  // Appends the block's samples; false when it cannot be used (sizes contradict each other, other
  // number of channels): it is counted.
  bool add(const wire::SampleBlock& block);

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

  // A record of its own that says the same of the time between the two stamps, both included, while
  // this one goes on.
  [[nodiscard]] SourceRecord part(std::int64_t begin_ns, std::int64_t end_ns) const;

  // Standard uncertainty of the stamps between the two in the time base of the source: the mean of
  // what they say themselves, and at least what the description says. 0: neither says anything.
  // REQUIRES: described()
  [[nodiscard]] double stamp_uncertainty_s(std::int64_t begin_ns, std::int64_t end_ns) const;

  // Samples known to be missing between the two stamps.
  [[nodiscard]] std::uint64_t lost_between(std::int64_t begin_ns, std::int64_t end_ns) const;

  [[nodiscard]] bool ended() const { return ended_; }
  [[nodiscard]] std::uint32_t restarts() const { return restarts_; }
  [[nodiscard]] std::uint64_t lost() const { return lost_; }
  [[nodiscard]] std::uint64_t overflowed() const { return overflowed_; }
  [[nodiscard]] std::uint64_t unusable_blocks() const { return unusable_blocks_; }
  // Host clock of the source's service at its newest block; 0 before the first.
  [[nodiscard]] std::int64_t newest_received_utc_ns() const { return newest_received_utc_ns_; }

private:
  struct Gap {
    std::int64_t before_ns;
    std::int64_t after_ns;
    std::uint64_t samples;
  };

  [[nodiscard]] bool keeps(std::size_t channel) const {
    return !kept_channels_ || kept_channels_->contains(channel);
  }
  [[nodiscard]] bool usable(const wire::SampleBlock& block) const;
  void append(const wire::SampleBlock& block);
  void restart();
  void forget(std::size_t samples);

  std::string source_;
  std::size_t capacity_;
  std::optional<wire::SourceDescription> description_;
  std::optional<std::set<std::size_t>> kept_channels_; // all when there is no set
  bus::SampleContinuity continuity_;
  std::size_t first_ = 0;
  std::vector<std::int64_t> stamps_ns_;
  std::vector<std::uint8_t> flags_;
  std::vector<std::uint32_t>
      stamp_uncertainties_ns_; // 0: the sample says nothing; empty while none says anything
  std::vector<std::vector<double>> columns_;
  std::deque<Gap> gaps_;
  std::optional<std::int64_t> newest_ns_;
  std::uint64_t forgotten_ = 0;
  std::uint64_t lost_ = 0;
  std::uint64_t overflowed_ = 0;
  std::uint64_t unusable_blocks_ = 0;
  std::uint32_t restarts_ = 0;
  std::int64_t newest_received_utc_ns_ = 0;
  bool ended_ = false;
};

} // namespace dyncal::services
