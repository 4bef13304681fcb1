#include "core/base/errors.h"

#include <algorithm>

#include "absl/strings/cord.h"
#include "absl/strings/str_join.h"
#include "core/base/serialize.h"
#include "core/base/text.h"

namespace tactus::internal {
namespace {

// Standard tools look for this type in grpc-status-details-bin.
constexpr char kTypeUrl[] = "type.googleapis.com/google.rpc.ErrorInfo";
constexpr absl::string_view kPrefix = "ERROR_REASON_";

using absl::StatusCode;

}  // namespace

absl::Status MakeError(StatusCode code, v1::ErrorReason reason,
                       absl::string_view message,
                       const ErrorMetadata& metadata) {
  v1::ErrorInfo info;
  info.set_reason(v1::ErrorReason_Name(reason).substr(kPrefix.size()));
  info.set_domain("tactus");
  for (const auto& [key, value] : metadata) {
    (*info.mutable_metadata())[key] = Printable(value);
  }
  absl::Status status(code, Printable(message));
  status.SetPayload(kTypeUrl, absl::Cord(SerializeDeterministic(info)));
  return status;
}

v1::ErrorInfo InfoOf(const absl::Status& status) {
  v1::ErrorInfo info;
  if (auto payload = status.GetPayload(kTypeUrl)) {
    if (!info.ParseFromString(std::string(*payload))) info.Clear();
  }
  return info;
}

std::string ReasonOf(const absl::Status& status) {
  return InfoOf(status).reason();
}

absl::Status Annotate(const absl::Status& status, absl::string_view context) {
  if (status.ok()) return status;
  absl::Status annotated(status.code(),
                         absl::StrCat(context, ": ", status.message()));
  status.ForEachPayload([&](absl::string_view type, const absl::Cord& payload) {
    annotated.SetPayload(type, payload);
  });
  return annotated;
}

absl::Status Advise(const absl::Status& status, absl::string_view advice) {
  if (status.ok()) return status;
  absl::Status advised(status.code(),
                       Printable(absl::StrCat(status.message(), "; ", advice)));
  status.ForEachPayload([&](absl::string_view type, const absl::Cord& payload) {
    advised.SetPayload(type, payload);
  });
  return advised;
}

std::string NameSome(const std::vector<std::string>& names) {
  constexpr size_t kNamed = 8;
  std::vector<std::string> some(names.begin(),
                                names.begin() + std::min(names.size(), kNamed));
  for (std::string& name : some) name = Printable(name);
  std::string text = absl::StrJoin(some, ", ");
  if (names.size() > kNamed) {
    absl::StrAppend(&text, " and ", names.size() - kNamed, " more");
  }
  return text;
}

absl::Status InvalidValue(v1::ErrorReason reason, absl::string_view what,
                          absl::string_view got, absl::string_view want) {
  return MakeError(StatusCode::kInvalidArgument, reason,
                   absl::StrCat(what, " is ", got, "; it must be ", want),
                   {{"field", std::string(what)},
                    {"value", std::string(got)},
                    {"expected", std::string(want)}});
}

absl::Status InvalidTrainingData(absl::string_view message) {
  return MakeError(StatusCode::kFailedPrecondition,
                   v1::ERROR_REASON_INVALID_TRAINING_DATA, message);
}

absl::Status NumericalFailure(absl::string_view message) {
  return MakeError(StatusCode::kInternal, v1::ERROR_REASON_NUMERICAL_FAILURE,
                   message);
}

absl::Status WorkCancelled(absl::string_view work) {
  return MakeError(StatusCode::kCancelled, v1::ERROR_REASON_CANCELLED,
                   absl::StrCat(work, " was cancelled"));
}

absl::Status CheckpointInvalid(absl::string_view part,
                               absl::string_view message) {
  return MakeError(StatusCode::kDataLoss, v1::ERROR_REASON_CHECKPOINT_INVALID,
                   absl::StrCat("saved part ", part, ": ", message,
                                "; train again, from the beginning"),
                   {{"part", std::string(part)}});
}

absl::Status IoError(absl::string_view path, absl::string_view message) {
  return MakeError(StatusCode::kUnavailable, v1::ERROR_REASON_IO,
                   absl::StrCat(path, ": ", message),
                   {{"path", std::string(path)}});
}

absl::Status TrialFileInvalid(absl::string_view path,
                              absl::string_view message) {
  return MakeError(
      StatusCode::kInvalidArgument, v1::ERROR_REASON_TRIAL_FILE_INVALID,
      absl::StrCat(path, ": ", message), {{"path", std::string(path)}});
}

absl::Status BundleCorrupt(absl::string_view message) {
  return MakeError(StatusCode::kDataLoss, v1::ERROR_REASON_BUNDLE_CORRUPT,
                   absl::StrCat("model bundle is corrupt: ", message,
                                "; copy it again from where it is whole, or "
                                "fit it again"));
}

absl::Status BundleVersion(uint32_t got, uint32_t want) {
  return MakeError(
      StatusCode::kFailedPrecondition, v1::ERROR_REASON_BUNDLE_VERSION,
      absl::StrCat("model bundle has format version ", got,
                   "; this program reads versions 1 to ", want,
                   "; install the program that wrote it, or fit the model "
                   "again with this one"),
      {{"value", absl::StrCat(got)}, {"expected", absl::StrCat(want)}});
}

absl::Status ConfigRequired() {
  return MakeError(StatusCode::kInvalidArgument,
                   v1::ERROR_REASON_CONFIG_REQUIRED,
                   "the first message of a stream is not config; send config "
                   "first, then frames");
}

absl::Status ConfigRepeated() {
  return MakeError(StatusCode::kInvalidArgument,
                   v1::ERROR_REASON_CONFIG_REPEATED,
                   "config was sent a second time; open a new stream instead");
}

absl::Status EmptyRequest() {
  return MakeError(StatusCode::kInvalidArgument, v1::ERROR_REASON_EMPTY_REQUEST,
                   "a request is empty; it must hold config, frames or "
                   "end_of_trial");
}

absl::Status MalformedRequest(size_t bytes) {
  return MakeError(StatusCode::kInvalidArgument,
                   v1::ERROR_REASON_MALFORMED_REQUEST,
                   absl::StrCat("a request of ", bytes,
                                " bytes is not a ClassifyContactRequest; build "
                                "the client from proto/tactus/v1"),
                   {{"value", absl::StrCat(bytes)}});
}

absl::Status NotTheRequest(absl::string_view type, absl::string_view fault) {
  return MakeError(
      StatusCode::kInvalidArgument, v1::ERROR_REASON_MALFORMED_REQUEST,
      absl::StrCat("the request is not a ", type, ": ", fault,
                   "; use a client of the server's release, or a newer server"),
      {{"type", std::string(type)}});
}

absl::Status StreamFinished() {
  return MakeError(StatusCode::kFailedPrecondition,
                   v1::ERROR_REASON_STREAM_FINISHED,
                   "the stream has ended; open a new one");
}

absl::Status UnknownLayout(absl::string_view name, absl::string_view presets) {
  return MakeError(
      StatusCode::kInvalidArgument, v1::ERROR_REASON_UNKNOWN_LAYOUT,
      absl::StrCat("layout ", Quoted(name), " is not a preset (", presets,
                   "); describe it in full, with rows and columns"),
      {{"field", "geometry.layout"},
       {"value", std::string(name)},
       {"expected", std::string(presets)}});
}

absl::Status MessageTooLarge(size_t got, size_t limit) {
  return MakeError(
      StatusCode::kInvalidArgument, v1::ERROR_REASON_MESSAGE_TOO_LARGE,
      absl::StrCat("message has ", got, " bytes; it must have at most ", limit,
                   ": send fewer frames in each"),
      {{"value", absl::StrCat(got)}, {"limit", absl::StrCat(limit)}});
}

absl::Status FrameCountOutOfRange(uint64_t got, uint64_t limit) {
  return MakeError(
      StatusCode::kInvalidArgument, v1::ERROR_REASON_FRAME_COUNT_OUT_OF_RANGE,
      absl::StrCat("frame_count is ", got, "; it must be 1 to ", limit),
      {{"value", absl::StrCat(got)}, {"limit", absl::StrCat(limit)}});
}

absl::Status FrameSizeMismatch(uint64_t sequence, absl::string_view field,
                               size_t got, size_t want) {
  return MakeError(StatusCode::kInvalidArgument,
                   v1::ERROR_REASON_FRAME_SIZE_MISMATCH,
                   absl::StrCat(field, " of the message at sequence ", sequence,
                                " has size ", got, "; it must be ", want),
                   {{"sequence", absl::StrCat(sequence)},
                    {"field", std::string(field)},
                    {"value", absl::StrCat(got)},
                    {"expected", absl::StrCat(want)}});
}

absl::Status NonFiniteTaxel(uint64_t sequence, int taxel) {
  return MakeError(
      StatusCode::kInvalidArgument, v1::ERROR_REASON_NON_FINITE_TAXEL,
      absl::StrCat("taxel ", taxel, " of frame ", sequence,
                   " is not finite; mask dead taxels instead"),
      {{"sequence", absl::StrCat(sequence)}, {"taxel", absl::StrCat(taxel)}});
}

absl::Status NegativeTaxel(uint64_t sequence, int taxel, double value) {
  return MakeError(StatusCode::kInvalidArgument,
                   v1::ERROR_REASON_NEGATIVE_TAXEL,
                   absl::StrCat("taxel ", taxel, " of frame ", sequence, " is ",
                                value, "; it must be at least 0"),
                   {{"sequence", absl::StrCat(sequence)},
                    {"taxel", absl::StrCat(taxel)},
                    {"value", absl::StrCat(value)}});
}

absl::Status TaxelTooLarge(uint64_t sequence, int taxel, double value) {
  return MakeError(StatusCode::kInvalidArgument,
                   v1::ERROR_REASON_NON_FINITE_TAXEL,
                   absl::StrCat("taxel ", taxel, " of frame ", sequence, " is ",
                                value, "; it must be ",
                                value < 0 ? "at least -1e12" : "at most 1e12"),
                   {{"sequence", absl::StrCat(sequence)},
                    {"taxel", absl::StrCat(taxel)},
                    {"value", absl::StrCat(value)}});
}

absl::Status InvalidPose(uint64_t sequence, absl::string_view message) {
  return MakeError(StatusCode::kInvalidArgument, v1::ERROR_REASON_INVALID_POSE,
                   absl::StrCat("pose of frame ", sequence, ": ", message),
                   {{"sequence", absl::StrCat(sequence)}});
}

absl::Status SequenceRegression(uint64_t got, uint64_t last) {
  return MakeError(
      StatusCode::kOutOfRange, v1::ERROR_REASON_SEQUENCE_REGRESSION,
      absl::StrCat("first_sequence is ", got, "; it must be above ", last),
      {{"value", absl::StrCat(got)}, {"last", absl::StrCat(last)}});
}

absl::Status TimeRegression(uint64_t sequence, int64_t got, int64_t last) {
  return MakeError(StatusCode::kOutOfRange, v1::ERROR_REASON_TIME_REGRESSION,
                   absl::StrCat("capture time of frame ", sequence, " is ", got,
                                " ns; it must be above ", last, " ns"),
                   {{"sequence", absl::StrCat(sequence)},
                    {"value", absl::StrCat(got)},
                    {"last", absl::StrCat(last)}});
}

absl::Status InvalidSparseIndex(uint64_t sequence, uint32_t index,
                                absl::string_view want) {
  return MakeError(
      StatusCode::kInvalidArgument, v1::ERROR_REASON_INVALID_SPARSE_INDEX,
      absl::StrCat("sparse index ", index, " of frame ", sequence, " must be ",
                   want),
      {{"sequence", absl::StrCat(sequence)}, {"value", absl::StrCat(index)}});
}

absl::Status GeometryMismatch(absl::string_view got, absl::string_view want) {
  return MakeError(
      StatusCode::kFailedPrecondition, v1::ERROR_REASON_GEOMETRY_MISMATCH,
      absl::StrCat("the stream's skin is ", got,
                   "; it must be that of the model's training data, ", want),
      {{"value", std::string(got)}, {"expected", std::string(want)}});
}

absl::Status ModelNotFound(absl::string_view name,
                           const std::vector<std::string>& known) {
  return MakeError(
      StatusCode::kNotFound, v1::ERROR_REASON_MODEL_NOT_FOUND,
      absl::StrCat("model ", Quoted(name), " does not exist; ",
                   known.empty()
                       ? "train one with trainctl train, or start the server "
                         "with --model=NAME=BUNDLE"
                       : absl::StrCat("there is ", NameSome(known))),
      {{"model", std::string(name)}});
}

absl::Status StreamLimit(absl::string_view what, int limit) {
  return MakeError(StatusCode::kResourceExhausted,
                   v1::ERROR_REASON_STREAM_LIMIT,
                   absl::StrCat("the server already serves ", limit, " ", what,
                                ", its limit; end one, try again later, or "
                                "start the server with a higher limit"),
                   {{"limit", absl::StrCat(limit)}});
}

absl::Status PeerStreamLimit(absl::string_view what, absl::string_view peer,
                             int limit) {
  return MakeError(
      StatusCode::kResourceExhausted, v1::ERROR_REASON_STREAM_LIMIT,
      absl::StrCat("the server already serves ", limit, " ", what, " of ", peer,
                   ", the limit of one peer; end one of these first, or start "
                   "the server with a higher limit"),
      {{"limit", absl::StrCat(limit)}, {"peer", std::string(peer)}});
}

absl::Status Draining() {
  return MakeError(StatusCode::kUnavailable, v1::ERROR_REASON_DRAINING,
                   "the server is shutting down; use another or try later");
}

absl::Status StreamIdle(int timeout_ms) {
  return MakeError(StatusCode::kDeadlineExceeded, v1::ERROR_REASON_STREAM_IDLE,
                   absl::StrCat("nothing arrived for ", timeout_ms,
                                " ms; send frames also while nothing touches, "
                                "or open a stream when there are some"),
                   {{"limit", absl::StrCat(timeout_ms)}});
}

absl::Status NoFirstMessage(int timeout_ms) {
  return MakeError(StatusCode::kDeadlineExceeded, v1::ERROR_REASON_STREAM_IDLE,
                   absl::StrCat("no config arrived within ", timeout_ms,
                                " ms; send config at once"),
                   {{"limit", absl::StrCat(timeout_ms)}});
}

absl::Status NoDataDirectory() {
  return MakeError(StatusCode::kFailedPrecondition,
                   v1::ERROR_REASON_NO_DATA_DIRECTORY,
                   "the server keeps no data; start it with --data-dir=FOLDER");
}

absl::Status NoContactLog() {
  return MakeError(StatusCode::kFailedPrecondition,
                   v1::ERROR_REASON_NO_CONTACT_LOG,
                   "the server keeps no contacts; start it with "
                   "--data-dir=FOLDER --keep-contacts=SIZE");
}

absl::Status CatalogUnavailable(absl::string_view catalog,
                                absl::string_view error) {
  return MakeError(
      StatusCode::kUnavailable, v1::ERROR_REASON_CATALOG_UNAVAILABLE,
      absl::StrCat("the catalogue ", catalog, " does not answer: ", error,
                   "; try again when the database is there"),
      {{"catalog", std::string(catalog)}});
}

absl::Status TakenOver(absl::string_view what, absl::string_view holder) {
  return MakeError(
      StatusCode::kAborted, v1::ERROR_REASON_CATALOG_UNAVAILABLE,
      absl::StrCat(what, ": this server was silent for too long, and ", holder,
                   " goes on with it; try again"),
      {{"holder", std::string(holder)}});
}

absl::Status InvalidName(absl::string_view name, absl::string_view want) {
  return InvalidValue(v1::ERROR_REASON_INVALID_NAME, "name", Quoted(name),
                      want);
}

absl::Status NoSuch(v1::ErrorReason reason, absl::string_view kind,
                    absl::string_view name, absl::string_view advice) {
  return MakeError(
      StatusCode::kNotFound, reason,
      absl::StrCat(kind, " ", Quoted(name), " does not exist; ", advice),
      {{std::string(kind), std::string(name)}});
}

absl::Status DatasetExists(absl::string_view name) {
  return MakeError(StatusCode::kAlreadyExists, v1::ERROR_REASON_DATASET_EXISTS,
                   absl::StrCat(name,
                                " exists already; choose another name, or add "
                                "trials to it with trainctl datasets upload"),
                   {{"dataset", std::string(name)}});
}

absl::Status DatasetInUse(absl::string_view name, absl::string_view user) {
  return MakeError(
      StatusCode::kFailedPrecondition, v1::ERROR_REASON_DATASET_IN_USE,
      absl::StrCat(name, " cannot be deleted, because ", user,
                   " refers to it; wait until that has ended, or let it refer "
                   "to another dataset"),
      {{"dataset", std::string(name)}, {"user", std::string(user)}});
}

absl::Status ModelInUse(absl::string_view name, absl::string_view user) {
  return MakeError(
      StatusCode::kFailedPrecondition, v1::ERROR_REASON_MODEL_IN_USE,
      absl::StrCat(name, " cannot be deleted, because ", user,
                   " refers to it; let that name other versions first, with "
                   "trainctl models promote"),
      {{"model", std::string(name)}, {"user", std::string(user)}});
}

absl::Status OperationActive(absl::string_view name) {
  return MakeError(StatusCode::kFailedPrecondition,
                   v1::ERROR_REASON_OPERATION_ACTIVE,
                   absl::StrCat(name,
                                " has not ended; cancel it first "
                                "(trainctl jobs cancel), or wait for its end"),
                   {{"name", std::string(name)}});
}

absl::Status UploadBusy(absl::string_view name) {
  return MakeError(StatusCode::kAborted, v1::ERROR_REASON_UPLOAD_BUSY,
                   absl::StrCat("another call writes to ", name,
                                "; end that call, or try again later"),
                   {{"upload", std::string(name)}});
}

absl::Status OffsetMismatch(int64_t got, int64_t committed) {
  return MakeError(StatusCode::kFailedPrecondition,
                   v1::ERROR_REASON_OFFSET_MISMATCH,
                   absl::StrCat("write_offset is ", got, "; the upload has ",
                                committed, " bytes, so it must be ", committed),
                   {{"write_offset", absl::StrCat(got)},
                    {"committed_size", absl::StrCat(committed)}});
}

absl::Status ChecksumMismatch(absl::string_view what, absl::string_view got,
                              absl::string_view want) {
  return MakeError(StatusCode::kInvalidArgument,
                   v1::ERROR_REASON_CHECKSUM_MISMATCH,
                   absl::StrCat(what, " has checksum ", got, "; it must have ",
                                want, ", as announced: send it again"),
                   {{"got", std::string(got)}, {"want", std::string(want)}});
}

absl::Status InvalidTrial(absl::string_view message) {
  return MakeError(StatusCode::kInvalidArgument, v1::ERROR_REASON_INVALID_TRIAL,
                   message);
}

absl::Status JobLimit(int limit) {
  return MakeError(
      StatusCode::kResourceExhausted, v1::ERROR_REASON_JOB_LIMIT,
      absl::StrCat("the server already has ", limit,
                   " queued jobs, its limit; wait until one has ended, or "
                   "cancel one with trainctl jobs cancel"),
      {{"limit", absl::StrCat(limit)}});
}

absl::Status DownloadLimit(int64_t limit) {
  return MakeError(
      StatusCode::kResourceExhausted, v1::ERROR_REASON_STREAM_LIMIT,
      absl::StrCat("the downloads that run hold the ", limit,
                   " bytes of memory that all may hold together; wait until "
                   "one has ended, then try again"),
      {{"limit", absl::StrCat(limit)}});
}

absl::Status QuotaExceeded(absl::string_view client, absl::string_view quota,
                           int64_t limit, int64_t use,
                           absl::string_view advice) {
  return MakeError(
      StatusCode::kResourceExhausted, v1::ERROR_REASON_QUOTA_EXCEEDED,
      absl::StrCat("the quota of ", quota, " of ", client, " is ", limit,
                   ", and ", use, " are in use; ", advice,
                   ", or ask the people who run the server for a larger quota"),
      {{"quota", std::string(quota)},
       {"limit", absl::StrCat(limit)},
       {"use", absl::StrCat(use)},
       {"client", std::string(client)}});
}

absl::Status JobCrashed(absl::string_view message) {
  return MakeError(StatusCode::kInternal, v1::ERROR_REASON_JOB_CRASHED,
                   message);
}

absl::Status EtagMismatch(absl::string_view name, absl::string_view got,
                          absl::string_view want) {
  return MakeError(StatusCode::kAborted, v1::ERROR_REASON_ETAG_MISMATCH,
                   absl::StrCat(name, " has changed: the request has etag ",
                                Quoted(got), ", the alias has ", Quoted(want),
                                "; look at it with trainctl models alias, then "
                                "repeat the request with the new etag"),
                   {{"got", std::string(got)}, {"want", std::string(want)}});
}

absl::Status NothingToRollBack(absl::string_view alias) {
  return MakeError(StatusCode::kFailedPrecondition,
                   v1::ERROR_REASON_NOTHING_TO_ROLL_BACK,
                   absl::StrCat(alias,
                                " has named no other version before; let it "
                                "name one with trainctl models promote"),
                   {{"alias", std::string(alias)}});
}

absl::Status GateNotPassed(absl::string_view message) {
  return MakeError(StatusCode::kFailedPrecondition,
                   v1::ERROR_REASON_GATE_NOT_PASSED, message);
}

absl::Status DataLost(absl::string_view path, absl::string_view message) {
  return MakeError(StatusCode::kDataLoss, v1::ERROR_REASON_DATA_LOST,
                   absl::StrCat(path, ": ", message),
                   {{"path", std::string(path)}});
}

absl::Status StorageFull(absl::string_view path, absl::string_view message) {
  return MakeError(
      StatusCode::kResourceExhausted, v1::ERROR_REASON_STORAGE_FULL,
      absl::StrCat(path, ": ", message), {{"path", std::string(path)}});
}

absl::Status Unauthenticated(absl::string_view message) {
  return MakeError(StatusCode::kUnauthenticated,
                   v1::ERROR_REASON_UNAUTHENTICATED, message);
}

absl::Status PermissionDenied(absl::string_view method, absl::string_view role,
                              absl::string_view want) {
  return MakeError(
      StatusCode::kPermissionDenied, v1::ERROR_REASON_PERMISSION_DENIED,
      absl::StrCat(method, " needs the role ", want, "; the caller has ", role,
                   "; use a token that was made with trainctl tokens create "
                   "--role=",
                   want),
      {{"role", std::string(role)}, {"want", std::string(want)}});
}

absl::Status NotOwner(absl::string_view name, absl::string_view owner) {
  return MakeError(
      StatusCode::kPermissionDenied, v1::ERROR_REASON_PERMISSION_DENIED,
      absl::StrCat(name, " belongs to ", Quoted(owner),
                   "; ask that client, or call as an admin"),
      {{"name", std::string(name)}, {"owner", std::string(owner)}});
}

absl::Status InvalidResponse(absl::string_view what, absl::string_view got,
                             absl::string_view want) {
  return MakeError(StatusCode::kInternal, v1::ERROR_REASON_INVALID_RESPONSE,
                   absl::StrCat("the server sent an invalid response: ", what,
                                " is ", got, "; it must be ", want,
                                "; install the same version on both sides"),
                   {{"field", std::string(what)},
                    {"value", std::string(got)},
                    {"expected", std::string(want)}});
}

absl::Status NoResponse(absl::string_view request, int64_t timeout_ms) {
  return MakeError(
      StatusCode::kDeadlineExceeded, v1::ERROR_REASON_NO_RESPONSE,
      absl::StrCat("the server did not respond to ", request, " within ",
                   timeout_ms,
                   " ms; check that it runs, and its load, or try again"),
      {{"value", std::string(request)}, {"limit", absl::StrCat(timeout_ms)}});
}

absl::Status NotResumed(int64_t limit_ms, const absl::Status& last) {
  return MakeError(
      StatusCode::kDeadlineExceeded, v1::ERROR_REASON_NO_RESPONSE,
      absl::StrCat("the stream could not be resumed within ", limit_ms,
                   " ms; the last attempt ended with: ", last.message(),
                   "; start the server or check its address, then open a new "
                   "stream"),
      {{"value", "a lost stream"}, {"limit", absl::StrCat(limit_ms)}});
}

absl::Status BundleChanged(absl::string_view version, absl::string_view got,
                           absl::string_view want) {
  return MakeError(
      StatusCode::kFailedPrecondition, v1::ERROR_REASON_MODEL_NOT_FOUND,
      absl::StrCat("the server's bundle of ", version, " has the SHA-256 ", got,
                   "; the stream began with ", want, "; open a new stream"),
      {{"model", std::string(version)},
       {"value", std::string(got)},
       {"expected", std::string(want)}});
}

}  // namespace tactus::internal
