#include "tests/house/house_rules.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <sstream>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/string_view.h"
#include "absl/strings/strip.h"

namespace tactus::internal {
namespace {

constexpr int kMaxLines = 600;
constexpr int kMaxAdapterLines = 300;
// clang-format leaves comments as they are.
constexpr size_t kMaxColumns = 80;

// Where files lie that pages name.
constexpr std::array<absl::string_view, 10> kNamedFolders = {
    "core",  "server", "client", "tools",    "tests",
    "proto", "docs",   "deploy", "examples", "research"};

// Plain types that any room of core may use, wherever they live.
constexpr std::array<absl::string_view, 1> kPlainHeaders = {
    "core/data/trial.h"};

// Rooms that read and write files or connections; all others only compute.
constexpr std::array<absl::string_view, 6> kFileRooms = {
    "connections", "files", "data", "import", "postgres", "store"};

// Rooms of the server that tests run without a network.
constexpr std::array<absl::string_view, 9> kRoomsWithoutGrpc = {
    "server/session/",     "server/names/",    "server/registry/",
    "server/records/",     "server/jobs/",     "server/trainer/",
    "server/contact_log/", "server/replicas/", "server/ranks/"};

constexpr std::array<absl::string_view, 6> kNotForComputing = {
    "thread", "mutex", "chrono", "fstream", "filesystem", "iostream"};

constexpr std::array<absl::string_view, 5> kOfThreads = {
    "thread", "mutex", "atomic", "core/base/run_on_threads.h",
    "core/base/work.h"};

// What stands between `open` and the next `close`, within lines.
std::vector<absl::string_view> PartsBetween(absl::string_view text,
                                            absl::string_view open,
                                            absl::string_view close) {
  std::vector<absl::string_view> parts;
  for (const absl::string_view line : absl::StrSplit(text, '\n')) {
    size_t from = line.find(open);
    while (from != line.npos) {
      from += open.size();
      const size_t to = line.find(close, from);
      if (to == line.npos) break;
      parts.push_back(line.substr(from, to - from));
      from = line.find(open, to + close.size());
    }
  }
  return parts;
}

// `page` without its blocks of code.
std::string WithoutCode(const std::string& page) {
  std::string text;
  bool in_code = false;
  for (const absl::string_view line : absl::StrSplit(page, '\n')) {
    if (absl::StartsWith(line, "```")) {
      in_code = !in_code;
    } else if (!in_code) {
      absl::StrAppend(&text, line, "\n");
    }
  }
  return text;
}

// A path with a known first folder and a name with an ending.
bool LooksLikeFile(absl::string_view text) {
  const auto is_part_of_path = [](char c) {
    return absl::ascii_isalnum(c) ||
           absl::string_view("_./-").find(c) != absl::string_view::npos;
  };
  const size_t slash = text.find('/');
  const size_t dot = text.rfind('.');
  if (slash == text.npos || dot == text.npos || dot + 1 == text.size()) {
    return false;
  }
  return std::ranges::all_of(text, is_part_of_path) &&
         std::ranges::all_of(
             text.substr(dot + 1),
             [](char c) { return absl::ascii_isalnum(c) || c == '_'; }) &&
         std::ranges::find(kNamedFolders, text.substr(0, slash)) !=
             kNamedFolders.end();
}

template <typename Range, typename Value>
bool Holds(const Range& range, const Value& value) {
  return std::find(range.begin(), range.end(), value) != range.end();
}

// "core/sim/exact/bounce.h" -> "sim/exact" if `rooms` lists that part of a
// room, else "sim"; empty outside core.
std::string PartOf(const std::string& path,
                   const std::vector<std::string>& rooms) {
  const std::vector<std::string> parts = absl::StrSplit(path, '/');
  if (parts.size() <= 2 || parts[0] != "core") return "";
  const std::string part = absl::StrCat(parts[1], "/", parts[2]);
  return Holds(rooms, part) ? part : parts[1];
}

// "core/hmm/hmm_bank.h" -> "hmm"; empty outside core.
std::string RoomOf(const std::string& path) {
  const std::vector<std::string> parts = absl::StrSplit(path, '/');
  return parts.size() > 2 && parts[0] == "core" ? parts[1] : "";
}

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

// The file that a line includes, without quotes or brackets; empty if none.
std::string Included(absl::string_view line) {
  line = absl::StripAsciiWhitespace(line);
  if (!absl::ConsumePrefix(&line, "#")) return "";
  line = absl::StripLeadingAsciiWhitespace(line);
  if (!absl::ConsumePrefix(&line, "include")) return "";
  line = absl::StripLeadingAsciiWhitespace(line);
  if (line.empty() || (line[0] != '"' && line[0] != '<')) return "";
  const char close = line[0] == '<' ? '>' : '"';
  line.remove_prefix(1);
  return std::string(line.substr(0, line.find(close)));
}

constexpr absl::string_view kPublicNamespace = "namespace tactus {";

// The installed headers, and what stands behind them.
bool DefinesPublicNames(const std::string& path) {
  return absl::StartsWith(path, "client/include/") ||
         (absl::StartsWith(path, "client/front/") &&
          absl::EndsWith(path, ".cc"));
}

bool IsGrpc(const std::string& header) {
  return absl::StartsWith(header, "grpc") ||
         absl::EndsWith(header, ".grpc.pb.h");
}

// The file that spreads work over threads for the programs which ask for it.
constexpr absl::string_view kThreads = "core/base/run_on_threads.cc";

// Why a core file may not include `header`; empty if it may.
std::string WhyNotInCore(const std::string& path, const std::string& header,
                         const std::vector<std::string>& rooms) {
  if (IsGrpc(header)) return "core knows no gRPC";
  const std::string room = RoomOf(path);
  if (!Holds(kFileRooms, room) && path != kThreads &&
      Holds(kNotForComputing, header)) {
    return "rooms that compute use no threads, clocks or files";
  }
  if (RoomOf(header).empty() || Holds(kPlainHeaders, header)) return "";
  const bool same_room = RoomOf(header) == room;
  const std::string here = same_room ? PartOf(path, rooms) : room;
  const std::string other = same_room ? PartOf(header, rooms) : RoomOf(header);
  if (other == here) return "";
  const auto own = std::find(rooms.begin(), rooms.end(), here);
  if (own == rooms.end()) return "its room is not in core/CMakeLists.txt";
  return std::find(rooms.begin(), own, other) == own
             ? absl::StrCat("room ", other, " is not below room ", here)
             : "";
}

std::string WhyNot(const std::string& path, const std::string& header,
                   const std::vector<std::string>& rooms) {
  const auto from = [&](absl::string_view top) {
    return absl::StartsWith(path, top);
  };
  const auto to = [&](absl::string_view top) {
    return absl::StartsWith(header, top);
  };
  // The installed headers.
  if (from("client/include/")) {
    const bool is_public =
        to("tactus/") && !to("tactus/v1/") && absl::EndsWith(header, ".h");
    const bool is_plain =
        !absl::StrContains(header, '/') && !absl::StrContains(header, '.');
    return is_public || is_plain || to("absl/status/")
               ? ""
               : "public headers use the standard library and absl::Status";
  }
  if (from("core/") && (to("server/") || to("client/"))) {
    return "core knows neither server nor client";
  }
  if (from("server/") && to("client/")) return "server does not know client";
  if (from("client/") && to("server/")) return "client does not know server";
  if (from("tools/") && to("server/")) return "tools do not know server";
  // Tests, and the studies that stand beside them.
  const bool beside = from("tests/") || from("research/");
  if (!beside && to("tests/")) return "only tests know tests";
  if (!beside && to("research/")) return "only studies know studies";
  if (!from("tools/") && !beside && to("tools/")) {
    return "only tools know tools";
  }
  for (const absl::string_view room : kRoomsWithoutGrpc) {
    if (from(room) && (IsGrpc(header) || to("server/rpc/"))) {
      return absl::StrCat(room, " knows no gRPC");
    }
  }
  return from("core/") ? WhyNotInCore(path, header, rooms) : "";
}

}  // namespace

std::vector<std::string> CoreRooms(const std::string& cmake_text) {
  std::vector<std::string> rooms;
  for (const std::string& text : Lines(cmake_text)) {
    absl::string_view line = absl::StripAsciiWhitespace(text);
    if (absl::ConsumePrefix(&line, "add_subdirectory(") &&
        absl::ConsumeSuffix(&line, ")")) {
      rooms.emplace_back(line);
    }
  }
  return rooms;
}

std::vector<std::string> IncludeViolations(
    const std::string& path, const std::string& text,
    const std::vector<std::string>& rooms) {
  std::vector<std::string> violations;
  int number = 0;
  for (const std::string& line : Lines(text)) {
    ++number;
    const std::string header = Included(line);
    if (header.empty()) continue;
    const std::string why = WhyNot(path, header, rooms);
    if (why.empty()) continue;
    violations.push_back(
        absl::StrCat(path, ":", number, ": ", header, ": ", why));
  }
  return violations;
}

std::vector<std::string> FoldersUnderThreadSanitizer(
    const std::string& cmake_text) {
  return absl::StrSplit(
      cmake_text.substr(
          0, cmake_text.find("# ThreadSanitizer has nothing to see")),
      absl::ByAnyChar(" \n()"), absl::SkipEmpty());
}

std::vector<std::string> ThreadViolations(
    const std::string& path, const std::string& text,
    const std::vector<std::string>& tested) {
  const std::string room = RoomOf(path);
  if (room.empty() || Holds(tested, absl::StrCat("core/", room))) return {};
  std::vector<std::string> violations;
  for (const std::string& line : Lines(text)) {
    const std::string header = Included(line);
    if (!Holds(kOfThreads, header) &&
        !absl::StartsWith(header, "absl/synchronization/")) {
      continue;
    }
    violations.push_back(absl::StrCat(path, ": ", header,
                                      ": ThreadSanitizer does not see core/",
                                      room, " (tests/CMakeLists.txt)"));
  }
  return violations;
}

std::vector<std::string> StyleViolations(const std::string& path,
                                         const std::string& text) {
  std::vector<std::string> violations;
  const std::vector<std::string> lines = Lines(text);
  const int limit =
      absl::StartsWith(path, "server/rpc/") ? kMaxAdapterLines : kMaxLines;
  if (static_cast<int>(lines.size()) > limit) {
    violations.push_back(absl::StrCat(path, ": has ", lines.size(),
                                      " lines; the limit is ", limit));
  }
  // Spelt apart, so that this file keeps its own rule.
  const std::array<std::string, 2> leftovers = {std::string("TO") + "DO",
                                                std::string("FIX") + "ME"};
  // These return a std::ranges::subrange, and clang builds for the sanitizers.
  const std::string ranges = std::string("std::") + "ranges::";
  const std::array<std::string, 8> subranges = {
      ranges + "stable_partition(", ranges + "partition(", ranges + "remove",
      ranges + "unique(",           ranges + "rotate(",    ranges + "search(",
      ranges + "equal_range(",      ranges + "find_end("};
  int number = 0;
  bool in_comment = false;
  for (const std::string& line : lines) {
    ++number;
    const absl::string_view bare = absl::StripLeadingAsciiWhitespace(line);
    const bool is_comment = absl::StartsWith(bare, "//");
    if (!in_comment && absl::StartsWith(bare, std::string("// O") + "f ")) {
      violations.push_back(absl::StrCat(path, ":", number,
                                        ": a comment names its subject first"));
    }
    if (is_comment && line.size() > kMaxColumns) {
      violations.push_back(absl::StrCat(path, ":", number, ": has ",
                                        line.size(), " columns; the limit is ",
                                        kMaxColumns));
    }
    in_comment = is_comment;
    if (line == kPublicNamespace && !DefinesPublicNames(path)) {
      violations.push_back(absl::StrCat(path, ":", number,
                                        ": what is not installed is in "
                                        "tactus::internal"));
    }
    for (const std::string& word : leftovers) {
      if (!absl::StrContains(line, word)) continue;
      violations.push_back(absl::StrCat(path, ":", number, ": ", word));
    }
    for (const std::string& name : subranges) {
      if (!absl::StrContains(line, name)) continue;
      violations.push_back(
          absl::StrCat(path, ":", number, ": clang 14 cannot compile ", name));
    }
    // It throws on text that is not UTF-8.
    if (absl::StrContains(line, ".dump(") &&
        (absl::StartsWith(path, "client/") ||
         absl::StartsWith(path, "tools/")) &&
        path != "tools/common/json.h") {
      violations.push_back(
          absl::StrCat(path, ":", number, ": JSON is written by JsonText()"));
    }
  }
  if (absl::EndsWith(path, ".h")) {
    const std::string name = path.substr(path.rfind('/') + 1);
    if (lines.empty() || lines[0] != "// File: " + name) {
      violations.push_back(
          absl::StrCat(path, ":1: must begin with // File: ", name));
    }
    // Highway includes a "-inl.h" once for each instruction set.
    if (!absl::EndsWith(path, "-inl.h") && !Holds(lines, "#pragma once")) {
      violations.push_back(absl::StrCat(path, ": has no #pragma once"));
    }
  }
  return violations;
}

std::vector<std::string> RoomsNamed(const std::string& page) {
  std::vector<std::string> rooms;
  for (const std::string& line : Lines(page)) {
    if (!absl::StartsWith(line, "| `")) continue;
    const std::string cell = line.substr(0, line.find('|', 1));
    for (const absl::string_view room : PartsBetween(cell, "`", "`")) {
      rooms.emplace_back(room);
    }
  }
  return rooms;
}

std::vector<std::string> FilesNamed(const std::string& path,
                                    const std::string& page) {
  const std::string text = WithoutCode(page);
  const std::filesystem::path folder =
      std::filesystem::path(path).parent_path();
  std::vector<std::string> files;
  // Links: ](target) or ](target#place), but for other sites' and places of
  // the page itself.
  for (const absl::string_view part : PartsBetween(text, "](", ")")) {
    const absl::string_view target = part.substr(0, part.find('#'));
    if (target.empty() || absl::StrContains(target, ":")) continue;
    files.push_back((folder / std::string(target)).lexically_normal().string());
  }
  for (const absl::string_view part : PartsBetween(text, "`", "`")) {
    if (LooksLikeFile(part)) files.emplace_back(part);
  }
  return files;
}

}  // namespace tactus::internal
