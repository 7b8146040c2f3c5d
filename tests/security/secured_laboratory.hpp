// An authority and the folders of its programs, made by `dyncal security`: of the roles source,
// analysis and operator of one bench, and more as they are wanted. For system tests; one thread.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/patience.hpp"
#include "tests/system/program_run.hpp"

namespace dyncal::tests {

class SecuredLaboratory {
public:
  // `vendor`: the only DDS implementation that its folders are for; empty: any.
  SecuredLaboratory(std::filesystem::path folder, const std::string& bench, std::string vendor = "")
      : folder_(std::move(folder)), vendor_(std::move(vendor)) {
    std::filesystem::create_directories(folder_);
    call({"init", authority()});
    issue("source", {"--bench", bench});
    issue("analysis", {});
    issue("operator", {"--bench", bench});
  }
  void issue(const std::string& role, std::vector<std::string> options,
             const std::string& name = "") const {
    options.insert(options.begin(),
                   {"issue", authority(), role, "--output", folder_of(name.empty() ? role : name)});
    if (!vendor_.empty()) {
      options.insert(options.end(), {"--vendor", vendor_});
    }
    call(options);
  }
  void call(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "security");
    ProgramRun run("dyncal", arguments, folder_);
    EXPECT_EQ(run.wait(patience), 0) << run.errors();
  }
  [[nodiscard]] std::string authority() const { return folder_ / "authority"; }
  [[nodiscard]] std::string folder_of(const std::string& name) const { return folder_ / name; }

private:
  std::filesystem::path folder_;
  std::string vendor_;
};

// `folder`: of --security; empty: plain.
inline std::vector<std::string> with_security(std::vector<std::string> arguments,
                                              const std::string& folder) {
  if (!folder.empty()) {
    arguments.insert(arguments.end(), {"--security", folder});
  }
  return arguments;
}

} // namespace dyncal::tests
