// File: errors.h
//
// Every error that crosses a border of Tactus is made here: an absl::Status
// that carries one tactus.v1.ErrorInfo with a stable reason. The text names
// the thing that was wrong, its value and what would be right.
//
//   return InvalidConfig("sample_rate_hz", rate, "above 0 and at most 10000");
//
// Thread-safe: free functions without state.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "tactus/v1/common.pb.h"

namespace tactus::internal {

using ErrorMetadata = std::vector<std::pair<std::string, std::string>>;

// Makes a status of `code` whose payload is ErrorInfo{reason, "tactus",
// metadata}. Message and metadata become one line of UTF-8 each (text.h), so
// that values from files and messages can be quoted in them.
absl::Status MakeError(absl::StatusCode code, v1::ErrorReason reason,
                       absl::string_view message,
                       const ErrorMetadata& metadata = {});

// The reason of an error made here, e.g. "CONFIG_REQUIRED"; empty for others.
std::string ReasonOf(const absl::Status& status);

// The ErrorInfo of an error made here; an empty one for others.
v1::ErrorInfo InfoOf(const absl::Status& status);

// The same error with "context: " before its text; OK stays OK.
absl::Status Annotate(const absl::Status& status, absl::string_view context);

// The same error with "; advice" after its text; OK stays OK.
absl::Status Advise(const absl::Status& status, absl::string_view advice);

// "a, b, c": the first eight names, and how many more there are.
std::string NameSome(const std::vector<std::string>& names);

// INVALID_ARGUMENT: `what` has value `got`, `want` would be right.
absl::Status InvalidValue(v1::ErrorReason reason, absl::string_view what,
                          absl::string_view got, absl::string_view want);

template <typename Value>
absl::Status InvalidValue(v1::ErrorReason reason, absl::string_view what,
                          const Value& got, absl::string_view want) {
  return InvalidValue(reason, what, absl::string_view(absl::StrCat(got)), want);
}

template <typename Value>
absl::Status InvalidConfig(absl::string_view field, const Value& got,
                           absl::string_view want) {
  return InvalidValue(v1::ERROR_REASON_INVALID_CONFIG, field, got, want);
}

template <typename Value>
absl::Status InvalidModel(absl::string_view what, const Value& got,
                          absl::string_view want) {
  return InvalidValue(v1::ERROR_REASON_INVALID_MODEL, what, got, want);
}

template <typename Value>
absl::Status InvalidScene(absl::string_view what, const Value& got,
                          absl::string_view want) {
  return InvalidValue(v1::ERROR_REASON_INVALID_SCENE, what, got, want);
}

absl::Status InvalidTrainingData(absl::string_view message);
absl::Status NumericalFailure(absl::string_view message);
// CANCELLED: `work` names what was cancelled, e.g. "the fit".
absl::Status WorkCancelled(absl::string_view work);
// DATA_LOSS: `part` names the saved part of a training.
absl::Status CheckpointInvalid(absl::string_view part,
                               absl::string_view message);
absl::Status IoError(absl::string_view path, absl::string_view message);
absl::Status TrialFileInvalid(absl::string_view path,
                              absl::string_view message);
absl::Status BundleCorrupt(absl::string_view message);
absl::Status BundleVersion(uint32_t got, uint32_t want);

// Stream contract.
absl::Status ConfigRequired();
absl::Status ConfigRepeated();
absl::Status EmptyRequest();
absl::Status MalformedRequest(size_t bytes);
// MALFORMED_REQUEST: `type` is the full name of the message that was expected.
absl::Status NotTheRequest(absl::string_view type, absl::string_view fault);
absl::Status StreamFinished();
// `presets`: the names of all presets, for the text.
absl::Status UnknownLayout(absl::string_view name, absl::string_view presets);
absl::Status MessageTooLarge(size_t got, size_t limit);
absl::Status FrameCountOutOfRange(uint64_t got, uint64_t limit);
absl::Status FrameSizeMismatch(uint64_t sequence, absl::string_view field,
                               size_t got, size_t want);
absl::Status NonFiniteTaxel(uint64_t sequence, int taxel);
absl::Status NegativeTaxel(uint64_t sequence, int taxel, double value);
absl::Status TaxelTooLarge(uint64_t sequence, int taxel, double value);
absl::Status InvalidPose(uint64_t sequence, absl::string_view message);
absl::Status SequenceRegression(uint64_t got, uint64_t last);
absl::Status TimeRegression(uint64_t sequence, int64_t got, int64_t last);
absl::Status InvalidSparseIndex(uint64_t sequence, uint32_t index,
                                absl::string_view want);
absl::Status GeometryMismatch(absl::string_view got, absl::string_view want);

// Server.
// `known`: names that would have been right, the likeliest first.
absl::Status ModelNotFound(absl::string_view name,
                           const std::vector<std::string>& known = {});
// `what` names the calls that are limited, e.g. "streams".
absl::Status StreamLimit(absl::string_view what, int limit);
absl::Status PeerStreamLimit(absl::string_view what, absl::string_view peer,
                             int limit);
absl::Status Draining();
absl::Status StreamIdle(int timeout_ms);
absl::Status NoFirstMessage(int timeout_ms);

// Storage and jobs. `what` and `name` say which thing was wrong.
absl::Status NoDataDirectory();
absl::Status NoContactLog();
// `catalog`: its address without a password; `error`: what came instead of an
// answer.
absl::Status CatalogUnavailable(absl::string_view catalog,
                                absl::string_view error);
// ABORTED: this server was taken for dead, and `holder` goes on with `what`.
absl::Status TakenOver(absl::string_view what, absl::string_view holder);
absl::Status InvalidName(absl::string_view name, absl::string_view want);
// NOT_FOUND with one of the reasons that end in _NOT_FOUND; `kind` is the word
// for the thing, e.g. "dataset", and `advice` what to do, e.g. "trainctl
// datasets list shows those that do".
absl::Status NoSuch(v1::ErrorReason reason, absl::string_view kind,
                    absl::string_view name, absl::string_view advice);
absl::Status DatasetExists(absl::string_view name);
absl::Status DatasetInUse(absl::string_view name, absl::string_view user);
absl::Status ModelInUse(absl::string_view name, absl::string_view user);
absl::Status UploadBusy(absl::string_view name);
absl::Status OperationActive(absl::string_view name);
absl::Status OffsetMismatch(int64_t got, int64_t committed);
absl::Status ChecksumMismatch(absl::string_view what, absl::string_view got,
                              absl::string_view want);
absl::Status InvalidTrial(absl::string_view message);
absl::Status JobLimit(int limit);
// `limit` in bytes.
absl::Status DownloadLimit(int64_t limit);
// `quota` names what is limited, e.g. "stored bytes"; `use` is what the client
// has already, and `advice` what makes room.
absl::Status QuotaExceeded(absl::string_view client, absl::string_view quota,
                           int64_t limit, int64_t use,
                           absl::string_view advice);
absl::Status JobCrashed(absl::string_view message);
absl::Status EtagMismatch(absl::string_view name, absl::string_view got,
                          absl::string_view want);
absl::Status NothingToRollBack(absl::string_view alias);
absl::Status GateNotPassed(absl::string_view message);
absl::Status DataLost(absl::string_view path, absl::string_view message);
absl::Status StorageFull(absl::string_view path, absl::string_view message);
absl::Status Unauthenticated(absl::string_view message);
absl::Status PermissionDenied(absl::string_view method, absl::string_view role,
                              absl::string_view want);
// PERMISSION_DENIED: the thing belongs to another client, and the caller is no
// admin.
absl::Status NotOwner(absl::string_view name, absl::string_view owner);

// Client. INTERNAL: a response breaks the contract.
absl::Status InvalidResponse(absl::string_view what, absl::string_view got,
                             absl::string_view want);

template <typename Value>
absl::Status InvalidResponse(absl::string_view what, const Value& got,
                             absl::string_view want) {
  return InvalidResponse(what, absl::string_view(absl::StrCat(got)), want);
}

// DEADLINE_EXCEEDED: the server did not respond to `request` in time.
absl::Status NoResponse(absl::string_view request, int64_t timeout_ms);

// DEADLINE_EXCEEDED: a lost stream could not be resumed in time. `last` is the
// error of the last attempt.
absl::Status NotResumed(int64_t limit_ms, const absl::Status& last);

// FAILED_PRECONDITION: the server has another bundle under the name of the
// version that the stream began with.
absl::Status BundleChanged(absl::string_view version, absl::string_view got,
                           absl::string_view want);

}  // namespace tactus::internal
