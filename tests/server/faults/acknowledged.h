// File: acknowledged.h
//
// Acknowledged: what a server has confirmed to its client, and the check that
// all of it is there.
//
//   Acknowledged log;
//   log.versions[version.name()] = {version.sha256(), pack};
//   ...the server is killed and starts again...
//   log.Check(client);
//
// Not thread-safe.
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "client/training/operation_watcher.h"
#include "client/training/training_client.h"
#include "gtest/gtest.h"

namespace tactus::internal::testing {

// The trials of a version, as a pack.
inline absl::StatusOr<std::string> Download(client::TrainingClient& client,
                                            const std::string& version) {
  v1::DownloadTrialsRequest request;
  request.set_dataset_version(version);
  const auto context = client.NewContext(client.timeout());
  const auto reader = client.training().DownloadTrials(context.get(), request);
  std::string pack;
  v1::DownloadTrialsResponse response;
  while (reader->Read(&response)) pack += response.data();
  const absl::Status status = client::TrainingClient::ErrorOf(
      reader->Finish(), "DownloadTrials", client.timeout());
  if (!status.ok()) return status;
  return pack;
}

struct Acknowledged {
  struct Version {
    std::string sha256;
    std::string pack;
    bool operator==(const Version&) const = default;
  };
  struct Change {
    std::string model_version;
    bool forced = false;
    bool rollback = false;
    bool operator==(const Change&) const = default;
  };

  // By name.
  std::map<std::string, Version> versions;
  // The upload that is not finished; empty without one.
  std::string upload;
  int64_t committed = 0;
  // Name by request_id.
  std::map<std::string, std::string> operations;
  // Ended ones by name.
  std::map<std::string, v1::Operation> ended;
  // Bundles by the name of the version.
  std::map<std::string, std::string> bundles;
  // The oldest first. A change that was requested may be behind them.
  std::vector<Change> changes;
  // Empty while it is not known.
  std::string etag;
  bool change_requested = false;

  // Compares all of it with what the server has now; bytes of the newest three
  // only, unless `whole`.
  void Check(client::TrainingClient& client, bool whole) const {
    CheckVersions(client, whole);
    CheckUpload(client);
    CheckOperations(client);
    CheckModels(client, whole);
    CheckAlias(client);
  }

  static std::vector<Change> ChangesOf(client::TrainingClient& client) {
    const auto history = client.ListAliasHistory("aliases/default");
    std::vector<Change> changes;
    if (!history.ok()) return changes;
    for (const v1::AliasChange& change : *history) {
      changes.push_back(
          {change.model_version(), change.forced(), change.rollback()});
    }
    std::reverse(changes.begin(), changes.end());
    return changes;
  }

 private:
  // Whether the bytes of entry `index` of `size` are compared.
  static bool IsRead(size_t index, size_t size, bool whole) {
    return whole || index + 3 >= size;
  }
  void CheckVersions(client::TrainingClient& client, bool whole) const {
    size_t index = 0;
    for (const auto& [name, version] : versions) {
      const auto found = client.GetDatasetVersion(name);
      ASSERT_TRUE(found.ok()) << name << ": " << found.status();
      EXPECT_EQ(found->sha256(), version.sha256) << name;
      if (IsRead(index++, versions.size(), whole)) {
        const auto pack = Download(client, name);
        ASSERT_TRUE(pack.ok()) << name << ": " << pack.status();
        EXPECT_TRUE(*pack == version.pack) << name;
      }
    }
  }
  void CheckUpload(client::TrainingClient& client) const {
    if (upload.empty()) return;
    const auto status = client.QueryWriteStatus(upload);
    ASSERT_TRUE(status.ok()) << upload << ": " << status.status();
    EXPECT_GE(status->committed_size(), committed) << upload;
  }
  void CheckOperations(client::TrainingClient& client) const {
    for (const auto& [id, name] : operations) {
      const auto operation = client.GetOperation(name);
      ASSERT_TRUE(operation.ok()) << name << ": " << operation.status();
      if (const auto end = ended.find(name); end != ended.end()) {
        EXPECT_EQ(operation->SerializeAsString(),
                  end->second.SerializeAsString())
            << operation->ShortDebugString();
      }
    }
  }
  void CheckModels(client::TrainingClient& client, bool whole) const {
    size_t index = 0;
    for (const auto& [name, bundle] : bundles) {
      const auto found = client.GetModelVersion(name);
      ASSERT_TRUE(found.ok()) << name << ": " << found.status();
      EXPECT_EQ(found->bytes(), static_cast<int64_t>(bundle.size()));
      if (IsRead(index++, bundles.size(), whole)) {
        const auto bytes = client.ExportModel(name);
        ASSERT_TRUE(bytes.ok()) << name << ": " << bytes.status();
        EXPECT_TRUE(*bytes == bundle) << name;
      }
    }
  }
  void CheckAlias(client::TrainingClient& client) const {
    if (changes.empty()) return;
    // A job that goes on may move the alias between these calls.
    const auto aliases = client.ListAliases();
    ASSERT_TRUE(aliases.ok()) << aliases.status();
    ASSERT_EQ(aliases->size(), 1u);
    const v1::Alias& alias = aliases->front();
    const auto served = client.GetModelVersion("aliases/default");
    ASSERT_TRUE(served.ok()) << served.status();
    const std::vector<Change> now = ChangesOf(client);
    ASSERT_GE(now.size(), changes.size());
    EXPECT_LE(now.size(), changes.size() + (change_requested ? 1 : 0));
    EXPECT_TRUE(std::equal(changes.begin(), changes.end(), now.begin()));
    const std::string& old = changes.back().model_version;
    for (const std::string& version : {alias.model_version(), served->name()}) {
      if (version != old) {
        EXPECT_EQ(version, now.back().model_version);
      }
    }
    if (alias.model_version() == old && !etag.empty()) {
      EXPECT_EQ(alias.etag(), etag);
    }
  }
};

}  // namespace tactus::internal::testing
