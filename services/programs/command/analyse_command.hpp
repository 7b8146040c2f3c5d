// `dyncal analyse BENCH.toml`: the same evaluation as a live run, from the bench file's file
// sources, without the network. Shots of series time stamping come from folders (shot_files.hpp).
//
// Files are read in threads of their own, a bounded stretch ahead; the evaluation runs in the
// caller's thread. All have ended when it returns. Fails like `dyncal run`: a file with an error is
// named with its line, a source that is neither a file nor a CAN log is refused.
#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>

#include "services/views/report/run_figures.hpp"

namespace dyncal::inline programs {

struct AnalyseCommand {
  std::filesystem::path bench_file; // or a run folder (services/records/run_folder), or a recording
                                    // (analyse_recording.hpp)
  std::string run;                  // of the recording; empty: the only one
  std::optional<std::filesystem::path> recipe; // bench file to evaluate the recording by
  std::optional<std::filesystem::path> json;
  FigureFiles figures;
};

[[nodiscard]] int run_analyse(const AnalyseCommand& command, const std::stop_token& stop);

} // namespace dyncal::inline programs
