#include "server/jobs/event_bytes.h"

#include <cstring>

#include "core/base/limits.h"

namespace tactus::internal::server {

EventBytes::Found EventBytes::Take(v1::JobEvent* event) {
  uint32_t length = 0;
  if (bytes_.size() < sizeof length) return Found::kNone;
  std::memcpy(&length, bytes_.data(), sizeof length);
  if (length > limits::kMaxJobEventBytes) return Found::kGarbage;
  if (bytes_.size() < sizeof length + length) return Found::kNone;
  const bool parsed = event->ParseFromArray(bytes_.data() + sizeof length,
                                            static_cast<int>(length));
  bytes_.erase(0, sizeof length + length);
  return parsed ? Found::kEvent : Found::kGarbage;
}

}  // namespace tactus::internal::server
