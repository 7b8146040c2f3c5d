// What visitors with a token that operates may do: command the conductor of a run, and start a run.
//
// A command is repeated until the conductor has answered it, for `answer_limit` at most, and its
// answer is the visitor's. A step that is to be excited once more may have to wait for the planned
// ones, longer than any visitor. A run is a `dyncal run` of a
// bench file of one folder, one at a time of a file; what it prints is in a file beside the runs.
// It is asked to end when the daemon ends. In a secured laboratory it has a folder of its own: the
// page's certificate conducts nothing. Every request is logged with who asked and its outcome;
// his name goes with a command, too. Any thread; one command at a time, but for an abort, which
// waits for none.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <httplib.h>

#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"
#include "services/daemon/program/child_process.hpp"
#include "services/daemon/program/program.hpp"
#include "services/programs/web/permission.hpp"
#include "services/programs/web/request_router.hpp"
#include "services/programs/web/state_cache.hpp"

namespace dyncal::inline programs::web {

struct ActionOptions {
  std::filesystem::path benches_folder;
  std::filesystem::path runs_folder;
  NetworkOptions network;
  std::string run_security; // folder of the runs; empty: they are not secured
  std::string sender;       // "dyncal-web:4711@lab-1"
};

class Actions {
public:
  static constexpr std::chrono::seconds answer_limit{3};
  static constexpr std::chrono::milliseconds command_interval{250};

  // All outlive the object.
  Actions(ActionOptions options, bus::Participant& participant, bus::Clock& clock,
          StateCache& cache, RequestRouter& router, Permission& permission);

  // False: the address is another's.
  [[nodiscard]] bool post(const httplib::Request& request, httplib::Response& response);
  [[nodiscard]] bool get(const httplib::Request& request, httplib::Response& response);

private:
  void command(const std::string& bench, const nlohmann::ordered_json& body,
               const std::string& sender, const httplib::Request& request,
               httplib::Response& response);
  void send(const wire::Command& command, const std::string& word, httplib::Response& response);
  // Returns why the conductor does not obey, "" where it does; nothing: it has not answered.
  [[nodiscard]] std::optional<std::string> repeat_until_answered(const wire::Command& command);
  // `stated`: further arguments of `dyncal run`.
  void start_run(const std::string& name, const std::vector<std::string>& stated,
                 httplib::Response& response);
  void list_bench_files(httplib::Response& response) const;

  ActionOptions options_;
  bus::Participant& participant_;
  bus::Clock& clock_;
  StateCache& cache_;
  RequestRouter& router_;
  Permission& permission_;
  std::mutex mutex_;
  std::map<std::string, ChildProcess> runs_; // by bench file
};

} // namespace dyncal::inline programs::web
