// `dyncal model RESULT.json...`: the parametric response of each sensor, and the filter that undoes
// it.
//
// Prints which orders the values support and the parameters with u; writes all numbers as JSON
// (services/views/model/model.schema.json), the residuals as figures. Exit status 1 and one line
// when a file is not a result, or nothing can be fitted. Belongs to one thread.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace dyncal::inline programs {

struct ModelCommand {
  std::vector<std::filesystem::path> results;
  std::vector<std::string> channels; // empty: all that respond
  std::string kind = "auto";
  bool include_flagged = false;
  std::filesystem::path json;
  std::filesystem::path figures;
  std::string filter; // empty: none; fir, iir
  double rate_hz = 0.0;
  double cutoff_hz = 0.0;
  int taps = 0;
  std::optional<int> delay_samples;
};

// Of --kind: "auto" and every kind.
[[nodiscard]] std::vector<std::string> model_kind_names();

[[nodiscard]] int run_model(const ModelCommand& command);

} // namespace dyncal::inline programs
