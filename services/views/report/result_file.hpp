// The transfer function in a result file of dyncal (the means over repetitions), for commands that
// go on from results.
//
// Points without a value are left out. Fails (bad_file) when the file cannot be read or is not a
// result. Any thread.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>

#include "analysis/response/comparison.hpp"
#include "services/base/byte_count.hpp"
#include "services/base/error.hpp"

namespace dyncal::services {

struct ResultPoint {
  std::string unit;
  analysis::ComparedResult value;
};

// By channel and frequency in Hz.
using ResultPoints = std::map<std::pair<std::string, double>, ResultPoint>;

[[nodiscard]] Expected<ResultPoints> read_result_file(const std::filesystem::path& path);
// Counts what it reads.
[[nodiscard]] Expected<ResultPoints> read_result_file(const std::filesystem::path& path,
                                                      ByteCount& bytes);

} // namespace dyncal::services
