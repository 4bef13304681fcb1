// File: vetted_servers.h
//
// Vets what servers send to this program, as tactusd vets its clients: a
// hostile server does not take the program's memory.
//
//   VetServers("trainctl");  // first thing in main
//
// Reports the first fault on standard error: calls fail with UNAVAILABLE, which
// does not say why. Thread-safe.
#pragma once

namespace tactus::internal::client {

// `program` must stay valid.
void VetServers(const char* program);

}  // namespace tactus::internal::client
