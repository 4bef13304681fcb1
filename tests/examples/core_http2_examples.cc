// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
#include <functional>
#include <span>

#include "core/connections/vetted_connections.h"
#include "core/http2/http2_vet.h"
#include "core/http2/token_bucket.h"
#include "server/ops/alarm_clock.h"
#include "server/ops/clock.h"

namespace tactus::internal::server::examples {

static void Http2VetExample(
    std::span<const uint8_t> bytes,
    std::function<void(absl::string_view)> CloseConnection) {
#include "core/http2/http2_vet.h.inc"
}

static void TokenBucketExample(
    int64_t now_ns, std::function<void(absl::string_view)> CloseConnection) {
#include "core/http2/token_bucket.h.inc"
}

static void VettedConnectionsExample(int fd,
                                     void (*LogFault)(int, absl::string_view)) {
#include "core/connections/vetted_connections.h.inc"
}

struct ExampleConnections {
  void CutOff();
};

static void AlarmClockExample(std::chrono::system_clock::time_point deadline,
                              ExampleConnections& connections,
                              std::function<void()> WaitForTheRest) {
#include "server/ops/alarm_clock.h.inc"
}

}  // namespace tactus::internal::server::examples
