// The transfer function in a result file of dyncal (the means over repetitions), for commands that
// go on from results.
//
// Points without a value are left out. Fails (bad_file) as read_values() does. Any thread.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>

#include "analysis/response/comparison.hpp"
#include "services/base/byte_count.hpp"
#include "services/base/error.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {

struct ResultPoint {
  std::string unit;
  analysis::ComparedResult value;
};

// By channel and frequency in Hz.
using ResultPoints = std::map<std::pair<std::string, double>, ResultPoint>;

// So that its factor 2 gives the U that was stated.
[[nodiscard]] analysis::ComparedResult comparable(const StoredValue& value);

[[nodiscard]] Expected<ResultPoints> read_result_file(const std::filesystem::path& path,
                                                      ByteCount& bytes);

} // namespace dyncal::inline views
