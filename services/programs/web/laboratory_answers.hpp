// Answers about the state of the laboratory and its benches: /api/laboratory, /api/bench/NAME and
// what is below it, files of runs. Any thread.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <httplib.h>

#include "services/programs/web/run_files.hpp"
#include "services/programs/web/state_cache.hpp"

namespace dyncal::inline programs::web {

// "/api/bench/acc-1/run" is {"acc-1", "run"}, "/api/bench/acc-1" is {"acc-1", ""}; of a name that
// has a slash the last one divides. Nothing: another address. `parts`: what may follow a name.
struct BenchAddress {
  std::string bench;
  std::string part;
};
[[nodiscard]] std::optional<BenchAddress> bench_address(std::string_view path);

// Where there is no text, with 404 and what is said `otherwise`.
void answer_text(const Text& text, const std::string& otherwise, httplib::Response& response);

class LaboratoryAnswers {
public:
  // Both outlive the object.
  LaboratoryAnswers(StateCache& cache, const RunFiles& files) : cache_(cache), files_(files) {}

  // False: the address is another's.
  [[nodiscard]] bool answer(const httplib::Request& request, httplib::Response& response) const;
  // With the files of the run; null: no such bench or run.
  [[nodiscard]] Text results(const std::string& bench, const std::string& run) const;

private:
  void answer_figures(const std::string& bench, const httplib::Request& request,
                      httplib::Response& response) const;
  void answer_budget(const std::string& bench, const httplib::Request& request,
                     httplib::Response& response) const;
  [[nodiscard]] bool answer_file(const httplib::Request& request,
                                 httplib::Response& response) const;

  StateCache& cache_;
  const RunFiles& files_;
};

} // namespace dyncal::inline programs::web
