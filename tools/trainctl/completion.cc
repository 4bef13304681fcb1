#include "tools/trainctl/completion.h"

#include <iostream>
#include <memory>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "tools/trainctl/command.h"

namespace tactus::internal::client {
namespace {

// The words that may follow `command`.
std::vector<std::string> WordsOf(const CLI::App& command) {
  std::vector<std::string> words;
  for (const CLI::App* child : command.get_subcommands({})) {
    words.push_back(child->get_name());
  }
  for (const CLI::Option* option : command.get_options({})) {
    for (const std::string& name : option->get_lnames()) {
      words.push_back(absl::StrCat("--", name));
    }
  }
  return words;
}

// One line for each command: its path and the words that may follow.
void AddCases(const CLI::App& command, const std::string& path,
              std::string* cases) {
  absl::StrAppend(cases, "    '", path, "') choices='",
                  absl::StrJoin(WordsOf(command), " "), "' ;;\n");
  for (const CLI::App* child : command.get_subcommands({})) {
    AddCases(*child,
             absl::StrCat(path, path.empty() ? "" : " ", child->get_name()),
             cases);
  }
}

// _trainctl_words sets `choices` for the path of a command, and fails for any
// other text. A path grows by each word that makes it a longer path.
constexpr char kBash[] = R"(_trainctl() {
  local choices='' found='' longer word
  for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
    longer="${found:+$found }$word"
    if _trainctl_words "$longer"; then found="$longer"; fi
  done
  _trainctl_words "$found"
  COMPREPLY=($(compgen -W "$choices" -- "${COMP_WORDS[COMP_CWORD]}"))
}
complete -o default -F _trainctl trainctl
)";

constexpr char kZsh[] = R"(_trainctl() {
  local choices='' found='' longer word
  for word in "${(@)words[2,CURRENT-1]}"; do
    longer="${found:+$found }$word"
    if _trainctl_words "$longer"; then found="$longer"; fi
  done
  _trainctl_words "$found"
  compadd -- ${=choices} || _files
}
compdef _trainctl trainctl
)";

}  // namespace

std::string CompletionScript(const CLI::App& app, Shell shell) {
  std::string cases;
  AddCases(app, "", &cases);
  const std::string words =
      absl::StrCat("_trainctl_words() {\n  case \"$1\" in\n", cases,
                   "    *) return 1 ;;\n  esac\n}\n");
  if (shell == Shell::kBash) {
    return absl::StrCat("# bash completion of trainctl\n", words, kBash);
  }
  return absl::StrCat("#compdef trainctl\n", words, kZsh);
}

void AddCompletion(CLI::App& app, const SelectCommand& select) {
  auto shell = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand(
      "completion", "Print a script that completes command lines in a shell");
  command->add_option("shell", *shell, "bash or zsh")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh"}));
  command->footer(
      "Examples:\n"
      "  source <(trainctl completion bash)\n"
      "  trainctl completion zsh > ~/.zfunc/_trainctl");
  command->callback([=, &app] {
    select([shell, &app] {
      std::cout << CompletionScript(
          app, *shell == "bash" ? Shell::kBash : Shell::kZsh);
      return absl::OkStatus();
    });
  });
}

}  // namespace tactus::internal::client
