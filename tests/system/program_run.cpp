#include "tests/system/program_run.hpp"

#include <csignal>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace dyncal::tests {
namespace {

constexpr std::chrono::milliseconds poll_interval{10};

std::string read(const std::filesystem::path& path) {
  std::ifstream stream(path);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

services::ChildProcess started(const std::filesystem::path& program,
                               const std::vector<std::string>& arguments,
                               services::ChildOutput output) {
  auto process = services::ChildProcess::start(program, arguments, std::move(output));
  if (!process) {
    throw std::runtime_error(process.error().message);
  }
  return std::move(*process);
}

} // namespace

ProgramRun::ProgramRun(const std::string& program, const std::vector<std::string>& arguments,
                       const std::filesystem::path& folder)
    : output_(folder / (std::filesystem::path(program).filename().string() + ".out")),
      errors_(folder / (std::filesystem::path(program).filename().string() + ".err")),
      began_(std::chrono::steady_clock::now()),
      process_(started(std::filesystem::path(DYNCAL_PROGRAMS) / program, arguments,
                       {output_, errors_})) {}

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

std::optional<int> ProgramRun::wait(std::chrono::nanoseconds limit) {
  const auto exit = process_.wait_for(limit);
  if (!exit) {
    return std::nullopt;
  }
  ended_ = ended_.value_or(std::chrono::steady_clock::now());
  return exit->status;
}

double ProgramRun::cpu_s() {
  const auto exit = process_.wait_for(std::chrono::nanoseconds(0));
  return exit ? exit->cpu_s : 0.0;
}

bool ProgramRun::wait_for_error_text(const std::string& text, std::chrono::seconds limit) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (errors().find(text) == std::string::npos) {
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

std::filesystem::path fresh_folder(const std::string& name) {
  const std::filesystem::path folder = std::filesystem::path(DYNCAL_TEST_OUTPUT) / name;
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

} // namespace dyncal::tests
