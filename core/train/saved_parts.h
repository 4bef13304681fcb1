// File: saved_parts.h
//
// SavedParts: the parts of a fit in a FitJournal, sealed so that a damaged part
// or one of another fit is refused.
//
//   const SavedParts saved(journal, contacts, options);
//   TACTUS_ASSIGN_OR_RETURN(auto mixture, saved.Find<HmmMixture>("hmm/SU"));
//   if (!mixture) {
//     mixture = Train();
//     TACTUS_RETURN_IF_ERROR(saved.Put("hmm/SU", *mixture));
//   }
//
// The bytes of a part are its values (fit_fields.h), the SHA-256 of the fit's
// contacts, options, program version and the part's name, and the SHA-256 of
// all that. Refers to the journal, which may be null. Thread-safe as the
// journal is.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/train/archive.h"
#include "core/train/fit_fields.h"
#include "core/train/fit_journal.h"

namespace tactus::internal {

class SavedParts {
 public:
  // Reads all contacts once unless `journal` is null or keeps no parts.
  SavedParts(FitJournal* journal,
             const std::vector<const LabelledContact*>& contacts,
             const FitOptions& options);

  // Nothing if the part was not put. CHECKPOINT_INVALID for other bytes.
  template <typename T>
  absl::StatusOr<std::optional<T>> Find(absl::string_view part) const {
    TACTUS_ASSIGN_OR_RETURN(const auto payload, FindBytes(part));
    if (!payload) return std::optional<T>();
    ByteReader reader(*payload);
    T value;
    reader(value);
    if (!reader.AtEnd()) {
      return CheckpointInvalid(part, "its values do not fill it");
    }
    return std::optional<T>(std::move(value));
  }
  template <typename T>
  absl::Status Put(absl::string_view part, const T& value) const {
    if (journal_ == nullptr) return absl::OkStatus();
    ByteWriter writer;
    writer(value);
    return PutBytes(part, writer.Take());
  }

 private:
  absl::StatusOr<std::optional<std::string>> FindBytes(
      absl::string_view part) const;
  absl::Status PutBytes(absl::string_view part, std::string payload) const;
  // What the part belongs to.
  std::string OwnerOf(absl::string_view part) const;

  FitJournal* const journal_;
  std::string fit_;  // SHA-256 of contacts, options and version
};

}  // namespace tactus::internal
