#include "services/daemon/program/command_line.hpp"

#include <algorithm>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "services/base/nearest_name.hpp"
#include "services/base/printable_text.hpp"
#include "services/daemon/program/completion.hpp"

namespace dyncal::inline daemon {
namespace {

tl::unexpected<Error> refuse(std::string sentence) {
  return fail(ErrorCode::bad_argument, std::move(sentence));
}

std::string path_of(const CLI::App& app) {
  return app.get_parent() == nullptr ? app.get_name()
                                     : path_of(*app.get_parent()) + " " + app.get_name();
}

// The commands that were named, from the program on.
std::vector<const CLI::App*> named_commands(const CLI::App& app) {
  std::vector<const CLI::App*> commands{&app};
  for (auto inner = app.get_subcommands(); !inner.empty();
       inner = commands.back()->get_subcommands()) {
    commands.push_back(inner.back());
  }
  return commands;
}

std::string without_dashes(const std::string& option) {
  const std::size_t from = std::min(option.find_first_not_of('-'), option.size());
  return option.substr(from, option.find('=') - from);
}

std::set<std::string> option_names(const CLI::App& app) {
  std::set<std::string> names;
  for (const CLI::Option* option : shown_options(app)) {
    names.insert(option->get_lnames().begin(), option->get_lnames().end());
  }
  return names;
}

std::set<std::string> command_names(const CLI::App& app) {
  std::set<std::string> names;
  for (const CLI::App* inner : shown_commands(app)) {
    names.insert(inner->get_name());
  }
  return names;
}

// "; did you mean 'run'?", or where all are listed.
std::string hint(const CLI::App& app, const std::string& nearest, const std::string& prefix) {
  return nearest.empty() ? fmt::format("; '{} --help' lists all", path_of(app))
                         : fmt::format("; did you mean '{}{}'?", prefix, nearest);
}

std::string about_unknown(const CLI::App& app, const std::string& word) {
  if (word.starts_with('-')) {
    const std::string name = word.substr(0, word.find('='));
    return fmt::format("unknown option '{}' of '{}'{}", name, path_of(app),
                       hint(app, nearest_name(without_dashes(word), option_names(app)), "--"));
  }
  if (app.get_require_subcommand_min() > 0 && app.get_subcommands().empty()) {
    return fmt::format("unknown command '{} {}'{}", path_of(app), word,
                       hint(app, nearest_name(word, command_names(app)), path_of(app) + " "));
  }
  return fmt::format("'{}' is one argument too many for '{}'", word, path_of(app));
}

// Of what the parser could not place, the word that was written first.
std::optional<std::string> find_unknown(const std::vector<const CLI::App*>& commands,
                                        const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    for (const CLI::App* command : commands) {
      const auto left = command->remaining(false);
      if (std::find(left.begin(), left.end(), word) != left.end()) {
        return about_unknown(*command, word);
      }
    }
  }
  return std::nullopt;
}

const char* number_text(const std::string& type) {
  if (type.starts_with("UINT")) {
    return "a whole number, 0 or more";
  }
  return type.starts_with("INT") ? "a whole number" : "a number";
}

// "Could not convert: --seed = abc"
std::string about_conversion(const CLI::App& command, const std::string& what) {
  constexpr std::string_view beginning = "Could not convert: ";
  if (!what.starts_with(beginning)) {
    return what;
  }
  const std::string given = what.substr(beginning.size());
  const CLI::Option* option = command.get_option_no_throw(given.substr(0, given.find(' ')));
  return fmt::format("invalid {}: must be {}", given,
                     number_text(option == nullptr ? "" : option->get_type_name()));
}

// "--level: Value -1 not in range 0.000000 to 1797693..." and so on for 309 digits, or, by CLI11 of
// Debian 13, "[2.22507e-308 - 1.79769e+308]".
std::string about_range(const CLI::App& command, const std::string& what) {
  constexpr std::string_view value_begins = ": Value ";
  const std::size_t begin = what.find(value_begins);
  const std::size_t end = what.find(" not in range ");
  if (begin == std::string::npos || end == std::string::npos ||
      (what.find("17976931348623157", end) == std::string::npos &&
       what.find("1.79769e+308", end) == std::string::npos)) {
    return what;
  }
  const std::string name = what.substr(0, begin);
  const std::size_t value = begin + value_begins.size();
  const CLI::Option* option = command.get_option_no_throw(name);
  const bool may_be_zero =
      option != nullptr && option->get_type_name().find("NONNEGATIVE") != std::string::npos;
  return fmt::format("invalid {} = {}: must be {}", name, what.substr(value, end - value),
                     may_be_zero ? "0 or more" : "above 0");
}

std::string about_missing(const CLI::App& command, const std::string& what) {
  if (what.starts_with("A subcommand")) {
    return fmt::format("a command is missing; '{} --help' lists all", path_of(command));
  }
  constexpr std::string_view end = " is required";
  return what.ends_with(end)
             ? fmt::format("{} is missing; see '{} --help'",
                           what.substr(0, what.size() - end.size()), path_of(command))
             : what;
}

std::string sentence_about(const CLI::App& app, const CLI::ParseError& error,
                           const std::vector<std::string>& words) {
  const auto commands = named_commands(app);
  const CLI::App& command = *commands.back();
  std::string what = error.what();
  const auto code = static_cast<CLI::ExitCodes>(error.get_exit_code());
  if (code == CLI::ExitCodes::ExtrasError || code == CLI::ExitCodes::RequiredError) {
    if (const auto unknown = find_unknown(commands, words)) {
      return *unknown;
    }
  }
  if (code == CLI::ExitCodes::RequiredError) {
    what = about_missing(command, what);
  } else if (code == CLI::ExitCodes::ConversionError) {
    what = about_conversion(command, what);
  } else if (code == CLI::ExitCodes::ValidationError) {
    what = about_range(command, what);
  } else if (code == CLI::ExitCodes::ArgumentMismatch && what.ends_with(" missing")) {
    what = fmt::format("{} needs a value; see '{} --help'", what.substr(0, what.find(':')),
                       path_of(command));
  }
  std::replace(what.begin(), what.end(), '\n', ' ');
  return what;
}

void print_commands(const CLI::App& app) {
  fmt::print("{}\t{}\n", path_of(app), app.get_description());
  for (const CLI::App* inner : shown_commands(app)) {
    print_commands(*inner);
  }
}

// What --help does not list; nothing when the first argument is none of it.
std::optional<Expected<void>> print_description(const CLI::App& app,
                                                const std::vector<std::string>& words) {
  if (words.empty()) {
    return std::nullopt;
  }
  if (words[0] == "--print-completion") {
    const auto script = completion_script(app, words.size() > 1 ? words[1] : "");
    return script.map([](const std::string& text) { fmt::print("{}", text); });
  }
  if (words[0] == "--complete") {
    fmt::print("{}", completion_offers(app, {words.begin() + 1, words.end()}));
    return Expected<void>{};
  }
  if (words[0] == "--print-commands") {
    print_commands(app);
    return Expected<void>{};
  }
  return std::nullopt;
}

} // namespace

Expected<bool> parse_command_line(CLI::App& app, int argc, const char* const* argv) {
  const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  if (const auto printed = print_description(app, words)) {
    return printed->map([] { return false; });
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {
      app.exit(error);
      return false;
    }
    return refuse(sentence_about(app, error, words));
  }
  return true;
}

std::optional<int> read_command_line(CLI::App& app, int argc, const char* const* argv) {
  const auto parsed = parse_command_line(app, argc, argv);
  if (!parsed) {
    fmt::print(stderr, "{}: {}\n", app.get_name(), one_line(parsed.error().message));
    return wrong_command_line;
  }
  return *parsed ? std::nullopt : std::optional(0);
}

} // namespace dyncal::inline daemon
