// The folder of one run: made and checked before the first step, brought up to date after every
// step, whole at any instant (README.md has its files).
//
// Fails (bad_file) with the folder, the reason and what to do: a root that cannot be written, a
// folder that exists already, a file that cannot be copied, too little room. A folder that was made
// for a run that then excited nothing is removed with discard(). Two programs never write into one
// run folder: it is locked (flock) while the object lives.
//
// Belongs to one thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "drivers/link/file_descriptor.hpp"
#include "services/base/error.hpp"
#include "services/bench/file/bench_file.hpp"
#include "services/evaluation/result/run_outcome.hpp"
#include "services/records/run_folder/result_keeper.hpp"
#include "services/records/run_folder/space_estimate.hpp"

namespace dyncal::inline records {

class RunFolder {
public:
  // Makes the folder of a new run, with the bench file and copies of the files it names.
  [[nodiscard]] static Expected<std::unique_ptr<RunFolder>>
  create(const std::filesystem::path& root, const BenchFile& bench, const std::string& name);
  // The folder of a run that is resumed: the newest of `bench` that is of `run`; nothing when there
  // is none. Fails (bad_file) too where the run was begun with another bench file.
  [[nodiscard]] static Expected<std::unique_ptr<RunFolder>>
  reopen(const std::filesystem::path& root, const BenchFile& bench, const std::string& run);

  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;
  ~RunFolder();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  // A name that is free: recording.mcap, or recording-2.mcap of a run that was resumed.
  [[nodiscard]] std::filesystem::path recording_path() const;

  [[nodiscard]] std::uint64_t free_bytes() const;
  // Whether the disk has room for it.
  [[nodiscard]] Expected<void> check_room(const SpaceEstimate& need) const;

  // In the course of the run; result.json is written by a thread of its own.
  [[nodiscard]] ResultKeeper& results() { return *results_; }
  // When the run is over: the last result.json and the figures.
  [[nodiscard]] Expected<void> finish(const RunOutcome& outcome);
  // Removes a folder that create() made; one of a run that is resumed stays.
  void discard();

private:
  RunFolder(std::filesystem::path path, drivers::FileDescriptor lock, bool is_new);

  std::filesystem::path path_;
  drivers::FileDescriptor lock_;
  bool is_new_;
  std::unique_ptr<ResultKeeper> results_;
};

// The newest folder of the bench whose run is called so (services/contract/run_identity.hpp);
// empty: there is none. A link to a folder is not the run of its name.
[[nodiscard]] std::filesystem::path find_run_folder(const std::filesystem::path& root,
                                                    const std::string& bench,
                                                    const std::string& run);

// What a person means who writes ROOT/BENCH/NAME: the file or folder of that path, or, where there
// is none, the newest run of that name; the path as it is, where there is none of these.
[[nodiscard]] std::filesystem::path run_path(const std::filesystem::path& typed);

// Whether a program that conducts the run has the folder open now.
[[nodiscard]] bool is_in_use(const std::filesystem::path& run_folder);

} // namespace dyncal::inline records
