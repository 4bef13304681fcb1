// File: wire_check.h
//
// CheckWire: looks at a serialised message before it is parsed. Bytes that the
// message's type does not know are kept by the parser, and stored with the
// message; a few bytes may ask for much memory.
//
//   const WireCheck check = CheckWire(*v1::TrialRecord::descriptor(), bytes);
//   if (!check.fault.empty()) return InvalidTrial(check.fault);
//   if (check.parsed_bytes > limit) return InvalidTrial("it is too large");
//
// It allocates nothing but the text of a fault. Thread-safe: free functions
// without state.
#pragma once

#include <cstdint>
#include <string>

#include "absl/strings/string_view.h"
#include "google/protobuf/descriptor.h"
#include "google/protobuf/io/zero_copy_stream.h"

namespace tactus::internal {

struct WireCheck {
  // What is wrong: a field that the type does not know, at any depth, or a
  // wrong encoding. Empty if nothing is.
  std::string fault;
  // An upper bound of the memory of the parsed message.
  int64_t parsed_bytes = 0;
};

WireCheck CheckWire(const google::protobuf::Descriptor& type,
                    absl::string_view bytes);
// Reads `bytes` to their end.
WireCheck CheckWire(const google::protobuf::Descriptor& type,
                    google::protobuf::io::ZeroCopyInputStream* bytes);

}  // namespace tactus::internal
