// File: copy_mark.h
//
// The mark of a catalogue into which another one is being copied. While it is
// there, servers refuse the catalogue. It also fences copies: what one writes
// counts only while the mark is its own.
//
//   const CopyMark mark = {.source = id, .run = run};
//   TACTUS_RETURN_IF_ERROR(PutCopyMark(change, mark));
//   TACTUS_RETURN_IF_ERROR(CheckCopyMark(change, mark));   // in later changes
//   TACTUS_RETURN_IF_ERROR(EndCopy(change, mark));
//
// Thread-safe: free functions without state.
#pragma once

#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/store/catalog.h"

namespace tactus::internal {

struct CopyMark {
  // The id of the data that is copied (directory_identity.h).
  std::string source;
  // Another one for each run of the copy.
  std::string run;
};

// Nothing without a mark.
absl::StatusOr<std::optional<CopyMark>> ReadCopyMark(const Transaction& look);
absl::Status PutCopyMark(Transaction& change, const CopyMark& mark);

// ABORTED if another run has put its own.
absl::Status CheckCopyMark(const Transaction& look, const CopyMark& mark);

// Removes the mark, and keeps whose copy the catalogue is.
absl::Status EndCopy(Transaction& change, const CopyMark& mark);
// Whose copy the catalogue is; empty if it is none.
absl::StatusOr<std::string> CopiedFrom(const Transaction& look);

// IO if a copy into the catalogue is not finished. `place` names it.
absl::Status RefuseUnfinishedCopy(const Catalog& catalog,
                                  absl::string_view place);

}  // namespace tactus::internal
