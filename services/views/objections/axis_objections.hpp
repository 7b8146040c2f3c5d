// What speaks against a document because of the axes of its channels: across the excited one a
// transfer function holds what the exciter moves there, which its uncertainty must have (transverse
// motion, services/evaluation/method/transverse_motion.hpp); and where channels lie along several
// axes, nobody knows which of them are across an axis that was not stated.
//
// A channel of another kind than the reference (a gyroscope on a shaker) has no axis in common with
// it, and nothing is said of it. Plain functions; any thread.
#pragma once

#include <string>
#include <vector>

#include "services/views/language/sentence.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {

[[nodiscard]] std::vector<TranslatedText>
objections_to_axes(const StoredResult& result, const std::vector<std::string>& channels);

} // namespace dyncal::inline views
