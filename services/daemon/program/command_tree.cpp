#include "services/daemon/program/command_tree.hpp"

#include <algorithm>

#include <CLI/CLI.hpp>

namespace dyncal::inline daemon {
namespace {

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::size_t from = 0;
  while (from <= text.size()) {
    const std::size_t to = std::min(text.find(separator, from), text.size());
    if (to > from) {
      parts.push_back(text.substr(from, to - from));
    }
    from = to + 1;
  }
  return parts;
}

std::string value_word(const std::string& type) {
  if (type == "TEXT") {
    return "TEXT";
  }
  return type == "INT" || type == "UINT" || type == "FLOAT" ? "NUMBER" : type;
}

// "TEXT:{fir,iir}", "ENUM:value in {expanded->1,standard->0} OR {1,0}", "INT:INT in [0 - 232]":
// what validators say follows the type.
void read_type(const CLI::Option& option, DescribedOption& described) {
  if (option.get_items_expected_max() == 0) {
    return; // a flag
  }
  const std::string type = option.get_type_name();
  const std::size_t colon = type.find(':');
  described.value = value_word(type.substr(0, colon));
  if (colon == std::string::npos) {
    return;
  }
  const std::string check = type.substr(colon + 1);
  const std::size_t opened = check.find('{');
  const std::size_t closed = check.find('}');
  if (opened != std::string::npos && closed != std::string::npos && opened < closed) {
    described.choices = split(check.substr(opened + 1, closed - opened - 1), ',');
    for (std::string& choice : described.choices) {
      choice = choice.substr(0, choice.find("->")); // the rest is the program's own value
    }
  }
}

DescribedOption describe(const CLI::Option& option) {
  DescribedOption described;
  if (option.get_positional()) {
    described.names = {option.get_name(true)};
  }
  for (const std::string& name : option.get_snames()) {
    described.names.push_back("-" + name);
  }
  for (const std::string& name : option.get_lnames()) {
    described.names.push_back("--" + name);
  }
  read_type(option, described);
  described.description = option.get_description();
  return described;
}

DescribedCommand describe(const CLI::App& app, const std::string& before) {
  DescribedCommand command;
  command.path = before.empty() ? app.get_name() : before + " " + app.get_name();
  command.description = app.get_description();
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_group().empty()) {
      (option->get_positional() ? command.arguments : command.options).push_back(describe(*option));
    }
  }
  for (const CLI::App* inner : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (!inner->get_group().empty()) {
      command.commands.push_back(describe(*inner, command.path));
    }
  }
  return command;
}

} // namespace

std::string DescribedCommand::name() const {
  return path.substr(path.find_last_of(' ') + 1);
}

DescribedCommand describe_commands(const CLI::App& app) {
  return describe(app, "");
}

} // namespace dyncal::inline daemon
