#include "tools/load/grpc_call.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "client/stream/status.h"
#include "core/base/errors.h"
#include "core/base/limits.h"

namespace tactus::internal::client {
namespace {

// Before each message: a byte that says "not compressed", and its size.
constexpr size_t kPrefixBytes = 5;
// A header of which no more is kept.
constexpr size_t kMaxKeptBytes = 16 * 1024;

uint32_t SizeIn(absl::string_view prefix) {
  uint32_t size = 0;
  for (size_t i = 1; i < kPrefixBytes; ++i) {
    size = size << 8 | static_cast<uint8_t>(prefix[i]);
  }
  return size;
}

void WriteSize(uint32_t size, char* prefix) {
  for (size_t i = 1; i < kPrefixBytes; ++i) {
    prefix[i] = static_cast<char>(size >> (8 * (kPrefixBytes - 1 - i)));
  }
}

// Undoes the %41 of grpc-message.
std::string PercentDecoded(absl::string_view text) {
  std::string decoded;
  for (size_t i = 0; i < text.size(); ++i) {
    const absl::string_view digits = text.substr(i + 1, 2);
    if (text[i] == '%' && digits.size() == 2 &&
        absl::ascii_isxdigit(digits[0]) && absl::ascii_isxdigit(digits[1])) {
      decoded += absl::HexStringToBytes(digits);
      i += 2;
    } else {
      decoded += text[i];
    }
  }
  return decoded;
}

}  // namespace

void GrpcCall::OnStarted(Carrier* carrier, int32_t stream) {
  carrier_ = carrier;
  stream_ = stream;
}

size_t GrpcCall::Send(uint8_t* out, size_t size, Next* next) {
  if (sent_ == outgoing_.size()) {
    outgoing_.assign(kPrefixBytes, '\0');
    sent_ = 0;
    *next = listener_->TakeMessage(&outgoing_);
    if (*next != Next::kMessage) {
      sent_all_ = *next == Next::kNoMore;
      outgoing_.clear();
      return 0;
    }
    WriteSize(static_cast<uint32_t>(outgoing_.size() - kPrefixBytes),
              outgoing_.data());
  }
  *next = Next::kMessage;
  const size_t part = std::min(size, outgoing_.size() - sent_);
  std::memcpy(out, outgoing_.data() + sent_, part);
  sent_ += part;
  return part;
}

void GrpcCall::OnHeader(absl::string_view name, absl::string_view value) {
  std::string* const kept = name == ":status"                   ? &http_status_
                            : name == "grpc-status"             ? &grpc_status_
                            : name == "grpc-message"            ? &grpc_message_
                            : name == "grpc-status-details-bin" ? &grpc_details_
                                                                : nullptr;
  if (kept != nullptr) *kept = std::string(value.substr(0, kMaxKeptBytes));
}

void GrpcCall::OnData(absl::string_view bytes) {
  if (ended_ || last_) return;
  incoming_.append(bytes.data(), bytes.size());
  unconsumed_ += bytes.size();
  Deliver();
}

void GrpcCall::ReadOne() {
  if (wanted_ == 0) wanted_ = 1;
  Deliver();
}

void GrpcCall::ReadAll() {
  wanted_ = kAll;
  Deliver();
}

void GrpcCall::Deliver() {
  size_t taken = 0;
  bool message_waits = false;
  while (!ended_) {
    const absl::string_view rest = absl::string_view(incoming_).substr(taken);
    if (rest.size() < kPrefixBytes) break;
    const size_t size = SizeIn(rest);
    // Also where nobody wants it yet: the rest of it would be kept.
    if (rest[0] != 0 || size > limits::kMaxReceiveBytes) {
      End(InvalidResponse("size of a response", size,
                          absl::StrCat("at most ", limits::kMaxReceiveBytes,
                                       " bytes, not compressed")));
      return;
    }
    if (rest.size() < kPrefixBytes + size) break;
    message_waits = wanted_ == 0;
    if (message_waits) break;
    if (wanted_ != kAll) --wanted_;
    taken += kPrefixBytes + size;
    listener_->OnMessage(rest.substr(kPrefixBytes, size));
  }
  if (ended_) return;
  incoming_.erase(0, taken);
  if (message_waits) {
    Consume(taken);
  } else {
    // Part of a message: the rest may be larger than the window.
    Consume(unconsumed_);
    if (last_) End(*std::exchange(last_, std::nullopt));
  }
}

void GrpcCall::Consume(size_t bytes) {
  bytes = std::min(bytes, unconsumed_);
  unconsumed_ -= bytes;
  if (bytes > 0 && carrier_ != nullptr) carrier_->Consume(this, bytes);
}

void GrpcCall::OnServerEnded() {
  if (std::exchange(server_ended_, true) || ended_) return;
  last_ = StatusOfHeaders();
  Deliver();
}

void GrpcCall::OnClosed(const absl::Status& fault) {
  closed_ = true;
  if (fault.ok()) {
    OnServerEnded();
  } else if (!last_) {
    End(fault);
  }
}

absl::Status GrpcCall::StatusOfHeaders() const {
  int code = 0;
  if (!absl::SimpleAtoi(grpc_status_, &code)) {
    // As gRPC takes the answers of proxies.
    const bool busy = http_status_ == "429" || http_status_ == "502" ||
                      http_status_ == "503" || http_status_ == "504";
    return FromGrpcStatus(grpc::Status(
        busy ? grpc::StatusCode::UNAVAILABLE : grpc::StatusCode::UNKNOWN,
        absl::StrCat("the server ended the call with HTTP status ",
                     http_status_.empty() ? "none" : http_status_,
                     " and without grpc-status")));
  }
  std::string details;
  if (!absl::Base64Unescape(grpc_details_, &details)) details.clear();
  return FromGrpcStatus(grpc::Status(static_cast<grpc::StatusCode>(code),
                                     PercentDecoded(grpc_message_), details));
}

void GrpcCall::Cancel() {
  End(FromGrpcStatus(
      grpc::Status(grpc::StatusCode::CANCELLED, "the caller gave up")));
}

void GrpcCall::End(const absl::Status& status) {
  if (std::exchange(ended_, true)) return;
  if (carrier_ != nullptr) std::exchange(carrier_, nullptr)->Forget(this);
  listener_->OnEnded(status);
}

}  // namespace tactus::internal::client
