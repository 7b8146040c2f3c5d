// A result file of dyncal as the store keeps it: what is in it, the file itself, and how far its
// run came.
//
// Fails (bad_file) as read_result() does; a run folder stands for the result.json in it. Any
// thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "services/base/error.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline records {

enum class RunCompletion {
  complete,    // every planned step has a value
  incomplete,  // steps without a value, or a channel
  interrupted, // by the user
  ended_early, // for a reason that the result states
  unfinished   // runs now, or its program ended before it
};
[[nodiscard]] std::string to_string(RunCompletion state);

struct ResultRecord {
  StoredResult result;
  RunCompletion state = RunCompletion::complete;
  std::int64_t measured_steps = 0;
  std::string folder;   // or file, absolute
  std::string document; // the file
};

[[nodiscard]] Expected<ResultRecord> read_result_record(const std::filesystem::path& path);

} // namespace dyncal::inline records
