#include "services/daemon/program/completion.hpp"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/daemon/program/command_tree.hpp"

namespace dyncal::inline daemon {
namespace {

using Commands = std::vector<DescribedCommand>;

// The program and all its commands, each before those inside it.
void flatten(const DescribedCommand& command, Commands& all) {
  all.push_back(command);
  for (const DescribedCommand& inner : command.commands) {
    flatten(inner, all);
  }
}

// "_dyncal_dau"
std::string function_name(const DescribedCommand& program) {
  std::string name = "_" + program.path;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

// 'text', with its quotes escaped as all three shells read them.
std::string quoted(const std::string& text) {
  std::string escaped;
  for (const char letter : text) {
    escaped += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
  }
  return "'" + escaped + "'";
}

std::vector<std::string> option_names(const DescribedCommand& command) {
  std::vector<std::string> names;
  for (const DescribedOption& option : command.options) {
    names.insert(names.end(), option.names.begin(), option.names.end());
  }
  return names;
}

std::vector<std::string> command_names(const DescribedCommand& command) {
  std::vector<std::string> names;
  for (const DescribedCommand& inner : command.commands) {
    names.push_back(inner.name());
  }
  return names;
}

// "dyncal run --json", for every name of an option.
std::vector<std::string> places(const DescribedCommand& command, const DescribedOption& option) {
  std::vector<std::string> places;
  for (const std::string& name : option.names) {
    places.push_back(quoted(fmt::format("{} {}", command.path, name)));
  }
  return places;
}

bool takes_bench_files(const DescribedCommand& command) {
  return std::ranges::any_of(command.arguments, [](const DescribedOption& argument) {
    return argument.names.front().find("BENCH") != std::string::npos;
  });
}

// The paths of all commands but the program's, as patterns of a case.
std::string paths(const Commands& all) {
  std::vector<std::string> paths;
  for (std::size_t i = 1; i < all.size(); ++i) {
    paths.push_back(quoted(all[i].path));
  }
  return paths.empty() ? "''" : fmt::format("{}", fmt::join(paths, "|"));
}

void add_bash_values(const Commands& all, std::string& script) {
  script += "  case \"$command $before\" in\n";
  std::vector<std::string> free;
  for (const DescribedCommand& command : all) {
    for (const DescribedOption& option : command.options) {
      const auto where = places(command, option);
      if (!option.choices.empty()) {
        script += fmt::format("    {})\n      COMPREPLY=($(compgen -W {} -- \"$word\"))\n"
                              "      return ;;\n",
                              fmt::join(where, "|"),
                              quoted(fmt::format("{}", fmt::join(option.choices, " "))));
      } else if (!option.value.empty()) {
        free.insert(free.end(), where.begin(), where.end());
      }
    }
  }
  if (!free.empty()) {
    script += fmt::format("    {})\n      compopt -o filenames 2>/dev/null\n"
                          "      mapfile -t COMPREPLY < <(compgen -f -- \"$word\")\n"
                          "      return ;;\n",
                          fmt::join(free, "|"));
  }
  script += "  esac\n";
}

void add_bash_words(const Commands& all, std::string& script) {
  script += "  case \"$command\" in\n";
  for (const DescribedCommand& command : all) {
    script += fmt::format("    {})\n      options={}\n", quoted(command.path),
                          quoted(fmt::format("{}", fmt::join(option_names(command), " "))));
    if (!command.commands.empty()) {
      script += fmt::format("      commands={}\n",
                            quoted(fmt::format("{}", fmt::join(command_names(command), " "))));
    }
    if (takes_bench_files(command)) {
      script += "      files='!*.toml'\n";
    }
    script += "      ;;\n";
  }
  script += "  esac\n";
}

std::string bash_script(const Commands& all) {
  const std::string name = function_name(all.front());
  const std::string& program = all.front().path;
  std::string script = fmt::format(
      R"(# Completion of {0} for bash, made by '{0} --print-completion bash'.
{1}() {{
  local word="${{COMP_WORDS[COMP_CWORD]}}" before="${{COMP_WORDS[COMP_CWORD-1]}}"
  local command='{0}' options='' commands='' files='' i
  if [[ $word == '=' ]]; then
    word=''
  elif [[ $before == '=' ]]; then
    before="${{COMP_WORDS[COMP_CWORD-2]}}"
  fi
  for ((i = 1; i < COMP_CWORD; i++)); do
    case "$command ${{COMP_WORDS[i]}}" in
      {2}) command="$command ${{COMP_WORDS[i]}}" ;;
    esac
  done
  COMPREPLY=()
)",
      program, name, paths(all));
  add_bash_values(all, script);
  add_bash_words(all, script);
  script += fmt::format(R"(  if [[ $word == -* ]]; then
    COMPREPLY=($(compgen -W "$options" -- "$word"))
  elif [[ -n $commands ]]; then
    COMPREPLY=($(compgen -W "$commands" -- "$word"))
  else
    compopt -o filenames 2>/dev/null
    mapfile -t COMPREPLY < <(
      compgen -f -X "$files" -- "$word"
      [[ -n $files ]] && compgen -d -- "$word"
    )
  fi
}}
complete -F {} {}
)",
                        name, program);
  return script;
}

// 'name:what it is', as _describe reads it.
std::string zsh_entry(const std::string& name, const std::string& description) {
  std::string escaped;
  for (const char letter : name) {
    escaped += letter == ':' ? std::string("\\:") : std::string(1, letter);
  }
  return quoted(escaped + ":" + description);
}

void add_zsh_values(const Commands& all, std::string& script) {
  std::vector<std::string> free;
  for (const DescribedCommand& command : all) {
    for (const DescribedOption& option : command.options) {
      const auto where = places(command, option);
      if (!option.choices.empty()) {
        script += fmt::format("    ({}) compadd -- {}; return ;;\n", fmt::join(where, "|"),
                              fmt::join(option.choices, " "));
      } else if (!option.value.empty()) {
        free.insert(free.end(), where.begin(), where.end());
      }
    }
  }
  if (!free.empty()) {
    script += fmt::format("    ({}) _files; return ;;\n", fmt::join(free, "|"));
  }
  script += "  esac\n";
}

void add_zsh_words(const Commands& all, std::string& script) {
  script += "  case \"$command\" in\n";
  for (const DescribedCommand& command : all) {
    script += fmt::format("    ({})\n      options=(", quoted(command.path));
    for (const DescribedOption& option : command.options) {
      for (const std::string& option_name : option.names) {
        script += zsh_entry(option_name, option.description) + " ";
      }
    }
    script += ")\n      commands=(";
    for (const DescribedCommand& inner : command.commands) {
      script += zsh_entry(inner.name(), inner.description) + " ";
    }
    script += takes_bench_files(command) ? ")\n      files='*.toml'\n      ;;\n" : ")\n      ;;\n";
  }
}

std::string zsh_script(const Commands& all) {
  const std::string name = function_name(all.front());
  std::string script = fmt::format(R"(#compdef {0}
# Completion of {0} for zsh, made by '{0} --print-completion zsh'.
{1}() {{
  local command='{0}' files='*' i
  local -a options commands
  for ((i = 2; i < CURRENT; i++)); do
    case "$command ${{words[i]}}" in
      ({2}) command="$command ${{words[i]}}" ;;
    esac
  done
  case "$command ${{words[CURRENT-1]}}" in
)",
                                   all.front().path, name, paths(all));
  add_zsh_values(all, script);
  add_zsh_words(all, script);
  script += fmt::format(R"(  esac
  if [[ ${{words[CURRENT]}} == -* ]]; then
    _describe -o option options
  elif (( ${{#commands}} )); then
    _describe command commands
  else
    _files -g "$files"
  fi
}}
if [[ $zsh_eval_context[-1] == loadautofunc ]]; then
  {0} "$@"
else
  compdef {0} {1}
fi
)",
                        name, all.front().path);
  return script;
}

void add_fish_option(const std::string& program, const std::string& condition,
                     const DescribedOption& option, std::string& script) {
  script += fmt::format("complete -c {} -n {}", program, quoted(condition));
  for (const std::string& name : option.names) {
    script += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  }
  if (!option.choices.empty()) {
    script += fmt::format(" -x -a {}", quoted(fmt::format("{}", fmt::join(option.choices, " "))));
  } else if (!option.value.empty()) {
    script += " -r";
  }
  script += " -d " + quoted(option.description) + "\n";
}

std::string fish_script(const Commands& all) {
  const std::string& program = all.front().path;
  const std::string at = "_" + function_name(all.front()) + "_at";
  std::string script =
      fmt::format(R"(# Completion of {0} for fish, made by '{0} --print-completion fish'.
function {1}
    set -l command {0}
    for word in (commandline -opc)[2..-1]
        switch "$command $word"
            case {2}
                set command "$command $word"
        end
    end
    test "$command" = "$argv"
end
)",
                  program, at, [&] {
                    std::string words = paths(all);
                    std::replace(words.begin(), words.end(), '|', ' ');
                    return words;
                  }());
  for (const DescribedCommand& command : all) {
    const std::string condition = at + " " + command.path;
    for (const DescribedCommand& inner : command.commands) {
      script += fmt::format("complete -c {} -n {} -f -a {} -d {}\n", program, quoted(condition),
                            inner.name(), quoted(inner.description));
    }
    for (const DescribedOption& option : command.options) {
      add_fish_option(program, condition, option, script);
    }
    if (takes_bench_files(command)) {
      script += fmt::format("complete -c {} -n {} -k -a '(__fish_complete_suffix .toml)'\n",
                            program, quoted(condition));
    }
  }
  return script;
}

} // namespace

Expected<std::string> completion_script(const CLI::App& app, const std::string& shell) {
  Commands all;
  flatten(describe_commands(app), all);
  if (shell == "bash") {
    return bash_script(all);
  }
  if (shell == "zsh") {
    return zsh_script(all);
  }
  if (shell == "fish") {
    return fish_script(all);
  }
  return fail(ErrorCode::bad_argument,
              fmt::format("there is no completion for the shell '{}'; there is for bash, zsh and "
                          "fish",
                          shell));
}

} // namespace dyncal::inline daemon
