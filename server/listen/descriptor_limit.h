// File: descriptor_limit.h
//
// How many files and sockets this process may have open, and how many
// connections fit into that.
//
//   const int connections = ConnectionsThatFit(RaiseDescriptorLimit());
//
// Free functions; call RaiseDescriptorLimit before threads start.
#pragma once

namespace tactus::internal::server {

// Raises the soft limit of open files (RLIMIT_NOFILE), which is often 1,024, to
// the hard limit. Returns the limit that then holds.
int RaiseDescriptorLimit();

// What is left of `descriptors` for connections: all but those that the
// process needs for itself (log, sockets, epoll, bundles, the self-check).
int ConnectionsThatFit(int descriptors);

}  // namespace tactus::internal::server
