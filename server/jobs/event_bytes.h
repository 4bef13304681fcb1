// File: event_bytes.h
//
// EventBytes: the bytes that a job's process writes, cut into JobEvents.
//
//   EventBytes bytes;
//   bytes.Append(read_now);
//   v1::JobEvent event;
//   while (bytes.Take(&event) == EventBytes::Found::kEvent) Use(event);
//
// Holds at most one event that is not complete, and what was appended last. Not
// thread-safe.
#pragma once

#include <string>

#include "absl/strings/string_view.h"
#include "tactus/v1/storage.pb.h"

namespace tactus::internal::server {

class EventBytes {
 public:
  // kGarbage: the bytes are no events, and none will follow.
  enum class Found { kEvent, kNone, kGarbage };

  void Append(absl::string_view bytes) {
    bytes_.append(bytes.data(), bytes.size());
  }
  Found Take(v1::JobEvent* event);
  // Forgets an event that is not complete.
  void Clear() { bytes_.clear(); }

 private:
  std::string bytes_;
};

}  // namespace tactus::internal::server
