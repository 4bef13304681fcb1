// File: trial_pack.h
//
// A trial pack, the content of uploads and downloads: for each trial, the
// length of its serialized TrialRecord as four bytes, little-endian, and then
// the record.
//
//   std::string pack;
//   TACTUS_RETURN_IF_ERROR(AppendToPack(ToRecord(trial), &pack));
//
//   TrialUnpacker unpacker([](const v1::TrialRecord& record) {
//     return Store(record);
//   });
//   TACTUS_RETURN_IF_ERROR(unpacker.Add(pack));  // any part of a pack
//   TACTUS_RETURN_IF_ERROR(unpacker.Finish());
//
// Memory: one record. Not thread-safe.
#pragma once

#include <functional>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "tactus/v1/trial.pb.h"

namespace tactus::client {

// INVALID_TRIAL if the record has 2 GiB or more, which Protocol Buffers cannot
// hold.
absl::Status AppendToPack(const v1::TrialRecord& record, std::string* pack);

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
  const Sink sink_;
  // Bytes of the present record, behind its length.
  std::string pending_;
  uint64_t records_ = 0;
};

}  // namespace tactus::client
