#include "server/rpc/request_limits.h"

#include <utility>

#include "absl/strings/string_view.h"
#include "core/base/limits.h"
#include "core/base/limits_training.h"

namespace tactus::internal::server {
namespace {

// All others are names, numbers and short texts.
constexpr std::pair<absl::string_view, size_t> kLarge[] = {
    // A chunk of bytes.
    {"WriteUploadRequest", limits::kMaxUploadMessageBytes},
    {"ImportModelRequest", limits::kMaxUploadMessageBytes},
    // Names of many trials or contacts.
    {"ListContactsRequest", 64UL * 1024},
    {"LabelContactsRequest", limits::kMaxUploadMessageBytes},
    {"RelabelTrialsRequest", limits::kMaxUploadMessageBytes},
    {"RemoveTrialsRequest", limits::kMaxUploadMessageBytes},
};

}  // namespace

size_t MaxRequestBytes(const google::protobuf::Descriptor& type) {
  for (const auto& [name, limit] : kLarge) {
    if (type.name() == name) return limit;
  }
  return limits::kMaxControlRequestBytes;
}

}  // namespace tactus::internal::server
