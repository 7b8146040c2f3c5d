// What a CLI::App describes, as plain data: for those who write it down for others than its parser
// (completion.hpp, and anyone who lists the commands). Hidden commands and options are left out.
// Any thread.
#pragma once

#include <string>
#include <vector>

namespace CLI { // NOLINT(readability-identifier-naming): of the library
class App;
}

namespace dyncal::inline daemon {

struct DescribedOption {
  std::vector<std::string> names; // "-h", "--help"; of an argument by its place, "BENCH.toml"
  std::string value;              // what follows it: "FILE", "NUMBER"; empty: nothing
  std::vector<std::string> choices;
  std::string description;
};

struct DescribedCommand {
  std::string path; // "dyncal calibrate adc"
  std::string description;
  std::vector<DescribedOption> options;
  std::vector<DescribedOption> arguments; // by their place
  std::vector<DescribedCommand> commands;

  [[nodiscard]] std::string name() const; // "adc"
};

[[nodiscard]] DescribedCommand describe_commands(const CLI::App& app);

} // namespace dyncal::inline daemon
