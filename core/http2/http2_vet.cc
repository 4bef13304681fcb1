#include "core/http2/http2_vet.h"

#include <algorithm>
#include <cstring>

#include "core/base/limits_http2.h"
#include "nghttp2/nghttp2.h"

namespace tactus::internal {
namespace {

constexpr absl::string_view kPreface("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n");

// Types and flags of frames (RFC 9113, section 6).
enum FrameType : uint8_t {
  kData = 0,
  kHeaders = 1,
  kResetStream = 3,
  kSettings = 4,
  kPushPromise = 5,
  kPing = 6,
  kGoAway = 7,
  kContinuation = 9,
};
constexpr uint8_t kEndHeaders = 0x4;
constexpr uint8_t kPadded = 0x8;
constexpr uint8_t kPriority = 0x20;
constexpr size_t kPriorityBytes = 5;

// A header that belongs between balancers and servers. gRPC aborts when it
// hands it to a processor of authentication metadata.
constexpr absl::string_view kAborts("grpclb_client_stats");

uint32_t Number(const uint8_t* bytes, int count) {
  uint32_t number = 0;
  for (int i = 0; i < count; ++i) number = number << 8 | bytes[i];
  return number;
}

}  // namespace

void Http2Vet::DeleteInflater::operator()(nghttp2_hd_inflater* inflater) const {
  nghttp2_hd_inflate_del(inflater);
}

Http2Vet::Http2Vet(Peer peer)
    : peer_(peer),
      settings_({limits::kHttp2SettingsPerSecond, limits::kHttp2SettingsBurst}),
      pings_({limits::kHttp2PingsPerSecond, limits::kHttp2PingsBurst}),
      resets_({limits::kHttp2ResetsPerSecond, limits::kHttp2ResetBurst}),
      small_frames_(
          {limits::kHttp2SmallFramesPerSecond, limits::kHttp2SmallFrameBurst}) {
  nghttp2_hd_inflater* inflater = nullptr;
  if (nghttp2_hd_inflate_new(&inflater) != 0) Fail("memory is short");
  inflater_.reset(inflater);
}

Http2Vet::~Http2Vet() = default;

absl::string_view Http2Vet::Check(std::span<const uint8_t> bytes,
                                  int64_t now_ns) {
  bool passes = fault_.empty() && TakePreface(bytes);
  while (passes && !bytes.empty()) {
    passes =
        payload_left_ > 0 ? TakePayload(bytes) : TakeFrameHeader(bytes, now_ns);
  }
  return fault_;
}

bool Http2Vet::Fail(absl::string_view fault) {
  fault_ = fault;
  return false;
}

bool Http2Vet::TakePreface(std::span<const uint8_t>& bytes) {
  if (peer_ == Peer::kServer || preface_bytes_ == kPreface.size() ||
      bytes.empty()) {
    return true;
  }
  const size_t take = std::min(kPreface.size() - preface_bytes_, bytes.size());
  if (std::memcmp(bytes.data(), kPreface.data() + preface_bytes_, take) != 0) {
    return Fail("it does not speak HTTP/2");
  }
  preface_bytes_ += take;
  bytes = bytes.subspan(take);
  return true;
}

bool Http2Vet::TakeFrameHeader(std::span<const uint8_t>& bytes,
                               int64_t now_ns) {
  const size_t take = std::min(kFrameHeaderBytes - header_bytes_, bytes.size());
  std::memcpy(header_.data() + header_bytes_, bytes.data(), take);
  header_bytes_ += take;
  bytes = bytes.subspan(take);
  if (header_bytes_ < kFrameHeaderBytes) return true;
  header_bytes_ = 0;
  return BeginFrame(now_ns);
}

bool Http2Vet::BeginFrame(int64_t now_ns) {
  payload_left_ = Number(header_.data(), 3);
  const uint8_t type = header_[3];
  const uint8_t flags = header_[4];
  const uint32_t stream = Number(header_.data() + 5, 4) & 0x7FFFFFFF;
  payload_is_headers_ = false;
  if (first_frame_ && type != kSettings) {
    return Fail("its first frame is not SETTINGS");
  }
  first_frame_ = false;
  if (block_stream_ != 0 && type != kContinuation) {
    return Fail("another frame comes within a header block");
  }
  // A frame of a message is the only one that may be long.
  if (type == kData && payload_left_ > 0) return true;
  if (payload_left_ > limits::kMaxHeaderBlockBytes) {
    return Fail("a frame that is no message is too long");
  }
  if (type == kContinuation) return BeginContinuation(flags, stream);
  if (!BeginControlFrame(type, now_ns)) return false;
  return type != kHeaders || BeginHeaders(flags, stream);
}

bool Http2Vet::BeginControlFrame(uint8_t type, int64_t now_ns) {
  switch (type) {
    case kSettings:
      return settings_.Take(now_ns) || Fail("too many SETTINGS frames");
    case kPing:
      return pings_.Take(now_ns) || Fail("too many PING frames");
    case kGoAway:
      return ++goaways_ <= limits::kMaxHttp2GoAways ||
             Fail("too many GOAWAY frames");
    case kResetStream:
      // A server resets each call that it ends before the client has.
      return peer_ == Peer::kServer || resets_.Take(now_ns) ||
             Fail("too many RST_STREAM frames");
    case kPushPromise:
      return Fail("it pushes");
    default:
      return small_frames_.Take(now_ns) ||
             Fail("too many frames without a message");
  }
}

bool Http2Vet::BeginHeaders(uint8_t flags, uint32_t stream) {
  if (stream == 0) return Fail("headers without a stream");
  // gRPC 1.51 takes padding for headers.
  if (flags & kPadded) return Fail("padded headers");
  priority_left_ = flags & kPriority ? kPriorityBytes : 0;
  if (payload_left_ < priority_left_) return Fail("a frame is too short");
  block_stream_ = stream;
  block_bytes_ = 0;
  block_decoded_bytes_ = 0;
  block_fields_ = 0;
  block_frames_ = 0;
  return BeginContinuation(flags, stream);
}

bool Http2Vet::BeginContinuation(uint8_t flags, uint32_t stream) {
  if (block_stream_ == 0 || stream != block_stream_) {
    return Fail("CONTINUATION without a header block");
  }
  block_bytes_ += payload_left_;
  if (block_bytes_ > limits::kMaxHeaderBlockBytes) {
    return Fail("a header block is too long");
  }
  if (++block_frames_ > limits::kMaxHeaderBlockFrames) {
    return Fail("a header block has too many frames");
  }
  payload_is_headers_ = true;
  ends_headers_ = (flags & kEndHeaders) != 0;
  // An empty payload never comes to TakePayload.
  return payload_left_ > priority_left_ || InflateHeaders({}, ends_headers_);
}

bool Http2Vet::TakePayload(std::span<const uint8_t>& bytes) {
  const auto take = bytes.first(std::min(payload_left_, bytes.size()));
  bytes = bytes.subspan(take.size());
  payload_left_ -= take.size();
  if (!payload_is_headers_) return true;
  const size_t skipped = std::min(priority_left_, take.size());
  priority_left_ -= skipped;
  return InflateHeaders(take.subspan(skipped),
                        ends_headers_ && payload_left_ == 0);
}

bool Http2Vet::InflateHeaders(std::span<const uint8_t> fragment, bool last) {
  while (true) {
    nghttp2_nv field = {};
    int flags = 0;
    const ssize_t used =
        nghttp2_hd_inflate_hd2(inflater_.get(), &field, &flags, fragment.data(),
                               fragment.size(), last ? 1 : 0);
    if (used < 0) return Fail("its headers are not HPACK");
    fragment = fragment.subspan(static_cast<size_t>(used));
    if (flags & NGHTTP2_HD_INFLATE_EMIT) {
      const absl::string_view name(reinterpret_cast<const char*>(field.name),
                                   field.namelen);
      if (!CheckHeader(name, field.valuelen)) return false;
    }
    if (flags & NGHTTP2_HD_INFLATE_FINAL) {
      nghttp2_hd_inflate_end_headers(inflater_.get());
      block_stream_ = 0;
      return true;
    }
    if (!(flags & NGHTTP2_HD_INFLATE_EMIT) && fragment.empty()) return true;
  }
}

bool Http2Vet::CheckHeader(absl::string_view name, size_t value_bytes) {
  block_decoded_bytes_ += name.size() + value_bytes;
  if (++block_fields_ > limits::kMaxHeaders ||
      block_decoded_bytes_ > limits::kMaxHeaderBlockBytes) {
    return Fail("too many headers");
  }
  return name != kAborts || Fail("the header grpclb_client_stats");
}

}  // namespace tactus::internal
