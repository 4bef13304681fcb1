// File: vetted_reads.h
//
// What vetted_reads.cc, which replaces functions of the system, needs to know
// of the connections. Only for these two.
//
// Thread-safe, except that one descriptor is read by one thread at a time.
#pragma once

#include <openssl/ssl.h>
#include <sys/types.h>

#include <cstdint>

namespace tactus::internal::vetted_reads {

// `fd` is a new connection that this process opens; `fd` was closed.
void Opened(int fd);
void Closed(int fd);

// True if the vet knows `fd`.
bool IsVetted(int fd);
// True if `fd` had a fault: nothing more is read from it.
bool HasFault(int fd);
// Shows the vet `size` bytes that came from `fd`. False at a fault.
bool Passes(int fd, const uint8_t* bytes, size_t size);
// The same for bytes that came over TLS, at any connection of gRPC.
bool Passes(SSL* ssl, const uint8_t* bytes, size_t size);

}  // namespace tactus::internal::vetted_reads
