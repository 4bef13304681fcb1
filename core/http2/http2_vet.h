// File: http2_vet.h
//
// Http2Vet: reads along what one peer sends on an HTTP/2 connection (RFC 9113,
// RFC 7541) and finds what gRPC 1.51 cannot bear, before gRPC parses it.
//
//   Http2Vet vet(Http2Vet::Peer::kClient);
//   const absl::string_view fault = vet.Check(bytes, MonotonicNs());
//   if (!fault.empty()) CloseConnection(fault);
//
// gRPC 1.51 keeps a header block until its end, however long it is, and parses
// an unfinished header from its start with each piece that comes: a connection
// then takes a gigabyte, or holds up its thread for seconds. One header aborts
// the process. The vet bounds header blocks, their CONTINUATION frames and
// their headers, refuses malformed HPACK, and limits how often frames may come
// that cost work and carry no message, and how often a client may reset calls.
// It does not change a byte.
//
// Messages (DATA) pass without being looked at: the path of a taxel frame
// allocates nothing here. Memory: nghttp2's HPACK table (4 KiB) and at most one
// header. A fault is final. Not thread-safe.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "absl/strings/string_view.h"
#include "core/http2/token_bucket.h"

struct nghttp2_hd_inflater;

namespace tactus::internal {

class Http2Vet {
 public:
  // Whose bytes these are. A client begins with the connection preface.
  enum class Peer { kClient, kServer };

  explicit Http2Vet(Peer peer);
  ~Http2Vet();

  Http2Vet(const Http2Vet&) = delete;
  Http2Vet& operator=(const Http2Vet&) = delete;

  // Takes the next bytes, in pieces of any size. Returns why the connection
  // must be closed, or nothing. `now_ns` is of any monotonic clock. After a
  // fault it returns the same fault.
  absl::string_view Check(std::span<const uint8_t> bytes, int64_t now_ns);

 private:
  static constexpr size_t kFrameHeaderBytes = 9;

  struct DeleteInflater {
    void operator()(nghttp2_hd_inflater* inflater) const;
  };

  // Each takes bytes from the front of `bytes`, all that it can, and returns
  // false with fault_ set if they must not pass.
  bool TakePreface(std::span<const uint8_t>& bytes);
  bool TakeFrameHeader(std::span<const uint8_t>& bytes, int64_t now_ns);
  bool TakePayload(std::span<const uint8_t>& bytes);

  // The nine bytes of a frame's header are complete.
  bool BeginFrame(int64_t now_ns);
  bool BeginHeaders(uint8_t flags, uint32_t stream);
  bool BeginContinuation(uint8_t flags, uint32_t stream);
  bool BeginControlFrame(uint8_t type, int64_t now_ns);
  bool InflateHeaders(std::span<const uint8_t> fragment, bool last);
  bool CheckHeader(absl::string_view name, size_t value_bytes);
  bool Fail(absl::string_view fault);

  const Peer peer_;
  absl::string_view fault_;

  // Bytes of the preface or of a frame's header that have come.
  size_t preface_bytes_ = 0;
  std::array<uint8_t, kFrameHeaderBytes> header_ = {};
  size_t header_bytes_ = 0;

  // The frame whose payload comes now.
  size_t payload_left_ = 0;
  // Bytes at its start that come before header fields (RFC 9113, 6.2).
  size_t priority_left_ = 0;
  bool payload_is_headers_ = false;
  bool ends_headers_ = false;

  // The header block that is not complete yet; its stream, or 0.
  uint32_t block_stream_ = 0;
  size_t block_bytes_ = 0;
  size_t block_decoded_bytes_ = 0;
  int block_fields_ = 0;
  int block_frames_ = 0;

  int goaways_ = 0;
  bool first_frame_ = true;
  TokenBucket settings_;
  TokenBucket pings_;
  TokenBucket resets_;
  TokenBucket small_frames_;
  std::unique_ptr<nghttp2_hd_inflater, DeleteInflater> inflater_;
};

}  // namespace tactus::internal
