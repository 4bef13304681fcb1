// File: tls_probe.h
//
// Looks at the certificate that a server shows, valid or not.
//
//   TACTUS_ASSIGN_OR_RETURN(const TlsProbe probe,
//                           ProbeTls("arm.lab:50051", roots));
//   if (!probe.fault.empty()) Complain(probe.fault);
//
// gRPC only reports that a handshake failed; this says why, and until when a
// good certificate is valid. It sends nothing but the handshake. Thread-safe: a
// free function without state.
#pragma once

#include <string>

#include "absl/status/statusor.h"

namespace tactus::internal::client {

struct TlsProbe {
  // Why the certificate is not accepted, e.g. "certificate has expired"; empty
  // if it is.
  std::string fault;
  // Days until the certificate ends; negative if it has.
  int days_left = 0;
};

// `address`: host:port. `roots`: PEM of the authorities that may vouch for the
// server. UNAVAILABLE if there is no connection or no TLS.
absl::StatusOr<TlsProbe> ProbeTls(const std::string& address,
                                  const std::string& roots);

}  // namespace tactus::internal::client
