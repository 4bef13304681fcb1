// File: house_rules.h
//
// The rules of the house as functions of one file's path and text, so that
// the tests can show each of them failing. Test-only.
//
//   IncludeViolations("core/hmm/a.cc", text, rooms);
#pragma once

#include <string>
#include <vector>

namespace tactus::internal {

// The sub-folders that a CMakeLists.txt adds, in its order: in
// core/CMakeLists.txt the rooms of core, lowest first.
std::vector<std::string> CoreRooms(const std::string& cmake_text);

// What `text`, the source at `path` from the project's root, includes though
// the arrows proto <- core <- {server, client} or the order of rooms forbid
// it; as "path:line: what".
std::vector<std::string> IncludeViolations(
    const std::string& path, const std::string& text,
    const std::vector<std::string>& rooms);

// The folders whose tests tests/CMakeLists.txt builds for ThreadSanitizer: it
// lists them above those that it leaves out.
std::vector<std::string> FoldersUnderThreadSanitizer(
    const std::string& cmake_text);

// What `text`, the source at `path`, includes of threads, if it is of a room of
// core that is none of the folders `tested`; as "path: header: what".
std::vector<std::string> ThreadViolations(
    const std::string& path, const std::string& text,
    const std::vector<std::string>& tested);

// The folders in the first cells of a page's tables: `core/hmm`.
std::vector<std::string> RoomsNamed(const std::string& page);

// Where it breaks the rules on size, headers and leftovers.
std::vector<std::string> StyleViolations(const std::string& path,
                                         const std::string& text);

// The files that the Markdown page at `path` links to, or names between
// backticks with their path from the project's root; by that path. Blocks of
// code are left out.
std::vector<std::string> FilesNamed(const std::string& path,
                                    const std::string& page);

}  // namespace tactus::internal
