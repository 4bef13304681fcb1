#include "core/store/copy_mark.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

// Keys of Table::kDirectory.
constexpr char kCopying[] = "copying";
constexpr char kCopiedFrom[] = "copied_from";

}  // namespace

absl::StatusOr<std::optional<CopyMark>> ReadCopyMark(const Transaction& look) {
  TACTUS_ASSIGN_OR_RETURN(const auto value,
                          look.Get(Table::kDirectory, kCopying));
  if (!value.has_value()) return std::nullopt;
  const std::pair<std::string, std::string> words =
      absl::StrSplit(*value, absl::MaxSplits(' ', 1));
  return CopyMark{.source = words.first, .run = words.second};
}

absl::Status PutCopyMark(Transaction& change, const CopyMark& mark) {
  return change.Put(Table::kDirectory, kCopying,
                    absl::StrCat(mark.source, " ", mark.run));
}

absl::Status CheckCopyMark(const Transaction& look, const CopyMark& mark) {
  TACTUS_ASSIGN_OR_RETURN(const auto found, ReadCopyMark(look));
  if (found.has_value() && found->source == mark.source &&
      found->run == mark.run) {
    return absl::OkStatus();
  }
  return MakeError(absl::StatusCode::kAborted, v1::ERROR_REASON_IO,
                   found.has_value()
                       ? "another run of the copy goes on with it"
                       : "another run of the copy has finished it");
}

absl::Status EndCopy(Transaction& change, const CopyMark& mark) {
  TACTUS_RETURN_IF_ERROR(CheckCopyMark(change, mark));
  TACTUS_RETURN_IF_ERROR(
      change.Put(Table::kDirectory, kCopiedFrom, mark.source));
  return change.Erase(Table::kDirectory, kCopying);
}

absl::StatusOr<std::string> CopiedFrom(const Transaction& look) {
  TACTUS_ASSIGN_OR_RETURN(const auto value,
                          look.Get(Table::kDirectory, kCopiedFrom));
  return value.value_or("");
}

absl::Status RefuseUnfinishedCopy(const Catalog& catalog,
                                  absl::string_view place) {
  return catalog.Look([&](const Transaction& look) -> absl::Status {
    TACTUS_ASSIGN_OR_RETURN(const auto mark, ReadCopyMark(look));
    if (!mark.has_value()) return absl::OkStatus();
    return IoError(place,
                   "a copy into it is not finished. Run the same trainctl "
                   "catalog copy again: it goes on where it was");
  });
}

}  // namespace tactus::internal
