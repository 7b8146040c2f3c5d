#include "tests/system/program_run.hpp"

#include <csignal>
#include <fstream>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>

#include "tests/dds_domain.hpp"
#include "tests/patience.hpp"

namespace dyncal::tests {
namespace {

constexpr std::chrono::milliseconds poll_interval{10};

std::string read(const std::filesystem::path& path) {
  std::ifstream stream(path);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

constexpr int status_not_checked = 77;

// Of dyncal's commands that write a file; other commands have an option of the same name.
std::optional<std::filesystem::path> result_of(const std::vector<std::string>& arguments) {
  const auto is = [&](const char* command) {
    return !arguments.empty() && arguments.front() == command;
  };
  if (!is("run") && !is("analyse") && !is("demo") && !is("model")) {
    return std::nullopt;
  }
  for (std::size_t i = 1; i + 1 < arguments.size(); ++i) {
    if (arguments[i] == "--output") {
      const std::filesystem::path output = arguments[i + 1];
      return is("demo") ? output / "result.json" : output;
    }
  }
  return std::nullopt;
}

daemon::ChildProcess started(const std::filesystem::path& program,
                             const std::vector<std::string>& arguments, daemon::ChildOutput output,
                             const std::filesystem::path& runs) {
  setenv("DYNCAL_RUNS", runs.c_str(), 1); // run folders stay with the test
  setenv("XDG_STATE_HOME", (runs.parent_path().parent_path() / "state").c_str(), 1); // a guard's
  setenv("DYNCAL_DOMAIN", std::to_string(own_dds_domain()).c_str(), 1);
  auto process = daemon::ChildProcess::start(program, arguments, std::move(output));
  if (!process) {
    throw std::runtime_error(process.error().message);
  }
  return std::move(*process);
}

} // namespace

ProgramRun::ProgramRun(const std::string& program, const std::vector<std::string>& arguments,
                       const std::filesystem::path& folder)
    : result_(result_of(arguments)),
      schema_(!arguments.empty() && arguments.front() == "model" ? DYNCAL_MODEL_SCHEMA
                                                                 : DYNCAL_RESULT_SCHEMA),
      output_(folder / (std::filesystem::path(program).filename().string() + ".out")),
      errors_(folder / (std::filesystem::path(program).filename().string() + ".err")),
      began_(std::chrono::steady_clock::now()),
      process_(started(std::filesystem::path(DYNCAL_PROGRAMS) / program, arguments,
                       {output_, errors_}, folder / "runs")) {}

ProgramRun::~ProgramRun() {
  process_.stop(std::chrono::seconds(5));
}

void ProgramRun::send(int signal) {
  process_.signal(signal);
}

bool ProgramRun::send_to_child(const std::string& program, int signal) {
  const std::string id = std::to_string(process_.id());
  std::istringstream children(read("/proc/" + id + "/task/" + id + "/children"));
  for (pid_t child = 0; children >> child;) {
    const std::string command = read("/proc/" + std::to_string(child) + "/cmdline");
    if (std::filesystem::path(command.substr(0, command.find('\0'))).filename() == program) {
      return kill(child, signal) == 0;
    }
  }
  return false;
}

void ProgramRun::check_result() const {
  if (!result_ || !std::filesystem::exists(*result_)) {
    return;
  }
  const std::filesystem::path output = result_->string() + ".check";
  auto check = started(DYNCAL_PYTHON, {"-B", DYNCAL_CHECK_RESULT, schema_, result_->string()},
                       {output, output}, result_->parent_path());
  const auto exit = check.wait_for(patience);
  if (exit && exit->status == status_not_checked) {
    std::cerr << read(output);
    return;
  }
  if (!exit || exit->status != 0) {
    throw std::runtime_error("the result does not agree with its schema, or the check ended with " +
                             (exit ? std::to_string(exit->status) : "nothing in time") + ": " +
                             read(output));
  }
}

std::optional<int> ProgramRun::wait(std::chrono::nanoseconds limit) {
  const auto exit = process_.wait_for(limit);
  if (!exit) {
    return std::nullopt;
  }
  if (!ended_) {
    ended_ = std::chrono::steady_clock::now();
    check_result();
  }
  return exit->status;
}

double ProgramRun::cpu_s() {
  const auto exit = process_.wait_for(std::chrono::nanoseconds(0));
  return exit ? exit->cpu_s : 0.0;
}

bool ProgramRun::wait_for_error_text(const std::string& text, std::chrono::seconds limit) {
  return wait_for_text(errors_, text, limit);
}

bool ProgramRun::wait_for_output_text(const std::string& text, std::chrono::seconds limit) {
  return wait_for_text(output_, text, limit);
}

bool ProgramRun::wait_for_text(const std::filesystem::path& file, const std::string& text,
                               std::chrono::seconds limit) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (read(file).find(text) == std::string::npos) {
    if (std::chrono::steady_clock::now() > deadline) {
      return false;
    }
    std::this_thread::sleep_for(poll_interval); // between two looks at the condition
  }
  return true;
}

std::string ProgramRun::output() const {
  return read(output_);
}
std::string ProgramRun::errors() const {
  return read(errors_);
}

double ProgramRun::seconds() const {
  return std::chrono::duration<double>(ended_.value_or(std::chrono::steady_clock::now()) - began_)
      .count();
}

EndedRun run_to_end(const std::string& program, const std::vector<std::string>& arguments,
                    const std::filesystem::path& folder) {
  ProgramRun run(program, arguments, folder);
  const auto status = run.wait(patience);
  return {status.value_or(-1), run.output(), run.errors()};
}

std::filesystem::path fresh_folder(const std::string& name) {
  std::filesystem::path folder = std::filesystem::path(DYNCAL_TEST_OUTPUT) / name;
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

} // namespace dyncal::tests
