// Answers about who conducted a run, and what was noted and happened in it:
// /api/bench/NAME/journal. From its run folder; of a run whose folder is elsewhere the journal that
// the store has; of one that neither has, nothing.
//
// A page that shows a run asks every few seconds: a result file, of which only its statements are
// taken, is read again when it was written anew. The store is opened for every question, one at a
// time, as for HistoryAnswers. Any thread.
#pragma once

#include <chrono>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include <httplib.h>

#include "services/base/error.hpp"
#include "services/programs/web/run_files.hpp"
#include "services/programs/web/state_cache.hpp"
#include "services/views/report/run_journal.hpp"

namespace dyncal::inline programs::web {

class JournalAnswers {
public:
  static constexpr std::size_t max_entries = 500; // the newest
  static constexpr std::size_t max_results_known = 16;
  static constexpr std::chrono::seconds longest_wait{1}; // for the store, where others ask it

  // The first two outlive the object. `place` as Store::open_existing() takes it; empty: no store.
  JournalAnswers(StateCache& cache, const RunFiles& files, std::string place)
      : cache_(cache), files_(files), place_(std::move(place)) {}

  // False: the address is another's.
  [[nodiscard]] bool answer(const httplib::Request& request, httplib::Response& response);

private:
  struct Noted {
    std::string conducted_by{}; // "A. Meter (meter on lab3)"
    std::string comment{};
    std::vector<JournalEntry> entries{}; // in the order of time
  };

  [[nodiscard]] Expected<Noted> of_folder(const std::string& bench, const std::string& run);
  [[nodiscard]] Expected<Noted> of_store(const std::string& bench, const std::string& run);
  // Who conducted it and the comment alone.
  [[nodiscard]] Noted statements_of(const std::string& run, const ServedFile& result);

  StateCache& cache_;
  const RunFiles& files_;
  std::string place_;
  std::timed_mutex store_mutex_;         // of who asks the store
  std::mutex mutex_;                     // of what follows
  std::map<std::string, Noted> results_; // by run and ETag
};

} // namespace dyncal::inline programs::web
