// Whether a result file is what was measured, before a document is made of it or believed.
//
// Three things are asked: are its means those of its single results (views/report/mean_check.hpp);
// is it the file that the store has of its run, by SHA-256; does the recording in its run folder,
// evaluated once more, give the same (repeated_evaluation.hpp). What contradicts it makes it fail
// (no_result). The journal of the run is that of its folder, and the store must not have more of
// it; an amendment that the store does not have is an objection. What cannot be asked is an
// objection only where nothing else speaks for the file.
//
// Fails (bad_file) as stores do, (interrupted). Blocks; belongs to one thread.
#pragma once

#include <filesystem>
#include <stop_token>
#include <string>

#include "services/base/error.hpp"
#include "services/base/work_count.hpp"
#include "services/views/objections/held_result.hpp"

namespace dyncal::inline records {

// `run`: its folder, or a result file. `store`: a place (store.hpp); "" or one that is not there
// yet: none. Fails as read_values() does, too.
[[nodiscard]] Expected<HeldResult> read_held_result(const std::filesystem::path& run,
                                                    const std::string& store,
                                                    const SharedWorkCount& count,
                                                    const std::stop_token& stop);

} // namespace dyncal::inline records
