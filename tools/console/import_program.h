// File: import_program.h
//
// What an import asks trainctl, so that the checks, the trials and the words of
// the console are those of `trainctl import` and `trainctl datasets upload`.
//
//   TACTUS_ASSIGN_OR_RETURN(const ReadOptions options,
//                           ReadOptionsFrom(body, files));
//   TACTUS_ASSIGN_OR_RETURN(
//       const client::Json answer,
//       ReadTrials(program, files, options, cancelled));
//
// An answer is {"accepted": true, "remarks": ["..."], "result": {...}} with
// what trainctl prints with --json, or {"accepted": false, "remarks": ["..."],
// "error": "..."} with why trainctl refused, or what ended it.
//
// It is a separate process, because the files are a stranger's: a parser that
// crashes, loops or takes all memory on one of them costs this import alone. It
// works in the folder of the import, so its words name no other folder.
// Thread-safe; the last two functions block.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "tools/common/json.h"
#include "tools/console/import_files.h"
#include "tools/console/server_address.h"

namespace tactus::internal::console {

struct ImportProgram {
  // Path of trainctl.
  std::string path;
  int64_t memory_bytes = 0;
  std::chrono::milliseconds patience{};
};

// What `trainctl import` takes beside the files. Files are those of the import.
struct ReadOptions {
  // A file; empty: all of them together, as a folder.
  std::string source;
  std::string skin;
  std::string table;
  std::string file_names;
  std::string label;
  std::string condition;
};

// What `trainctl datasets upload` takes.
struct SendOptions {
  // "arm".
  std::string dataset;
  bool replaces_labels = false;
};

// The fields of a JSON object, each of which may be absent. INVALID_CONFIG if
// one is not known or no text, or names a file that is not there.
absl::StatusOr<ReadOptions> ReadOptionsFrom(const std::string& json,
                                            const ImportFiles& files);
// "replace_labels" is true or false. INVALID_CONFIG for a name that no dataset
// can have, too.
absl::StatusOr<SendOptions> SendOptionsFrom(const std::string& json);

// Makes a trial file of the files, in their folder; one of an earlier call is
// gone. IO if the program cannot be run; CANCELLED.
absl::StatusOr<client::Json> ReadTrials(const ImportProgram& program,
                                        const ImportFiles& files,
                                        const ReadOptions& options,
                                        const std::atomic<bool>& cancelled);

// Sends that trial file to a server, as the person with `token`; empty: none.
absl::StatusOr<client::Json> SendTrials(const ImportProgram& program,
                                        const ImportFiles& files,
                                        const SendOptions& options,
                                        const ServerAddress& server,
                                        const std::string& token,
                                        const std::atomic<bool>& cancelled);

}  // namespace tactus::internal::console
