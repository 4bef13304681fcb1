// File: trial_pack.h
//
// A trial pack, the content of uploads and downloads: for each trial, the
// length of its serialized TrialRecord as four bytes, little-endian, and then
// the record (proto/tactus/v1/training.proto).
//
//   std::string pack;
//   TACTUS_RETURN_IF_ERROR(AppendToPack(ToRecord(trial), &pack));
//
//   TrialUnpacker unpacker([](const v1::TrialRecord& record) {
//     return Use(record.id());
//   });
//   TACTUS_RETURN_IF_ERROR(unpacker.Add(pack));  // any part of a pack
//   TACTUS_RETURN_IF_ERROR(unpacker.Finish());
//
// An unpacker holds one record. A PackSplitter, for who cannot afford that,
// holds none. Not thread-safe.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "tactus/v1/trial.pb.h"

namespace tactus::internal {

// True for the length of a record that may be in a pack: 1 to
// limits::kMaxTrialRecordBytes.
bool IsRecordLength(int64_t length);

// INVALID_TRIAL if the record is longer than a record may be.
absl::Status AppendToPack(const v1::TrialRecord& record, std::string* pack);

// Finds the records in a pack that comes in any parts.
class PackSplitter {
 public:
  // Bytes of a record.
  struct Part {
    absl::string_view bytes;
    // Where they begin in the record, and the record in the pack.
    int64_t at;
    int64_t record_at;
    int64_t length;

    bool is_last() const {
      return at + static_cast<int64_t>(bytes.size()) == length;
    }
  };

  // Takes the next bytes of the pack. Calls `begin` with the length of each
  // record that begins, which may be any number, and `take` with its parts.
  // Their first error ends it.
  absl::Status Add(absl::string_view bytes,
                   absl::FunctionRef<absl::Status(uint32_t length)> begin,
                   absl::FunctionRef<absl::Status(const Part& part)> take);

  // Empty if the pack may end here; else what is missing.
  std::string EndFault() const;

 private:
  // The length of the present record, as far as it has come.
  std::string head_;
  // Bytes of the present record that were taken, and of the whole pack.
  int64_t arrived_ = 0;
  int64_t taken_ = 0;
};

class TrialUnpacker {
 public:
  // Called for each record; an error ends the unpacking.
  using Sink = std::function<absl::Status(const v1::TrialRecord&)>;

  explicit TrialUnpacker(Sink sink) : sink_(std::move(sink)) {}

  // The next bytes of the pack. INVALID_RESPONSE if they are no trial pack, or
  // the error of the sink.
  absl::Status Add(absl::string_view bytes);
  // INVALID_RESPONSE if the pack ends within a record.
  absl::Status Finish() const;

  uint64_t records() const { return records_; }

 private:
  absl::Status Take(const PackSplitter::Part& part);

  const Sink sink_;
  PackSplitter splitter_;
  // Bytes of the present record, unless they come at once.
  std::string pending_;
  uint64_t records_ = 0;
};

}  // namespace tactus::internal
