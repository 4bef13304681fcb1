// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
#include <string>

#include "core/base/status_macros.h"
#include "server/contact_log/record_frame.h"
#include "server/contact_log/record_ring.h"
#include "server/contact_log/segment_scan.h"

namespace tactus::internal::server::examples {

static void Use(uint64_t) {}

static void RecordFrameExample(uint64_t first_id, const std::string& record) {
#include "server/contact_log/record_frame.h.inc"
}

static absl::Status SegmentScanExample() {
#include "server/contact_log/segment_scan.h.inc"
  return absl::OkStatus();
}

static absl::Status RecordRingExample(const std::string& bytes) {
#include "server/contact_log/record_ring.h.inc"
  return absl::OkStatus();
}

}  // namespace tactus::internal::server::examples
