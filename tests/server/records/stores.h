// File: stores.h
//
// All stores of the server on one folder, whose files may fail.
//
//   ScratchDir folder;
//   CrashFileSystem files;
//   Stores stores(&files, folder / "data");
//   stores.Upload(Pack(0, 3));
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/base/crc32c.h"
#include "core/base/status_macros.h"
#include "core/bundle/bundle.h"
#include "gtest/gtest.h"
#include "server/records/dataset_store.h"
#include "server/records/model_store.h"
#include "server/records/operation_store.h"
#include "server/records/upload_store.h"
#include "tests/support/crash_file_system.h"
#include "tests/support/crash_vfs.h"
#include "tests/support/scratch_dir.h"
#include "tests/support/small_model.h"
#include "tests/support/small_trials.h"

namespace tactus::internal::server {

inline const Caller kCaller = {"tester", "unix:"};
inline constexpr char kDataset[] = "datasets/d";
using testing::Packed;

// Small trials number `first` to `end` - 1, of three frames each.
inline std::string Pack(int first, int end) {
  return testing::SmallPack(first, end, 3);
}

// Each seed gives a different bundle.
inline std::string TestBundle(uint64_t seed) {
  Model model = testing::SmallModel();
  model.provenance.seed = seed;
  return *EncodeBundle(model);
}

struct Stores {
  Stores(FileSystem* files, const std::string& folder,
         const std::string& vfs = "", const Quotas& quotas = {}) {
    auto opened = DataDirectory::Open(*files, folder, vfs);
    EXPECT_TRUE(opened.ok()) << opened.status();
    if (!opened.ok()) return;
    data = *std::move(opened);
    const NowMs now = [this] { return time_ms; };
    datasets = std::make_unique<DatasetStore>(data.get(), now, quotas);
    uploads =
        std::make_unique<UploadStore>(data.get(), datasets.get(), now, quotas);
    operations = std::make_unique<OperationStore>(data.get(), now, quotas);
    models = std::make_unique<ModelStore>(data.get(), &registry, now, quotas);
    EXPECT_TRUE(registry.AddBuiltIn("default", TestBundle(0)).ok());
    EXPECT_TRUE(operations->Restore().ok());
    const auto followed = models->Follow();
    EXPECT_TRUE(followed.ok() && models->failures().empty());
  }

  // Writes from the committed size on, in chunks.
  absl::Status Write(const std::string& upload, const std::string& bytes,
                     size_t chunk) {
    TACTUS_ASSIGN_OR_RETURN(const auto writer, uploads->Write(upload, kCaller));
    auto offset = static_cast<size_t>(writer->committed_size());
    while (offset < bytes.size()) {
      const std::string part = bytes.substr(offset, chunk);
      TACTUS_RETURN_IF_ERROR(writer->Append(static_cast<int64_t>(offset), part,
                                            ExtendCrc32c(0, part)));
      TACTUS_RETURN_IF_ERROR(writer->Commit());
      offset += part.size();
    }
    return absl::OkStatus();
  }
  absl::StatusOr<v1::DatasetVersion> Finish(const std::string& upload,
                                            const std::string& bytes) {
    uint32_t known = 0;
    return uploads->Finish(upload, static_cast<int64_t>(bytes.size()),
                           ExtendCrc32c(0, bytes), kCaller, &known);
  }
  // A whole upload to kDataset.
  absl::StatusOr<v1::DatasetVersion> Upload(const std::string& pack,
                                            bool replace = false,
                                            const char* dataset = kDataset) {
    TACTUS_ASSIGN_OR_RETURN(const auto upload,
                            uploads->Create(dataset, "", replace, kCaller));
    TACTUS_RETURN_IF_ERROR(Write(upload.name(), pack, 1 << 20));
    return Finish(upload.name(), pack);
  }

  int64_t time_ms = 1'700'000'000'000;
  ModelRegistry registry;
  std::unique_ptr<DataDirectory> data;
  std::unique_ptr<DatasetStore> datasets;
  std::unique_ptr<UploadStore> uploads;
  std::unique_ptr<OperationStore> operations;
  std::unique_ptr<ModelStore> models;
};

}  // namespace tactus::internal::server
