#include "server/records/spool.h"

#include <atomic>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"

namespace tactus::internal::server {

absl::StatusOr<std::unique_ptr<Spool>> Spool::Create(
    const DataDirectory& data) {
  static std::atomic<uint64_t> count = 0;
  std::string path =
      absl::StrCat(data.BlobFolder(), "/drafts/spool-", count.fetch_add(1));
  TACTUS_ASSIGN_OR_RETURN(auto file, data.files().Append(path));
  return std::unique_ptr<Spool>(
      new Spool(data, std::move(path), std::move(file)));
}

Spool::~Spool() { data_.files().Remove(path_).IgnoreError(); }

absl::Status Spool::Append(absl::string_view bytes) {
  TACTUS_RETURN_IF_ERROR(file_->Append(bytes));
  size_ += static_cast<int64_t>(bytes.size());
  return absl::OkStatus();
}

absl::StatusOr<std::string> Spool::Read() const {
  return data_.files().Read(path_, 0, size_);
}

}  // namespace tactus::internal::server
