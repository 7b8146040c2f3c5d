// Answers about earlier runs of a sensor: /api/history, from the store of all results.
//
// The store is opened for every question, since programs that write to it come and go; one question
// at a time. A server that is stopped holds the one who asks it for ten seconds (database.hpp) and
// the others, who would take all threads of the page, for a second. Any thread.
#pragma once

#include <chrono>
#include <mutex>
#include <string>

#include <httplib.h>

namespace dyncal::inline programs::web {

class HistoryAnswers {
public:
  static constexpr std::size_t max_runs = 200; // the newest

  static constexpr std::chrono::seconds longest_wait{1}; // a question takes milliseconds

  // `place` as Store::open_existing() takes it; empty: there is no store.
  explicit HistoryAnswers(std::string place) : place_(std::move(place)) {}

  // False: the address is another's.
  [[nodiscard]] bool answer(const httplib::Request& request, httplib::Response& response);

private:
  std::string place_;
  std::timed_mutex mutex_; // of who asks the store
};

} // namespace dyncal::inline programs::web
