// Who conducts a run, and what another conductor's Measurement of the same name means.
//
// Who goes on with a run begins with RUNNING and has its recipe. A name of an older program may
// come again: PLANNED by another conductor, or another recipe, is another run, which is said once
// and not taken for this one. Belongs to the service's one thread.
#pragma once

#include <chrono>
#include <string>

#include "idl/dyncal.h"

namespace dyncal::inline programs {

class RunConductor {
public:
  enum class Claim {
    this_run,
    another_run,
    resumes_wrongly // with another recipe, and this run's own conductor is not heard any more
  };

  explicit RunConductor(const wire::Measurement& first)
      : name_(first.conductor()), recipe_sha256_(first.recipe_sha256()) {}

  // `unheard`: since when nothing was heard of the run; beyond `alive_limit` its conductor is gone.
  [[nodiscard]] Claim judge(const wire::Measurement& measurement, std::chrono::nanoseconds unheard,
                            std::chrono::nanoseconds alive_limit);

  [[nodiscard]] const std::string& name() const { return name_; }
  // By another conductor, and its sources were not seen to be the run's.
  [[nodiscard]] bool is_resumed() const { return is_resumed_; }
  void note_sources_seen() { is_resumed_ = false; }

private:
  std::string name_;
  std::string recipe_sha256_;
  bool is_resumed_ = false;
  bool other_run_said_ = false;
};

} // namespace dyncal::inline programs
