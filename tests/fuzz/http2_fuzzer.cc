// Any bytes of a peer on an HTTP/2 connection, after a good beginning: the vet
// comes to the same result whatever the pieces in which they arrive, and stays
// with it.
#include <cstdint>
#include <string>
#include <string_view>

#include "core/http2/http2_vet.h"
#include "fuzzer/FuzzedDataProvider.h"
#include "tests/fuzz/damaged.h"

namespace {

using namespace tactus::internal;

constexpr std::string_view kHello(
    "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n\0\0\0\4\0\0\0\0\0", 33);

// A frame with a header that fits its payload.
std::string Frame(FuzzedDataProvider& data) {
  const std::string payload = data.ConsumeRandomLengthString(300);
  std::string frame = {0,
                       static_cast<char>(payload.size() >> 8),
                       static_cast<char>(payload.size()),
                       data.ConsumeIntegralInRange<char>(0, 10),
                       data.ConsumeIntegral<char>(),
                       0,
                       0,
                       0,
                       data.ConsumeIntegralInRange<char>(0, 3)};
  return frame + payload;
}

std::span<const uint8_t> Bytes(std::string_view text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* input, size_t size) {
  FuzzedDataProvider data(input, size);
  const bool client = data.ConsumeBool();
  const auto peer = client ? Http2Vet::Peer::kClient : Http2Vet::Peer::kServer;
  std::string bytes(kHello.substr(client ? 0 : 24));
  while (data.remaining_bytes() > 8) {
    bytes +=
        data.ConsumeBool() ? Frame(data) : data.ConsumeRandomLengthString(50);
  }
  Http2Vet whole(peer);
  const std::string fault(whole.Check(Bytes(bytes), 1));
  Http2Vet pieces(peer);
  for (size_t at = 0; at < bytes.size();) {
    const size_t piece = 1 + static_cast<uint8_t>(bytes[at]) % 7;
    pieces.Check(
        Bytes(bytes).subspan(at).first(std::min(piece, bytes.size() - at)), 1);
    at += piece;
  }
  REQUIRE(pieces.Check({}, 1) == fault);
  REQUIRE(fault.empty() || whole.Check(Bytes(kHello), 1) == fault);
  return 0;
}
