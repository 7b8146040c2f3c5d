// Answers about earlier runs of a sensor: /api/history, from the store of all results.
//
// The store is opened for every question, since programs that write to it come and go; one question
// at a time. Any thread.
#pragma once

#include <mutex>
#include <string>

#include <httplib.h>

namespace dyncal::services::web {

class HistoryAnswers {
public:
  static constexpr std::size_t max_runs = 200; // the newest

  // `place` as Store::open_existing() takes it; empty: there is no store.
  explicit HistoryAnswers(std::string place) : place_(std::move(place)) {}

  // False: the address is another's.
  [[nodiscard]] bool answer(const httplib::Request& request, httplib::Response& response);

private:
  std::string place_;
  std::mutex mutex_;
};

} // namespace dyncal::services::web
