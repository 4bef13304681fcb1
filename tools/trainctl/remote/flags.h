// File: flags.h
//
// The commands of trainctl that speak to a server: which one, how, and what to
// do if it does not answer.
//
//   AddRemoteCommand(*command, select,
//                    [](TrainingClient& client, const RemoteFlags& flags) {
//                      return Print(client.ListDatasets());
//                    });
//
// The command line writes to the flags. Not thread-safe.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "CLI/CLI.hpp"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/training/training_client.h"
#include "tools/trainctl/command.h"

namespace tactus::internal::client {

struct RemoteFlags {
  std::string server;
  std::string ca;
  std::string token_file;
  bool json = false;

  void Add(CLI::App& command);
  // As Add, for a command that has --json already.
  void AddServer(CLI::App& command);
  // IO if a file cannot be read; INVALID_CONFIG, with the exit code of wrong
  // usage, if no server is given, or if a token would travel unencrypted.
  absl::StatusOr<std::unique_ptr<TrainingClient>> Connect() const;
  // `status`, with what to do about it if the server did not answer, is too old
  // or has the wrong certificate.
  absl::Status Explain(const absl::Status& status) const;
};

// The work of a command, once there is a connection.
using RemoteWork =
    std::function<absl::Status(TrainingClient&, const RemoteFlags&)>;

// Connects and does `work`; errors say what to do.
absl::Status RunRemote(const RemoteFlags& flags, const RemoteWork& work);

// Lets `command` do `work` with a server.
void AddRemoteCommand(CLI::App& command, const SelectCommand& select,
                      RemoteWork work);

// The name of a resource as users write it: "arm" is "datasets/arm" in the
// collection "datasets", "arm@3" is "datasets/arm/versions/3", and a full name
// stays as it is.
std::string FullName(absl::string_view collection, absl::string_view text);

struct UploadFlags {
  // The new version has the uploaded trials only.
  bool replace = false;
  // Uploaded trials take the place of those with the same frames.
  bool replace_labels = false;
};

// Adds the trials of a file to a dataset, and prints the new version and what
// became of trials that it holds already.
absl::Status UploadTrialFile(TrainingClient& client, const std::string& name,
                             const std::string& path, const UploadFlags& flags,
                             bool json);

// An identifier for a request that no other request has.
std::string NewRequestId();

}  // namespace tactus::internal::client
