// The runs that another analysis service leads, or of which no leader is known yet: what was heard
// of each, so that this service can take it over.
//
// A run is deserted when its leader, if there was one, and then nobody, has been heard of for
// OtherAnalyses::silence_limit, although the run itself goes on: it was heard of more than once,
// for the last word of a run that has ended stays readable for a while.
//
// Bound: `max_runs`, for their messages hold whole recipes. The one that was heard of longest ago
// makes way, those first that were heard of once. One thread.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "idl/dyncal.h"
#include "services/programs/analysis/other_analyses.hpp"

namespace dyncal::inline programs {

struct FollowedRun {
  using Instant = bus::Clock::Instant;

  wire::Measurement measurement;
  std::optional<wire::Excitation> excitation;
  Instant since;
  Instant heard;           // of the run
  int messages = 0;        // of the run itself; none as long as only its excitation was heard of
  bool left_alone = false; // its leader had other software
};

class FollowedRuns {
public:
  using Instant = FollowedRun::Instant;
  static constexpr std::size_t max_runs = 1000;

  // `others` outlives the object.
  explicit FollowedRuns(const OtherAnalyses& others) : others_(others) {}

  void add(const RunKey& key, const wire::Measurement& measurement, Instant now);
  // Perhaps before anything was heard of its run: topics have no order among each other.
  void add(const RunKey& key, const wire::Excitation& excitation, Instant now);
  void erase(const RunKey& key) { runs_.erase(key); }

  // How often the run itself was heard of.
  [[nodiscard]] int messages(const RunKey& key) const;
  // Some run of the bench goes on, and another service leads it.
  [[nodiscard]] bool leads_other(const std::string& bench, Instant now) const;
  // One that is deserted and not left alone; null: there is none.
  [[nodiscard]] std::map<RunKey, FollowedRun>::value_type* deserted(Instant now);

  [[nodiscard]] std::size_t size() const { return runs_.size(); }
  [[nodiscard]] std::uint64_t left_out() const { return left_out_; } // although they went on

private:
  FollowedRun& at(const RunKey& key, Instant now);
  [[nodiscard]] bool is_deserted(const RunKey& key, const FollowedRun& run, Instant now) const;

  const OtherAnalyses& others_;
  std::map<RunKey, FollowedRun> runs_;
  std::uint64_t left_out_ = 0;
};

} // namespace dyncal::inline programs
