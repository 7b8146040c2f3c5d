#include "services/daemon/program/completion.hpp"

#include <algorithm>
#include <map>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "services/base/printable_text.hpp"
#include "services/daemon/program/command_tree.hpp"

namespace dyncal::inline daemon {
namespace {

// {0}: the program; {1}: its name in functions.
constexpr const char* bash_script =
    R"(# Completion of {0} for bash, from '{0} --print-completion bash'.
_{1}() {{
  local word="${{COMP_WORDS[COMP_CWORD]#=}}" offer about
  COMPREPLY=()
  while IFS=$'\t' read -r offer about; do
    if [[ $offer == /* ]]; then
      compopt -o filenames 2>/dev/null
      mapfile -t COMPREPLY < <(compgen -f -X "!${{offer#/}}" -- "$word"; compgen -d -- "$word")
    elif [[ $offer == "$word"* ]]; then
      COMPREPLY+=("$offer")
    fi
  done < <("${{COMP_WORDS[0]/#\~/$HOME}}" --complete "${{COMP_WORDS[@]:1:COMP_CWORD}}")
}}
complete -F _{1} {0}
)";

constexpr const char* zsh_script = R"(#compdef {0}
# Completion of {0} for zsh, from '{0} --print-completion zsh'.
_{1}() {{
  local line
  local -a offers
  for line in "${{(@f)$(${{~words[1]}} --complete "${{(@)words[2,CURRENT]}}")}}"; do
    if [[ $line == /* ]]; then
      _files -g "${{${{line%%$'\t'*}}#/}}"
    else
      offers+=("${{${{line%%$'\t'*}}//:/\\:}}:${{line#*$'\t'}}")
    fi
  done
  (( $#offers == 0 )) || _describe '{0}' offers
}}
if [[ $zsh_eval_context[-1] == loadautofunc ]]; then
  _{1} "$@"
else
  compdef _{1} {0}
fi
)";

constexpr const char* fish_script =
    R"(# Completion of {0} for fish, from '{0} --print-completion fish'.
function _{1}_offers
    set -l words (commandline -opc) (commandline -ct)
    for offer in ($words[1] --complete $words[2..-1])
        switch $offer
            case '/*.toml*'
                __fish_complete_suffix .toml
            case '/*'
                __fish_complete_path $words[-1]
            case '*'
                echo $offer
        end
    end
end
complete -c {0} -f -k -a '(_{1}_offers)'
)";

std::string files(const std::string& pattern) {
  return "/" + pattern + "\tfiles\n";
}

std::string offer(const std::string& word, const std::string& description) {
  return fmt::format("{}\t{}\n", word, one_line(description));
}

// What may follow this option, behind `before` in one word.
std::string values_of(const DescribedOption& option, const std::string& before) {
  std::string values;
  for (const std::string& choice : option.choices) {
    values += offer(before + choice, option.description);
  }
  return option.choices.empty() ? files("*") : values;
}

bool takes_bench_files(const DescribedCommand& command) {
  return std::ranges::any_of(command.arguments, [](const DescribedOption& argument) {
    return argument.names.front().find("BENCH") != std::string::npos;
  });
}

} // namespace

Expected<std::string> completion_script(const CLI::App& app, const std::string& shell) {
  const std::map<std::string, const char*> scripts{
      {"bash", bash_script}, {"zsh", zsh_script}, {"fish", fish_script}};
  const auto script = scripts.find(shell);
  if (script == scripts.end()) {
    return fail(ErrorCode::bad_argument,
                fmt::format("there is no completion for the shell '{}'; there is for bash, zsh and "
                            "fish",
                            shell));
  }
  std::string name = app.get_name();
  std::ranges::replace(name, '-', '_');
  return fmt::format(fmt::runtime(script->second), app.get_name(), name);
}

std::string completion_offers(const CLI::App& app, std::vector<std::string> words) {
  const std::string typed = words.empty() ? "" : words.back();
  words.resize(words.size() - std::min<std::size_t>(words.size(), 1));
  std::erase(words, "="); // of --option=value, which bash alone takes to pieces
  std::string before;
  if (const auto sign = typed.find('='); typed.starts_with("--") && sign != std::string::npos) {
    before = typed.substr(0, sign + 1);
    words.push_back(typed.substr(0, sign));
  }
  const DescribedCommand program = describe_commands(app);
  const DescribedCommand* command = &program;
  for (const std::string& word : words) {
    const auto inner = std::ranges::find(command->commands, word, &DescribedCommand::name);
    command = inner == command->commands.end() ? command : &*inner;
  }
  std::string offers;
  for (const DescribedOption& option : command->options) {
    if (!option.value.empty() && !words.empty() &&
        std::ranges::find(option.names, words.back()) != option.names.end()) {
      return values_of(option, before);
    }
    for (const std::string& name : option.names) {
      offers += typed.starts_with('-') ? offer(name, option.description) : "";
    }
  }
  for (const DescribedCommand& inner : command->commands) {
    offers += typed.starts_with('-') ? "" : offer(inner.name(), inner.description);
  }
  return offers.empty() ? files(takes_bench_files(*command) ? "*.toml" : "*") : offers;
}

} // namespace dyncal::inline daemon
