#include "core/cues/cue.h"

#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/cues/cue_group.h"

namespace tactus::internal {

#define TACTUS_CUES(group) CueGroup group();
#include "core/cues/cue_groups.inc"
#undef TACTUS_CUES

namespace {

#define TACTUS_CUES(group) +1
constexpr size_t kGroupCount = 0
#include "core/cues/cue_groups.inc"
    ;
#undef TACTUS_CUES
static_assert(kGroupCount <= 8 * sizeof(CueGroups), "one bit for each group");

struct CueEntry {
  std::string name;
  unsigned needs;
  int group;
  int place;
};

std::vector<CueEntry> MakeEntries() {
  std::vector<CueEntry> entries;
  const std::vector<CueGroup>& groups = AllCueGroups();
  for (size_t g = 0; g < groups.size(); ++g) {
    int place = 0;
    for (const CueRow& row : groups[g].rows) {
      for (int i = 0; i < row.count; ++i) {
        entries.push_back({row.count == 1 ? std::string(row.name)
                                          : absl::StrCat(row.name, "_", i),
                           row.needs, static_cast<int>(g), place++});
      }
    }
  }
  return entries;
}

const std::vector<CueEntry>& Entries() {
  static const auto& entries = *new std::vector<CueEntry>(MakeEntries());
  return entries;
}

const CueEntry& EntryOf(Cue cue) { return Entries()[static_cast<size_t>(cue)]; }

template <typename Wanted>
std::vector<Cue> CuesWhere(Wanted wanted) {
  std::vector<Cue> cues;
  for (int i = 0; i < CueCount(); ++i) {
    const Cue cue = static_cast<Cue>(i);
    if (wanted(AllCueGroups()[EntryOf(cue).group])) cues.push_back(cue);
  }
  return cues;
}

}  // namespace

const std::vector<CueGroup>& AllCueGroups() {
  static const auto& groups = *new std::vector<CueGroup>{
#define TACTUS_CUES(group) group(),
#include "core/cues/cue_groups.inc"
#undef TACTUS_CUES
  };
  return groups;
}

int CueCount() { return static_cast<int>(Entries().size()); }

absl::string_view CueName(Cue cue) { return EntryOf(cue).name; }

std::optional<Cue> ParseCue(absl::string_view name) {
  for (int i = 0; i < CueCount(); ++i) {
    if (Entries()[i].name == name) return static_cast<Cue>(i);
  }
  return std::nullopt;
}

Cue NamedCue(absl::string_view name) {
  const std::optional<Cue> cue = ParseCue(name);
  if (!cue) {
    std::fprintf(stderr, "no cue is called '%s'\n", std::string(name).c_str());
    std::abort();
  }
  return *cue;
}

Cue RawCue(Feature feature) { return static_cast<Cue>(feature); }

bool NeedsFeature(Cue cue, Feature feature) {
  return (EntryOf(cue).needs & (1U << static_cast<int>(feature))) != 0;
}

CueGroups GroupOf(Cue cue) { return CueGroups{1} << EntryOf(cue).group; }

CueSources SourcesOf(Cue cue) {
  return AllCueGroups()[EntryOf(cue).group].sources;
}

CueSources SourcesOf(CueGroups groups) {
  CueSources sources = 0;
  const std::vector<CueGroup>& all = AllCueGroups();
  for (size_t g = 0; g < all.size(); ++g) {
    if ((groups >> g & 1) != 0) sources |= all[g].sources;
  }
  return sources;
}

int PlaceInGroup(Cue cue) { return EntryOf(cue).place; }

std::vector<Cue> CuesOfGroup(absl::string_view group) {
  return CuesWhere([&](const CueGroup& g) { return g.name == group; });
}

std::vector<Cue> StandardCues() {
  return CuesWhere([](const CueGroup& g) { return g.standard; });
}

}  // namespace tactus::internal
