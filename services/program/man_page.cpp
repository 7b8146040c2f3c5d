#include "services/program/man_page.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/program/command_tree.hpp"
#include "services/version.hpp"

namespace dyncal::services {
namespace {

// Of a program whose description has no other.
constexpr const char* exit_statuses[][2] = {
    {"0", "Success."},
    {"1", "Failure; one line on standard error says what failed and what to do."},
    {"2", "Wrong command line; one line on standard error."},
    {"130", "Interrupted by Ctrl-C (SIGINT) or SIGTERM before the end."}};

// Text as troff reads it.
std::string plain(const std::string& text) {
  std::string escaped;
  for (const char letter : text) {
    if (letter == '\\') {
      escaped += "\\e";
    } else if (letter == '-') {
      escaped += "\\-";
    } else if (letter == '\'') {
      escaped += "\\(aq";
    } else if (letter == '\n') {
      escaped += ' ';
    } else {
      escaped += letter;
    }
  }
  return escaped.starts_with('.') ? "\\&" + escaped : escaped;
}

std::string bold(const std::string& text) {
  return "\\fB" + plain(text) + "\\fR";
}

std::string italic(const std::string& text) {
  return "\\fI" + plain(text) + "\\fR";
}

std::string sentence(std::string text) {
  if (!text.empty()) {
    text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
    if (std::string(".?!)").find(text.back()) == std::string::npos) {
      text += '.';
    }
  }
  return text;
}

std::string value_text(const DescribedOption& option) {
  return option.choices.empty() ? italic(option.value)
                                : plain(fmt::format("{}", fmt::join(option.choices, "|")));
}

void add_option(const DescribedOption& option, bool by_place, std::string& page) {
  page += ".TP\n";
  for (std::size_t i = 0; i < option.names.size(); ++i) {
    page += i == 0 ? "" : ", ";
    page += by_place ? italic(option.names[i]) : bold(option.names[i]);
  }
  if (!by_place && !option.value.empty()) {
    page += " " + value_text(option);
  }
  std::string text = sentence(option.description);
  if (!option.range.empty()) {
    text += fmt::format(" ({})", option.range);
  }
  if (by_place && !option.choices.empty()) {
    text += fmt::format(" One of {}.", fmt::join(option.choices, ", "));
  }
  if (!option.otherwise.empty()) {
    text += fmt::format(" Default: {}.", option.otherwise);
  }
  if (option.required && !by_place) {
    text += " Required.";
  }
  page += "\n" + plain(text) + "\n";
}

void add_options(const char* heading, const std::vector<DescribedOption>& options, bool by_place,
                 std::string& page) {
  if (options.empty()) {
    return;
  }
  page += fmt::format(".SH {}\n", heading);
  for (const DescribedOption& option : options) {
    add_option(option, by_place, page);
  }
}

void add_synopsis(const DescribedCommand& command, std::string& page) {
  page += ".SH SYNOPSIS\n" + bold(command.path);
  if (!command.options.empty()) {
    page += " [" + italic("OPTION") + "]...";
  }
  for (const DescribedOption& argument : command.arguments) {
    const std::string text = italic(argument.names.front()) + (argument.repeatable ? "..." : "");
    page += argument.required ? " " + text : fmt::format(" [{}]", text);
  }
  page += command.commands.empty() ? "\n" : " " + italic("COMMAND") + " ...\n";
}

void add_commands(const DescribedCommand& command, std::string& page) {
  if (command.commands.empty()) {
    return;
  }
  page += ".SH COMMANDS\n";
  for (const DescribedCommand& inner : command.commands) {
    page += fmt::format(".TP\n{}\n{} See {}(1).\n", bold(inner.name()),
                        plain(sentence(inner.description)), bold(inner.page()));
  }
}

void add_environment(const DescribedCommand& command, std::string& page) {
  std::string entries;
  for (const DescribedOption& option : command.options) {
    if (!option.environment.empty()) {
      entries += fmt::format(".TP\n{}\nGives {} where the option is not given.\n",
                             bold(option.environment), bold(option.names.back()));
    }
  }
  page += entries.empty() ? "" : ".SH ENVIRONMENT\n" + entries;
}

void add_exit_status(const DescribedCommand& command, std::string& page) {
  page += ".SH EXIT STATUS\n";
  if (!command.footer.empty()) {
    constexpr std::string_view label = "Exit status: ";
    const std::string& footer = command.footer;
    page +=
        plain(sentence(footer.starts_with(label) ? footer.substr(label.size()) : footer)) + "\n";
    return;
  }
  for (const auto& [status, meaning] : exit_statuses) {
    page += fmt::format(".TP\n{}\n{}\n", bold(status), plain(meaning));
  }
}

void add_see_also(const DescribedCommand& command, const DescribedCommand& program,
                  std::string& page) {
  std::vector<std::string> pages;
  if (command.path != program.path) {
    pages.push_back(program.page());
  }
  for (const DescribedCommand& inner : program.commands) {
    if (inner.path != command.path) {
      pages.push_back(inner.page());
    }
  }
  if (program.page() != "dyncal") {
    pages.emplace_back("dyncal");
  }
  page += ".SH SEE ALSO\n";
  for (std::size_t i = 0; i < pages.size(); ++i) {
    page += fmt::format("{}(1){}\n", bold(pages[i]), i + 1 < pages.size() ? "," : "");
  }
}

std::string page_of(const DescribedCommand& command, const DescribedCommand& program) {
  std::string upper = command.page();
  std::transform(upper.begin(), upper.end(), upper.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::toupper(letter)); });
  const std::string software = software_version();
  std::string page = fmt::format(".TH \"{}\" 1 \"\" \"{}\" \"dyncal\"\n", plain(upper),
                                 plain(software.substr(0, software.find(" ("))));
  std::string summary = command.description;
  if (summary.ends_with('.')) {
    summary.pop_back();
  }
  page += fmt::format(".SH NAME\n{} \\- {}\n", plain(command.page()), plain(summary));
  add_synopsis(command, page);
  page += fmt::format(".SH DESCRIPTION\n{}\n", plain(sentence(command.description)));
  add_commands(command, page);
  add_options("ARGUMENTS", command.arguments, true, page);
  add_options("OPTIONS", command.options, false, page);
  add_environment(command, page);
  add_exit_status(command, page);
  add_see_also(command, program, page);
  return page;
}

Expected<void> write_pages(const DescribedCommand& command, const DescribedCommand& program,
                           const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / (command.page() + ".1");
  std::ofstream file(path);
  file << page_of(command, program);
  file.close();
  if (!file) {
    return fail(ErrorCode::bad_file, fmt::format("{}: cannot write this page", path.string()));
  }
  for (const DescribedCommand& inner : command.commands) {
    if (auto written = write_pages(inner, program, folder); !written) {
      return written;
    }
  }
  return {};
}

} // namespace

Expected<std::string> man_page(const CLI::App& app, const std::vector<std::string>& command) {
  const DescribedCommand program = describe_commands(app);
  const DescribedCommand* found = &program;
  for (const std::string& word : command) {
    const auto inner = std::ranges::find(found->commands, word, &DescribedCommand::name);
    if (inner == found->commands.end()) {
      return fail(ErrorCode::bad_argument,
                  fmt::format("there is no command '{} {}'", found->path, word));
    }
    found = &*inner;
  }
  return page_of(*found, program);
}

Expected<void> write_man_pages(const CLI::App& app, const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: cannot make this folder: {}", folder.string(), error.message()));
  }
  const DescribedCommand program = describe_commands(app);
  return write_pages(program, program, folder);
}

} // namespace dyncal::services
