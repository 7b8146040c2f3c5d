#include "services/daemon/program/completion.hpp"

#include <algorithm>
#include <map>
#include <sstream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "services/base/printable_text.hpp"

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

std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) {
    names.push_back("-" + name);
  }
  for (const std::string& name : option.get_lnames()) {
    names.push_back("--" + name);
  }
  return names;
}

// What validators say follows the type: "TEXT:{fir,iir}", or "ENUM:value in {expanded->1,
// standard->0} OR {1,0}", where the program's own values stand behind the arrows.
std::vector<std::string> choices_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t opened = type.find('{', type.find(':'));
  const std::size_t closed = type.find('}', opened);
  std::vector<std::string> choices;
  if (closed != std::string::npos) {
    std::istringstream listed(type.substr(opened + 1, closed - opened - 1));
    for (std::string choice; std::getline(listed, choice, ',');) {
      choices.push_back(choice.substr(0, choice.find("->")));
    }
  }
  return choices;
}

// What may follow this option, behind `before` in one word.
std::string values_of(const CLI::Option& option, const std::string& before) {
  std::string values;
  for (const std::string& choice : choices_of(option)) {
    values += offer(before + choice, option.get_description());
  }
  return values.empty() ? files("*") : values;
}

bool takes_bench_files(const CLI::App& command) {
  return std::ranges::any_of(shown_options(command), [](const CLI::Option* option) {
    return option->get_positional() && option->get_name(true).find("BENCH") != std::string::npos;
  });
}

} // namespace

std::vector<const CLI::App*> shown_commands(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
}

std::vector<const CLI::Option*> shown_options(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) { return !option->get_group().empty(); });
}

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
  const CLI::App* command = &app;
  for (const std::string& word : words) {
    const auto inner = shown_commands(*command);
    const auto named = std::ranges::find(inner, word, &CLI::App::get_name);
    command = named == inner.end() ? command : *named;
  }
  std::string offers;
  for (const CLI::Option* option : shown_options(*command)) {
    const std::vector<std::string> names = names_of(*option);
    const bool takes_value = option->get_items_expected_max() > 0;
    if (takes_value && !words.empty() && std::ranges::find(names, words.back()) != names.end()) {
      return values_of(*option, before);
    }
    for (const std::string& name : names) {
      offers += typed.starts_with('-') ? offer(name, option->get_description()) : "";
    }
  }
  for (const CLI::App* inner : shown_commands(*command)) {
    offers += typed.starts_with('-') ? "" : offer(inner->get_name(), inner->get_description());
  }
  return offers.empty() ? files(takes_bench_files(*command) ? "*.toml" : "*") : offers;
}

} // namespace dyncal::inline daemon
