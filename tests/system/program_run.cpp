#include "tests/system/program_run.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <sstream>
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

} // namespace

ProgramRun::ProgramRun(const std::string& program, const std::vector<std::string>& arguments,
                       const std::filesystem::path& folder)
    : output_(folder / (program + ".out")), errors_(folder / (program + ".err")),
      began_(std::chrono::steady_clock::now()) {
  const std::string path = std::string(DYNCAL_PROGRAMS) + "/" + program;
  std::vector<char*> words{const_cast<char*>(path.c_str())};
  for (const std::string& argument : arguments) {
    words.push_back(const_cast<char*>(argument.c_str()));
  }
  words.push_back(nullptr);
  const int out = open(output_.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0644);
  const int err = open(errors_.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0644);
  process_ = fork();
  if (process_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    dup2(out, STDOUT_FILENO);
    dup2(err, STDERR_FILENO);
    execv(path.c_str(), words.data());
    _exit(127);
  }
  close(out);
  close(err);
}

ProgramRun::~ProgramRun() {
  if (!status_) {
    kill(process_, SIGTERM); // a demo ends its services
    if (!wait(std::chrono::seconds(5))) {
      kill(process_, SIGKILL);
      waitpid(process_, nullptr, 0);
    }
  }
}

void ProgramRun::send(int signal) {
  kill(process_, signal);
}

bool ProgramRun::send_to_child(const std::string& program, int signal) {
  std::istringstream children(read("/proc/" + std::to_string(process_) + "/task/" +
                                   std::to_string(process_) + "/children"));
  for (pid_t child = 0; children >> child;) {
    const std::string command = read("/proc/" + std::to_string(child) + "/cmdline");
    if (std::filesystem::path(command.substr(0, command.find('\0'))).filename() == program) {
      return kill(child, signal) == 0;
    }
  }
  return false;
}

std::optional<int> ProgramRun::wait(std::chrono::seconds limit) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (!status_) {
    int raw = 0;
    if (waitpid(process_, &raw, WNOHANG) == process_) {
      status_ = WIFEXITED(raw) ? WEXITSTATUS(raw) : 128 + WTERMSIG(raw);
      ended_ = std::chrono::steady_clock::now();
    } else if (std::chrono::steady_clock::now() > deadline) {
      return std::nullopt;
    } else {
      std::this_thread::sleep_for(poll_interval); // between two looks at the condition
    }
  }
  return status_;
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
