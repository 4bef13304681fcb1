// File: filled_data.h
//
// A data directory in which each kind of record names something, for tests of
// what reads or copies all of it.
//
//   testing::FillData(folder / "data");
//   EXPECT_EQ(testing::FilesBelow(a), testing::FilesBelow(b));
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "core/base/crc32c.h"
#include "core/base/sha256.h"
#include "core/store/data_directory.h"
#include "core/store/numbers.h"
#include "core/store/records.h"
#include "gtest/gtest.h"
#include "tactus/v1/models.pb.h"
#include "tactus/v1/operations.pb.h"
#include "tactus/v1/storage.pb.h"
#include "tactus/v1/training.pb.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal::testing {

// From one interruption of a copy to the next one that is tried: a quick test
// leaves most out.
inline int StepOfInterruptions() {
  return std::getenv("TACTUS_LONG") != nullptr ? 1 : 7;
}

inline constexpr int kFilledTrials = 5;
// More than a transaction copies.
inline constexpr int kFilledAuditEntries = 150;

inline std::string FilledTrial(int number) {
  return "trial " + std::to_string(number) + std::string("\0\xff", 2);
}
inline std::string FilledModel() { return std::string(3000, 'm'); }
inline std::string FilledUpload() { return std::string(1'100'000, 'u'); }

inline absl::Status PutFilledRecords(Transaction& change,
                                     const std::string& manifest_sha256,
                                     const std::vector<std::string>& trials) {
  v1::Dataset dataset;
  dataset.set_name("datasets/d");
  TACTUS_RETURN_IF_ERROR(PutRecord(change, Table::kDatasets, "d", dataset));
  v1::DatasetVersion version;
  version.set_name("datasets/d/versions/1");
  version.set_sha256(manifest_sha256);
  TACTUS_RETURN_IF_ERROR(
      PutRecord(change, Table::kDatasetVersions, "d/0000000001", version));
  for (const std::string& sha256 : trials) {
    TACTUS_RETURN_IF_ERROR(change.Put(Table::kTrials, sha256, "info"));
  }
  v1::ModelVersion model;
  model.set_name("models/m/versions/1");
  model.set_blob_sha256(Sha256Hex(FilledModel()));
  TACTUS_RETURN_IF_ERROR(
      PutRecord(change, Table::kModelVersions, "m/0000000001", model));
  v1::StoredUpload upload;
  upload.set_name("uploads/2");
  // In 2100, so that it does not count as abandoned.
  upload.set_create_time_ms(4'102'444'800'000);
  upload.set_committed_size(static_cast<int64_t>(FilledUpload().size()));
  upload.set_crc32c(ExtendCrc32c(0, FilledUpload()));
  TACTUS_RETURN_IF_ERROR(
      PutRecord(change, Table::kUploads, NumberKey(2), upload));
  // Finished, and so without a file.
  v1::StoredUpload finished;
  finished.set_name("uploads/1");
  finished.set_committed_size(7);
  finished.set_dataset_version("datasets/d/versions/1");
  TACTUS_RETURN_IF_ERROR(
      PutRecord(change, Table::kUploads, NumberKey(1), finished));
  v1::Operation running;
  running.set_name("operations/8");
  running.set_state(v1::Operation::STATE_RUNNING);
  TACTUS_RETURN_IF_ERROR(
      PutRecord(change, Table::kOperations, NumberKey(8), running));
  v1::Operation ended;
  ended.set_name("operations/7");
  ended.set_state(v1::Operation::STATE_SUCCEEDED);
  TACTUS_RETURN_IF_ERROR(
      PutRecord(change, Table::kOperations, NumberKey(7), ended));
  for (int i = 0; i < kFilledAuditEntries; ++i) {
    TACTUS_RETURN_IF_ERROR(change.Put(Table::kAudit, NumberKey(i), "entry"));
  }
  TACTUS_RETURN_IF_ERROR(
      change.Put(Table::kAliases, std::string("\0\xff'", 3), "m@1"));
  TACTUS_RETURN_IF_ERROR(change.Put(Table::kNumbers, "uploads", NumberKey(2)));
  // These belong to the place and its processes.
  TACTUS_RETURN_IF_ERROR(change.Put(Table::kNumbers, "replicas", "3"));
  return change.Put(Table::kLeases, "datasets", "stale");
}

// Fills a directory that a server has opened.
inline void FillData(const std::string& folder) {
  auto data = DataDirectory::Open(PosixFileSystem(), folder);
  ASSERT_TRUE(data.ok()) << data.status();
  BlobStore::Batch batch = (*data)->blobs().NewBatch();
  std::string manifest;
  std::vector<std::string> trials;
  for (int i = 0; i < kFilledTrials; ++i) {
    trials.push_back(*batch.Add(FilledTrial(i)));
    manifest += trials.back() + "\n";
  }
  const std::string manifest_sha256 = *batch.Add(manifest);
  ASSERT_TRUE(batch.Add(FilledModel()).ok());
  // Nothing names it.
  ASSERT_TRUE(batch.Add("orphan").ok());
  ASSERT_TRUE(batch.Commit().ok());
  ASSERT_TRUE((*data)
                  ->catalog()
                  .Change([&](Transaction& change) {
                    return PutFilledRecords(change, manifest_sha256, trials);
                  })
                  .ok());
  // Bytes behind those that were committed do not count.
  WriteBytes((*data)->UploadPath("2"), FilledUpload() + "more");
  std::filesystem::create_directories((*data)->JobPath("8") + "/inner");
  WriteBytes((*data)->JobPath("8") + "/checkpoint", "half way");
  WriteBytes((*data)->JobPath("8") + "/inner/log", "epoch 3");
  std::filesystem::create_directories((*data)->JobPath("7"));
  WriteBytes((*data)->JobPath("7") + "/log", "has ended");
  std::filesystem::create_directories(folder + "/lost+found/1");
  WriteBytes(folder + "/lost+found/1/x", "moved away");
  std::filesystem::create_directories(folder + "/contacts");
  WriteBytes(folder + "/contacts/ring", "contacts");
}

// All files of a folder, with their bytes; without the reserve, which is large.
inline std::map<std::string, std::string> FilesBelow(
    const std::string& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file() || entry.path().filename() == "reserve") {
      continue;
    }
    files[std::filesystem::relative(entry.path(), folder)] =
        ReadBytes(entry.path());
  }
  return files;
}

// What a copy of FillData's directory has in blobs/, uploads/ and jobs/, by
// path.
inline std::map<std::string, std::string> FilledFiles() {
  std::map<std::string, std::string> files;
  const auto add = [&](const std::string& bytes) {
    const std::string sha256 = Sha256Hex(bytes);
    files["blobs/" + sha256.substr(0, 2) + "/" + sha256] = bytes;
    return sha256;
  };
  std::string manifest;
  for (int i = 0; i < kFilledTrials; ++i) {
    manifest += add(FilledTrial(i)) + "\n";
  }
  add(manifest);
  add(FilledModel());
  files["uploads/2"] = FilledUpload();
  files["jobs/8/checkpoint"] = "half way";
  files["jobs/8/inner/log"] = "epoch 3";
  return files;
}

// The files of `folder` that FilledFiles lists.
inline std::map<std::string, std::string> DataFilesBelow(
    const std::string& folder) {
  std::map<std::string, std::string> files;
  for (const auto& [path, bytes] : FilesBelow(folder)) {
    for (const char* part : {"blobs/", "uploads/", "jobs/"}) {
      if (path.rfind(part, 0) == 0) files[path] = bytes;
    }
  }
  return files;
}

}  // namespace tactus::internal::testing
