// The results of all runs of a laboratory, each with recipe, software and hashes, in one database.
//
// A result is known by bench, run and recipe. Adding it again does nothing; a second, different
// result of the same identity is refused, naming both. One exception: the result of a run that had
// not ended gives way to a later one of that run. The same run evaluated by another recipe stands
// beside.
//
// The store is an index: the run folders are the truth, and from them it can be rebuilt. Fails
// (bad_file, bad_argument) as databases and result files do. Belongs to one thread.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "services/base/acting_person.hpp"
#include "services/base/error.hpp"
#include "services/base/work_count.hpp"
#include "services/records/store/audit_trail.hpp"
#include "services/records/store/database.hpp"
#include "services/records/store/result_record.hpp"
#include "services/records/store/run_entries.hpp"
#include "services/views/report/common_part.hpp"
#include "services/views/report/run_journal.hpp"

namespace dyncal::inline records {

// `option`: what the user gave, a place as is_server() knows it; "none": no store, returned as "";
// "": dyncal.sqlite in the folder of all runs.
[[nodiscard]] std::string store_place(const std::string& option,
                                      const std::filesystem::path& runs_folder);

enum class StoreAddition { added, already_there, replaced_unfinished };

struct StoredRun {
  std::string bench;
  std::string run;
  std::string state; // to_string(RunCompletion)
  std::string began_utc;
  std::string ended_utc;
  std::string method;
  std::string software;
  std::string recipe_sha256;
  std::string result_sha256;
  std::int64_t planned_steps = 0;
  std::int64_t measured_steps = 0;
  std::string problem;
  std::string folder;
  std::string conducted_by{}; // "A. Meter (meter on lab3)"; empty: not known
  std::vector<RunSource> sources;
  std::vector<std::string> amendments{}; // sentences; what they correct is corrected here
};

struct RunFilter { // empty: any
  std::string bench{};
  std::string sensor{}; // serial number, device or name of a source
  std::string since{};  // "2026-11-22", or longer; of the begin, in UTC
  std::string until{};  // the whole day, if it is one
  std::string state{};
};

struct OpenClosure { // that casts doubt on values
  std::string channel;
  std::string sentence; // "dau/x: phase towards 0 Hz: ..."
};

// What one run says of one sensor.
struct Calibration {
  StoredRun run;
  std::string source; // the sensor's, in the run
  std::vector<StoredValue> points;
  std::vector<OpenClosure> open_closures{};
  CommonParts common{}; // by add_common_parts(); empty: not known
};

struct KeptHash {
  std::string sha256;    // of a result file
  std::string since_utc; // when it was added
};

class Store {
public:
  // Makes it if there is none.
  [[nodiscard]] static Expected<std::unique_ptr<Store>> open(const std::string& place);
  // Fails (bad_file) if there is none, for those who only look something up.
  [[nodiscard]] static Expected<std::unique_ptr<Store>> open_existing(const std::string& place);

  // A result file, or a run folder with its journal.
  [[nodiscard]] Expected<StoreAddition> add(const std::filesystem::path& path,
                                            const ActingPerson& by = acting_person());
  // Those that it does not have yet.
  [[nodiscard]] Expected<void> add_entries(const std::string& bench, const std::string& run,
                                           const std::vector<JournalEntry>& entries,
                                           const ActingPerson& by = acting_person());
  [[nodiscard]] Expected<std::vector<JournalEntry>> entries_of(const std::string& bench,
                                                               const std::string& run) {
    return records::entries_of(*database_, bench, run);
  }
  [[nodiscard]] Expected<std::vector<AuditEntry>> audit() { return audit_entries(*database_); }
  [[nodiscard]] Expected<std::vector<std::string>> audit_problems() {
    return records::audit_problems(*database_);
  }
  // Of the file that is kept of this run by this recipe; nothing: none is.
  [[nodiscard]] Expected<std::optional<KeptHash>> hash_of(const StoredResult& result);
  // By time.
  [[nodiscard]] Expected<std::vector<StoredRun>> runs(const RunFilter& filter,
                                                      const SharedWorkCount& count = nullptr);
  // Of a sensor by serial number, device or name of its source; by time.
  [[nodiscard]] Expected<std::vector<Calibration>>
  calibrations(const std::string& sensor, const SharedWorkCount& count = nullptr);
  // Serial numbers of all sensors that have values, or devices where there is none.
  [[nodiscard]] Expected<std::vector<std::string>> sensors();
  // Of the result files, which are read again for it.
  [[nodiscard]] Expected<void> add_common_parts(std::vector<Calibration>& calibrations,
                                                const SharedWorkCount& count = nullptr);

private:
  explicit Store(std::unique_ptr<Database> database) : database_(std::move(database)) {}
  Expected<StoreAddition> make_way(const ResultRecord& record, const ActingPerson& by);
  Expected<StoreAddition> add_result(const ResultRecord& record, const ActingPerson& by);
  Expected<void> amend(std::vector<StoredRun>& runs);
  Expected<std::vector<RunSource>> sources_of(const std::string& result_sha256);
  Expected<std::vector<StoredValue>> points_of(const std::string& result_sha256,
                                               const std::string& source);
  Expected<std::vector<OpenClosure>> open_closures_of(const std::string& result_sha256,
                                                      const std::string& source);

  std::unique_ptr<Database> database_;
};

} // namespace dyncal::inline records
