// File: vetted_connections.h
//
// VettedConnections: puts an Http2Vet between gRPC and each connection, also
// where gRPC does TLS. gRPC 1.51 has no place for that; it reads with recvmsg,
// and with SSL_read behind TLS, and finds both as every program finds functions
// of shared libraries: in the program itself first. vetted_reads.cc defines
// them. They call the functions of the system and show the vet what came. A
// connection with a fault ends there: gRPC reads its end, and never the bytes.
//
//   VettedConnections::Start(
//       {.accepts = true, .now_ns = MonotonicNs, .on_fault = LogFault});
//   VettedConnections::Add(fd);  // plain HTTP/2, before gRPC has it
//
// A connection is forgotten when its descriptor is closed. It costs no system
// call, and a frame of taxels neither an allocation nor a lock.
//
// Thread-safe. Start is called before there are connections; a second call does
// nothing. A program that does not call it reads as it did.
#pragma once

#include <cstdint>
#include <memory>

#include "absl/strings/string_view.h"
#include "core/http2/http2_vet.h"

namespace tactus::internal {

class VettedConnections {
 public:
  struct Options {
    // TLS connections that this process accepts are vetted.
    bool accepts = false;
    // Connections that this process opens are vetted, plain and TLS.
    bool connects = false;
    // A monotonic clock.
    int64_t (*now_ns)() = nullptr;
    // Called once for each connection with a fault, on the thread that reads;
    // `fd` is -1 behind TLS. It must not block.
    void (*on_fault)(int fd, absl::string_view fault) = nullptr;
  };

  static void Start(const Options& options);
  // Vets what a client sends on `fd`, a connection without TLS. False if the
  // descriptor is too large.
  static bool Add(int fd);
  // Bytes that were vetted since the start: 0 after a connection was served
  // means that gRPC does not read as this file says.
  static uint64_t bytes();
};

}  // namespace tactus::internal
