#include "tools/trainctl/unknown_word.h"

#include <algorithm>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/text.h"

namespace tactus::internal::client {
namespace {

// Insertions, deletions, replacements and swaps of neighbours that turn `a`
// into `b` (the optimal string alignment distance).
size_t EditDistance(const std::string& a, const std::string& b) {
  std::vector<std::vector<size_t>> cost(a.size() + 1,
                                        std::vector<size_t>(b.size() + 1));
  for (size_t i = 0; i <= a.size(); ++i) {
    for (size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        cost[i][j] = i + j;
        continue;
      }
      cost[i][j] =
          std::min({cost[i - 1][j] + 1, cost[i][j - 1] + 1,
                    cost[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
      }
    }
  }
  return cost[a.size()][b.size()];
}

// The candidate that is most like `word`; empty if none is like it.
std::string Nearest(const std::string& word,
                    const std::vector<std::string>& candidates) {
  constexpr size_t kLongest = 64;
  if (word.size() > kLongest) return "";
  std::string nearest;
  size_t least = std::max<size_t>(1, word.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const size_t distance = EditDistance(word, candidate);
    if (distance >= least) continue;
    least = distance;
    nearest = candidate;
  }
  return nearest;
}

// "trainctl jobs" of the command `jobs`.
std::string PathOf(const CLI::App& command) {
  const CLI::App* parent = command.get_parent();
  if (parent == nullptr) return command.get_name();
  return absl::StrCat(PathOf(*parent), " ", command.get_name());
}

std::string NameIn(const std::string& path) {
  return path.substr(path.rfind(' ') + 1);
}

// A command of this name, or with one like it: below `command` if there is one,
// else anywhere.
std::string CommandLike(const std::string& word, const CLI::App& root,
                        const CLI::App& command) {
  for (const CLI::App* from : {&command, &root}) {
    const std::vector<std::string> paths = CommandPaths(*from);
    std::vector<std::string> names;
    for (const std::string& path : paths) names.push_back(NameIn(path));
    const std::string name = Nearest(word, names);
    if (name.empty()) continue;
    return paths[std::ranges::find(names, name) - names.begin()];
  }
  return "";
}

std::string UnknownCommand(const std::string& word, const CLI::App& root,
                           const CLI::App& command) {
  const std::string like = CommandLike(word, root, command);
  const std::string head = absl::StrCat(Quoted(word), " is not a command of ",
                                        PathOf(command), "; ");
  if (!like.empty()) return absl::StrCat(head, "did you mean ", like, "?");
  std::vector<std::string> names;
  for (const CLI::App* child : command.get_subcommands({})) {
    names.push_back(child->get_name());
  }
  return absl::StrCat(head, "it must be one of ", absl::StrJoin(names, ", "));
}

std::string UnknownFlag(const std::string& flag, const CLI::App& command) {
  std::vector<std::string> flags;
  for (const CLI::Option* option : command.get_options({})) {
    for (const std::string& name : option->get_lnames()) {
      flags.push_back(absl::StrCat("--", name));
    }
  }
  const std::string like = Nearest(flag, flags);
  const std::string head =
      absl::StrCat(Quoted(flag), " is not a flag of ", PathOf(command), "; ");
  if (!like.empty()) return absl::StrCat(head, "did you mean ", like, "?");
  return absl::StrCat(head, PathOf(command), " --help lists those that are");
}

}  // namespace

std::vector<std::string> CommandPaths(const CLI::App& app) {
  std::vector<std::string> paths;
  for (const CLI::App* child : app.get_subcommands({})) {
    paths.push_back(PathOf(*child));
    for (std::string& path : CommandPaths(*child)) {
      paths.push_back(std::move(path));
    }
  }
  return paths;
}

std::string UnknownWord(const CLI::App& app,
                        const std::vector<std::string>& words) {
  const CLI::App* command = &app;
  for (const std::string& word : words) {
    if (word == "--") break;
    if (absl::StartsWith(word, "--")) {
      const std::string flag = word.substr(0, word.find('='));
      if (command->get_option_no_throw(flag) == nullptr) {
        return UnknownFlag(flag, *command);
      }
      continue;
    }
    if (command->get_subcommands({}).empty() || absl::StartsWith(word, "-")) {
      continue;
    }
    const auto next = command->get_subcommands(
        [&](const CLI::App* child) { return child->get_name() == word; });
    if (next.empty()) return UnknownCommand(word, app, *command);
    command = next.front();
  }
  return "";
}

}  // namespace tactus::internal::client
