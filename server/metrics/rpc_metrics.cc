#include "server/metrics/rpc_metrics.h"

#include <algorithm>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/strip.h"
#include "google/protobuf/descriptor.h"

namespace tactus::internal::server {
namespace {

constexpr char kNoMethod[] = "unknown";

// The method of the contract that a path names; null if there is none.
const google::protobuf::MethodDescriptor* Describe(absl::string_view path) {
  std::string name(absl::StripPrefix(path, "/"));
  std::ranges::replace(name, '/', '.');
  return google::protobuf::DescriptorPool::generated_pool()->FindMethodByName(
      name);
}

std::string TypeOf(const google::protobuf::MethodDescriptor& method) {
  if (method.client_streaming()) {
    return method.server_streaming() ? "bidi_stream" : "client_stream";
  }
  return method.server_streaming() ? "server_stream" : "unary";
}

Labels LabelsOf(const google::protobuf::MethodDescriptor* method) {
  if (method == nullptr) {
    return {{"grpc_type", kNoMethod},
            {"grpc_service", kNoMethod},
            {"grpc_method", kNoMethod}};
  }
  return {{"grpc_type", TypeOf(*method)},
          {"grpc_service", method->service()->full_name()},
          {"grpc_method", method->name()}};
}

// The code as gRPC's other libraries write it: OK, InvalidArgument.
std::string CodeText(absl::StatusCode code) {
  if (code == absl::StatusCode::kOk) return "OK";
  std::string text;
  bool begins = true;
  for (const char c : absl::StatusCodeToString(code)) {
    if (c == '_') {
      begins = true;
      continue;
    }
    text += begins ? c : absl::ascii_tolower(c);
    begins = false;
  }
  return text == "Cancelled" ? "Canceled" : text;
}

Labels With(Labels labels, std::string name, std::string value) {
  labels.emplace_back(std::move(name), std::move(value));
  return labels;
}

}  // namespace

RpcMetrics::Method& RpcMetrics::Find(absl::string_view name) {
  if (const auto found = methods_.find(name); found != methods_.end()) {
    return found->second;
  }
  const auto* method = Describe(name);
  Method& made = methods_[method == nullptr ? kNoMethod : std::string(name)];
  if (made.labels.empty()) made.labels = LabelsOf(method);
  return made;
}

void RpcMetrics::Start(absl::string_view method) {
  const std::lock_guard lock(mutex_);
  ++Find(method).started;
}

void RpcMetrics::Handle(absl::string_view method, absl::StatusCode code,
                        double seconds) {
  const std::lock_guard lock(mutex_);
  Method& of = Find(method);
  ++of.handled[code];
  of.seconds.Observe(seconds);
}

void RpcMetrics::Collect(Families* families) const {
  Family started = CounterFamily("grpc_server_started_total", "Calls begun.");
  Family handled =
      CounterFamily("grpc_server_handled_total", "Calls ended, by code.");
  Family seconds = HistogramFamily("grpc_server_handling_seconds",
                                   "Time from the begin of a call to its end.");
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [name, method] : methods_) {
      Add(method.labels, static_cast<double>(method.started), &started);
      for (const auto& [code, count] : method.handled) {
        Add(With(method.labels, "grpc_code", CodeText(code)),
            static_cast<double>(count), &handled);
      }
      Add(method.labels, method.seconds.Read(), method.seconds.bounds(),
          &seconds);
    }
  }
  families->push_back(std::move(started));
  families->push_back(std::move(handled));
  families->push_back(std::move(seconds));
}

}  // namespace tactus::internal::server
