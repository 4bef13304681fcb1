// The examples of public headers, as their comments show them. They only have
// to compile; HouseTest.ExamplesAreCompiled compares the texts.
#include <functional>
#include <span>

#include "core/connections/vetted_connections.h"
#include "core/http2/http2_vet.h"
#include "core/http2/token_bucket.h"
#include "server/ops/alarm_clock.h"
#include "server/ops/clock.h"

namespace tactus::server::examples {

void Http2VetExample(std::span<const uint8_t> bytes,
                     std::function<void(absl::string_view)> CloseConnection) {
  Http2Vet vet(Http2Vet::Peer::kClient);
  const absl::string_view fault = vet.Check(bytes, MonotonicNs());
  if (!fault.empty()) CloseConnection(fault);
}

void TokenBucketExample(
    int64_t now_ns, std::function<void(absl::string_view)> CloseConnection) {
  TokenBucket pings({.per_second = 100, .burst = 1000});
  if (!pings.Take(now_ns)) CloseConnection("too many pings");
}

void VettedConnectionsExample(int fd,
                              void (*LogFault)(int, absl::string_view)) {
  VettedConnections::Start(
      {.accepts = true, .now_ns = MonotonicNs, .on_fault = LogFault});
  VettedConnections::Add(fd);  // plain HTTP/2, before gRPC has it
}

struct ExampleConnections {
  void CutOff();
};

void AlarmClockExample(std::chrono::system_clock::time_point deadline,
                       ExampleConnections& connections,
                       std::function<void()> WaitForTheRest) {
  const AlarmClock alarm(deadline, [&] { connections.CutOff(); });
  WaitForTheRest();  // the alarm is off when `alarm` goes out of scope
}

}  // namespace tactus::server::examples
