// trainctl cues: the cues that models can take, as docs/cues.md lists them.
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/cues/cue_group.h"
#include "tools/common/json.h"
#include "tools/trainctl/command.h"

namespace tactus::internal::client {
namespace {

struct CuesFlags {
  bool markdown = false;
  bool json = false;
};

std::vector<std::string> Needs(const CueRow& row) {
  std::vector<std::string> needs;
  if ((row.needs & kNeedsForce) != 0) needs.emplace_back("force");
  if ((row.needs & kNeedsArea) != 0) needs.emplace_back("area");
  if ((row.needs & kNeedsMotion) != 0) needs.emplace_back("motion");
  return needs;
}

std::vector<std::string> UnchangedBy(const CueRow& row) {
  std::vector<std::string> symmetries;
  if ((row.unchanged_by & kPace) != 0) symmetries.emplace_back("pace");
  if ((row.unchanged_by & kLoad) != 0) symmetries.emplace_back("load");
  if ((row.unchanged_by & kStiffness) != 0) {
    symmetries.emplace_back("stiffness");
  }
  return symmetries;
}

// "row_load_0 to row_load_5", each name between `quote`s.
std::string NamesText(const CueRow& row, absl::string_view quote) {
  if (row.count == 1) return absl::StrCat(quote, row.name, quote);
  return absl::StrCat(quote, row.name, "_0", quote, " to ", quote, row.name,
                      "_", row.count - 1, quote);
}

void PrintMarkdown() {
  std::cout << "| cue | needs | unchanged by | meaning |\n|---|---|---|---|\n";
  for (const CueGroup& group : AllCueGroups()) {
    for (const CueRow& row : group.rows) {
      std::cout << absl::StrCat("| ", NamesText(row, "`"), " | ",
                                absl::StrJoin(Needs(row), ", "), " | ",
                                absl::StrJoin(UnchangedBy(row), ", "), " | ",
                                row.meaning, " |\n");
    }
  }
}

void PrintText() {
  for (const CueGroup& group : AllCueGroups()) {
    std::cout << group.name
              << (group.standard ? " (LSTMs take these by default)" : "")
              << "\n";
    for (const CueRow& row : group.rows) {
      std::cout << absl::StrCat("  ", NamesText(row, ""), ": ", row.meaning,
                                "\n");
    }
  }
}

void PrintJson() {
  Json list = Json::array();
  for (const CueGroup& group : AllCueGroups()) {
    for (const Cue cue : CuesOfGroup(group.name)) {
      int place = PlaceInGroup(cue);
      size_t r = 0;
      while (place >= group.rows[r].count) place -= group.rows[r++].count;
      const CueRow& row = group.rows[r];
      list.push_back({{"name", std::string(CueName(cue))},
                      {"group", std::string(group.name)},
                      {"by_default", group.standard},
                      {"needs", Needs(row)},
                      {"unchanged_by", UnchangedBy(row)},
                      {"meaning", std::string(row.meaning)}});
    }
  }
  std::cout << JsonText(list) << "\n";
}

}  // namespace

void AddCues(CLI::App& app, const SelectCommand& select) {
  auto flags = std::make_shared<CuesFlags>();
  CLI::App& command =
      AddVerb(app, "cues", "List the numbers that models can take of a contact",
              "cues");
  CLI::Option* markdown = command.add_flag("--markdown", flags->markdown,
                                           "As the table of docs/cues.md");
  command.add_flag("--json", flags->json, "Print one JSON array")
      ->excludes(markdown);
  command.callback([=] {
    select([=] {
      if (flags->json) {
        PrintJson();
      } else if (flags->markdown) {
        PrintMarkdown();
      } else {
        PrintText();
      }
      return absl::OkStatus();
    });
  });
}

}  // namespace tactus::internal::client
