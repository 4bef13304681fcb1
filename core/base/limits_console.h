// File: limits_console.h
//
// Limits of the console: of browsers, and of what they send.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tactus::internal::limits {

// Connections of browsers; those beyond are closed.
inline constexpr int kMaxBrowserConnections = 512;
// Pages that watch robots, of these connections.
inline constexpr int kMaxLivePages = 64;
// A request's line and header, and its body.
inline constexpr uint32_t kMaxBrowserHeaderBytes = 8 * 1024;
inline constexpr uint64_t kMaxBrowserBodyBytes = 16 * 1024;
// A message of a page that watches, and how many it sends a second.
inline constexpr size_t kMaxPageMessageBytes = 64;
inline constexpr int kMaxPageMessagesPerS = 300;
// A message of a program that watches by the protocol of Foxglove, which has
// room for 400 subscriptions, and how many it sends a second. Robots that it is
// shown; it subscribes once to each of their channels. Remarks that wait for
// it.
inline constexpr size_t kMaxFoxgloveMessageBytes = 16 * 1024;
inline constexpr int kMaxFoxgloveMessagesPerS = 1'000;
inline constexpr size_t kMaxFoxgloveRobots = 64;
inline constexpr size_t kMaxFoxgloveRemarks = 16;
// Seconds for a request to come, and for a response to go.
inline constexpr int kBrowserPatienceS = 10;
// People who are signed in, and for how many hours.
inline constexpr size_t kMaxSignIns = 256;
inline constexpr int kSignInHours = 12;
// Tokens that are checked at once.
inline constexpr int kMaxTokenChecks = 16;
// A file of the page.
inline constexpr size_t kMaxPageFileBytes = 4 * 1024 * 1024;
// A request of a page to a server, as JSON, which has room for 1,000 labels of
// contacts; and the response, of protobuf and then as JSON.
inline constexpr uint64_t kMaxPageCallBytes = 512 * 1024;
inline constexpr int kMaxPageReplyBytes = 4 * 1024 * 1024;
inline constexpr size_t kMaxPageReplyJsonBytes = 16 * 1024 * 1024;
// Such requests that one person, and all people, have under way, and seconds
// for one.
inline constexpr int kMaxPageCallsOfPerson = 8;
inline constexpr int kMaxPageCalls = 32;
inline constexpr int kPageCallS = 60;
// Files that a person sends to be imported: bytes of one, how many there are,
// and bytes of all of them. Parts of a name, which are folders but for the last
// one, and bytes of a part.
inline constexpr int64_t kMaxImportFileBytes = 256L * 1024 * 1024;
inline constexpr int kMaxImportFiles = 2'000;
inline constexpr int64_t kMaxImportBytes = 512L * 1024 * 1024;
inline constexpr size_t kMaxImportNameParts = 8;
inline constexpr size_t kMaxImportNamePartBytes = 200;
// The trial file that becomes of them.
inline constexpr int64_t kMaxImportTrialBytes = 512L * 1024 * 1024;
// Imports of one person, and of all people. So their files take at most 2 GiB.
inline constexpr int kMaxImportsOfPerson = 1;
inline constexpr int kMaxImports = 2;
// So much of a file must come in so many seconds, whatever its size.
inline constexpr size_t kImportPartBytes = 1024 * 1024;
inline constexpr int kImportPatienceS = 30;
// An import that nobody asks for anything so long has been forgotten.
inline constexpr int kImportIdleS = 900;
// What the program that reads the files may take: memory, seconds, and bytes of
// what it says.
inline constexpr int64_t kMaxImportMemoryBytes = 1536L * 1024 * 1024;
inline constexpr int kMaxImportS = 600;
inline constexpr size_t kMaxImportTextBytes = 1024 * 1024;
// Servers that one console shows.
inline constexpr size_t kMaxConsoleServers = 16;

}  // namespace tactus::internal::limits
