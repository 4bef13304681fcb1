// File: bad_input.h
//
// A table of the errors that clients make on a stream, each with the status
// code and the reason that must follow. Tests run it against StreamSession and
// over gRPC.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal::testing {

struct BadInput {
  std::string name;
  // Sent in order; the last is the bad one unless `half_close`.
  std::vector<v1::ClassifyContactRequest> requests;
  absl::StatusCode code;
  std::string reason;
  // The fault is the half-close after the requests.
  bool half_close = false;
};

std::vector<BadInput> BadInputs();

inline std::ostream& operator<<(std::ostream& out, const BadInput& bad) {
  return out << bad.name;
}

}  // namespace tactus::internal::testing
