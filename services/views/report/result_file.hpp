// The points of a result file of dyncal, for commands that go on from results.
//
// Points without a value are left out. Any thread.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "analysis/response/comparison.hpp"
#include "services/evaluation/result/point_identity.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {

struct ResultPoint {
  std::string unit;
  analysis::ComparedResult value;
  std::uint32_t attempt = 0; // of a mean 0
};

// In the order of their identity. Where a plan has one twice, in the order of its steps.
using ResultPoints = std::multimap<PointIdentity, ResultPoint>;

[[nodiscard]] PointIdentity identity_of(const StoredValue& value);

[[nodiscard]] analysis::ComparedResult comparable(const StoredValue& value);

[[nodiscard]] ResultPoints means_of(const StoredResult& result);
// Of every repetition the last attempt, which is the one that counts: the attempt is left out of
// their identity.
[[nodiscard]] ResultPoints repetitions_of(const StoredResult& result);

} // namespace dyncal::inline views
