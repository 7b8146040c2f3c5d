// The flags of a run for those who read its results: which point has which, and what each means.
//
// Names and explanations are those of services/evaluation/result/result_flag.hpp. Plain functions,
// any thread.
#pragma once

#include <string>
#include <vector>

#include "services/evaluation/result/run_outcome.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {

// Of these flags, each kind once and in the order of ResultFlag, with each sentence of it once.
[[nodiscard]] std::vector<StoredFlag> flag_legend(const std::vector<Flag>& flags);

// Of the legend of a stored result what concerns these channels: flags that they, their means or
// their single results have, with the sentences of those. What only other channels have, or a
// clock, says nothing of them.
[[nodiscard]] std::vector<StoredFlag> legend_of_channels(const StoredResult& result,
                                                         const std::vector<std::string>& channels);

// "samples_lost (dau: samples lost; acs: samples lost): samples of this source are missing ..."
[[nodiscard]] std::string legend_line(const StoredFlag& meaning);

// All of a run, or of one of its channels.
[[nodiscard]] std::vector<Flag> flags_of(const RunOutcome& outcome);
[[nodiscard]] std::vector<Flag> flags_of(const RunOutcome& outcome,
                                         const TransferFunction& function);
// Of the valid results that a mean was made of.
[[nodiscard]] std::vector<Flag> flags_of(const RunOutcome& outcome, const std::string& channel,
                                         const FrequencyPoint& point);

// Each kind and sentence once.
[[nodiscard]] std::vector<Flag> flags_once(const std::vector<Flag>& flags);

// The names, each once, separated by spaces: "samples_lost shots_missing".
[[nodiscard]] std::string flag_names(const std::vector<Flag>& flags);

} // namespace dyncal::inline views
