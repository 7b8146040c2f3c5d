// All excitations of one channel at the frequencies of a plan, whatever their order
// (recorded_excitations.hpp), from a stream of blocks.
//
// A search for each frequency goes through all samples (analysis/step/excitation_window.hpp). What
// several find at once is of the nearest frequency, or of the louder one; a sine that is far below
// all steps is hum. Parts of one excitation, with no quiet time between them (the clock was set, or
// samples are missing), count as one: the first of them. Cost: a search of a run's steps, for
// each frequency. Memory: the samples of an excitation. Belongs to one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analysis/base/frequency.hpp"
#include "analysis/step/excitation_window.hpp"
#include "services/contract/channel_name.hpp"
#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/record/recorded_excitations.hpp"
#include "services/evaluation/record/source_record.hpp"

namespace dyncal::inline evaluation {

class ExcitationSurvey {
public:
  // `reference`: of the same source, for levels, which a multi-sine has none of.
  ExcitationSurvey(ChannelName searched, std::optional<std::string> reference,
                   const Recipe& recipe);

  [[nodiscard]] const std::string& source() const { return searched_.source; }
  void describe(drivers::SourceDescription description);
  // REQUIRES: it was described. The last block ends the stream.
  void add(const SourceBlock& block);
  // After the last block.
  [[nodiscard]] RecordedExcitations result() const;

private:
  struct Track { // of one frequency, or of all lines of a multi-sine
    std::vector<RecipeStep> lines;
    std::optional<analysis::ExcitationWindowFinder> finder{};
    std::int64_t from_ns;
    std::uint64_t fed = 0; // samples of the record, counted from its very first
  };

  void search(Track& track);
  void keep(const Track& track, const analysis::ExcitationWindow& window);
  void note_samples(std::size_t samples);
  [[nodiscard]] bool are_parts_of_one(const FoundExcitation& a, const FoundExcitation& b) const;
  void join_parts(std::vector<FoundExcitation>& found) const;
  void note_cut_ends(std::vector<FoundExcitation>& found) const;
  void forget();

  ChannelName searched_;
  std::optional<std::string> reference_;
  double level_range_ = 1.0; // lowest planned level over the highest
  SourceRecord record_;
  std::vector<Track> tracks_;
  double longest_step_s_ = 0.0; // as planned
  std::uint64_t samples_ = 0;
  std::uint64_t untrusted_ = 0;
  std::vector<std::int64_t> intervals_ns_; // some
  RecordedExcitations result_;
};

} // namespace dyncal::inline evaluation
