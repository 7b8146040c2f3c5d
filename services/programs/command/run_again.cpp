#include "services/programs/command/run_again.hpp"

#include <unistd.h>

#include <fstream>

#include <fmt/core.h>

namespace dyncal::inline programs {
namespace {

std::vector<std::string> own_arguments() {
  std::ifstream file("/proc/self/cmdline");
  std::vector<std::string> arguments;
  for (std::string one; std::getline(file, one, '\0');) {
    arguments.push_back(one);
  }
  return arguments;
}

// "--run NAME", "--run=NAME".
bool names(const std::string& argument, const std::string& option) {
  return argument == option || argument.starts_with(option + "=");
}

} // namespace

std::vector<std::string> arguments_again(const std::vector<std::string>& own,
                                         const std::string& resume) {
  if (resume.empty()) {
    return own;
  }
  std::vector<std::string> again;
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (names(own[i], "--run") || names(own[i], "--resume")) {
      i += own[i].find('=') == std::string::npos ? 1 : 0;
    } else if (own[i] != "--wait") {
      again.push_back(own[i]);
    }
  }
  again.push_back("--resume=" + resume);
  return again;
}

void run_again(const std::string& why, const std::string& resume) {
  fmt::print(stderr,
             "\ndyncal: {}: nobody hears this run at the addresses that it has announced, so it "
             "{}\n",
             why,
             resume.empty() ? "begins again"
                            : fmt::format("continues as 'dyncal run --resume {}'", resume));
  std::vector<std::string> words = arguments_again(own_arguments(), resume);
  std::vector<char*> pointers;
  for (std::string& word : words) {
    pointers.push_back(word.data());
  }
  pointers.push_back(nullptr);
  execv("/proc/self/exe", pointers.data());
}

} // namespace dyncal::inline programs
