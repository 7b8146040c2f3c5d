// The files that a bench file names: where they are, and which they are.
//
// A name is resolved from the bench file's folder; an absolute one stands for itself. A run folder
// (services/records/run_folder) holds copies of them. There a name has the same place as beside the
// bench file where that is possible; names that lead out of the folder, or that a run folder has
// for its own files, are below `outside/`:
//
//   calibration/adc.json  calibration/adc.json       ../adc.json       outside/up/adc.json
//   /lab/adc.json         outside/root/lab/adc.json  ./result.json     outside/here/result.json
//
// Belongs to one thread.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace dyncal::inline bench {

// What a run folder has for its own files; a name that begins with one of them is not used for a
// copy.
inline constexpr std::string_view copied_bench_file = "bench.toml";
inline constexpr std::string_view result_file_name = "result.json";
inline constexpr std::string_view log_file_name = "log.txt";
inline constexpr std::string_view figures_folder_name = "figures";
inline constexpr std::string_view recording_file_name = "recording.mcap";

struct NamedFile {
  std::string name;           // as the bench file has it
  std::filesystem::path path; // absolute; a file or a folder
};

// Where a run folder has its copy of a file of this name, relative to the run folder.
[[nodiscard]] std::filesystem::path place_of_copy(const std::string& name);

class NamedFiles {
public:
  enum class Place { as_named, copies };

  // `folder` of the bench file.
  NamedFiles(std::filesystem::path folder, Place place)
      : folder_(std::move(folder)), place_(place) {}

  // Absolute and in normal form; the folder itself for an empty name.
  [[nodiscard]] std::filesystem::path resolve(const std::string& name);
  // Absolute; of what is written, and so is none of them.
  [[nodiscard]] std::filesystem::path output(const std::string& name) const {
    return std::filesystem::absolute(folder_ / name).lexically_normal();
  }
  // All that were resolved, in this order, each once.
  [[nodiscard]] const std::vector<NamedFile>& all() const { return all_; }

private:
  std::filesystem::path folder_;
  Place place_;
  std::vector<NamedFile> all_;
};

} // namespace dyncal::inline bench
