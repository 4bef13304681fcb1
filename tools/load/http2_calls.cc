#include "tools/load/http2_calls.h"

#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "nghttp2/nghttp2.h"

namespace tactus::internal::client {
namespace {

// Until the server has said how many it takes.
constexpr uint32_t kFirstConcurrentCalls = 100;

absl::Status Broken(int error) {
  return absl::UnavailableError(
      absl::StrCat("HTTP/2: ", nghttp2_strerror(error)));
}

nghttp2_nv Header(absl::string_view name, absl::string_view value) {
  const auto bytes = [](absl::string_view text) {
    return reinterpret_cast<uint8_t*>(const_cast<char*>(text.data()));
  };
  return {.name = bytes(name),
          .value = bytes(value),
          .namelen = name.size(),
          .valuelen = value.size(),
          .flags = NGHTTP2_NV_FLAG_NONE};
}

}  // namespace

// What nghttp2 tells; `user` is the Http2Calls.
struct Http2Calls::Callbacks {
  static GrpcCall* CallOf(nghttp2_session* session, int32_t stream) {
    return static_cast<GrpcCall*>(
        nghttp2_session_get_stream_user_data(session, stream));
  }

  static ssize_t OnSend(nghttp2_session* session, int32_t stream, uint8_t* out,
                        size_t size, uint32_t* flags, nghttp2_data_source*,
                        void*) {
    GrpcCall* const call = CallOf(session, stream);
    if (call == nullptr) return NGHTTP2_ERR_DEFERRED;
    GrpcCall::Next next = GrpcCall::Next::kMessage;
    const size_t sent = call->Send(out, size, &next);
    if (next == GrpcCall::Next::kLater) return NGHTTP2_ERR_DEFERRED;
    if (next == GrpcCall::Next::kNoMore) *flags |= NGHTTP2_DATA_FLAG_EOF;
    return static_cast<ssize_t>(sent);
  }

  static int OnHeader(nghttp2_session* session, const nghttp2_frame* frame,
                      const uint8_t* name, size_t name_size,
                      const uint8_t* value, size_t value_size, uint8_t, void*) {
    GrpcCall* const call = CallOf(session, frame->hd.stream_id);
    if (call == nullptr) return 0;
    const auto text = [](const uint8_t* bytes, size_t size) {
      return absl::string_view(reinterpret_cast<const char*>(bytes), size);
    };
    call->OnHeader(text(name, name_size), text(value, value_size));
    return 0;
  }

  static int OnData(nghttp2_session* session, uint8_t, int32_t stream,
                    const uint8_t* data, size_t size, void*) {
    nghttp2_session_consume_connection(session, size);
    GrpcCall* const call = CallOf(session, stream);
    if (call == nullptr) return 0;
    call->OnData({reinterpret_cast<const char*>(data), size});
    return 0;
  }

  static int OnFrame(nghttp2_session* session, const nghttp2_frame* frame,
                     void*) {
    const bool ends =
        (frame->hd.type == NGHTTP2_DATA || frame->hd.type == NGHTTP2_HEADERS) &&
        (frame->hd.flags & NGHTTP2_FLAG_END_STREAM) != 0;
    if (!ends) return 0;
    if (GrpcCall* call = CallOf(session, frame->hd.stream_id)) {
      call->OnServerEnded();
    }
    return 0;
  }

  static int OnNotSent(nghttp2_session* session, const nghttp2_frame* frame,
                       int error, void*) {
    if (frame->hd.type != NGHTTP2_HEADERS) return 0;
    if (GrpcCall* call = CallOf(session, frame->hd.stream_id)) {
      call->End(Broken(error));
    }
    return 0;
  }

  static int OnClose(nghttp2_session* session, int32_t stream, uint32_t error,
                     void*) {
    GrpcCall* const call = CallOf(session, stream);
    if (call == nullptr) return 0;
    call->OnClosed(
        error == NGHTTP2_NO_ERROR
            ? absl::OkStatus()
            : absl::UnavailableError(absl::StrCat(
                  "the stream was reset: ", nghttp2_http2_strerror(error))));
    return 0;
  }
};

void Http2Calls::DeleteSession::operator()(nghttp2_session* session) const {
  nghttp2_session_del(session);
}

Http2Calls::Http2Calls(std::string authority, std::string scheme,
                       std::function<void()> on_work)
    : authority_(std::move(authority)),
      scheme_(std::move(scheme)),
      on_work_(std::move(on_work)) {
  nghttp2_session_callbacks* callbacks = nullptr;
  nghttp2_session_callbacks_new(&callbacks);
  nghttp2_session_callbacks_set_on_header_callback(callbacks,
                                                   Callbacks::OnHeader);
  nghttp2_session_callbacks_set_on_data_chunk_recv_callback(callbacks,
                                                            Callbacks::OnData);
  nghttp2_session_callbacks_set_on_frame_recv_callback(callbacks,
                                                       Callbacks::OnFrame);
  nghttp2_session_callbacks_set_on_frame_not_send_callback(
      callbacks, Callbacks::OnNotSent);
  nghttp2_session_callbacks_set_on_stream_close_callback(callbacks,
                                                         Callbacks::OnClose);
  nghttp2_option* options = nullptr;
  nghttp2_option_new(&options);
  // A slow reader leaves bytes where they are.
  nghttp2_option_set_no_auto_window_update(options, 1);
  nghttp2_option_set_peer_max_concurrent_streams(options,
                                                 kFirstConcurrentCalls);
  nghttp2_session* session = nullptr;
  nghttp2_session_client_new2(&session, callbacks, this, options);
  session_.reset(session);
  nghttp2_option_del(options);
  nghttp2_session_callbacks_del(callbacks);
  const nghttp2_settings_entry no_push = {NGHTTP2_SETTINGS_ENABLE_PUSH, 0};
  nghttp2_submit_settings(session, NGHTTP2_FLAG_NONE, &no_push, 1);
}

Http2Calls::~Http2Calls() = default;

void Http2Calls::Start(GrpcCall* call) {
  if (!takes_calls()) {
    call->End(absl::UnavailableError("the connection takes no more calls"));
    return;
  }
  calls_.insert(call);
  SubmitRequest(call);
  on_work_();
}

void Http2Calls::SubmitRequest(GrpcCall* call) {
  const nghttp2_nv headers[] = {Header(":method", "POST"),
                                Header(":scheme", scheme_),
                                Header(":path", call->method()),
                                Header(":authority", authority_),
                                Header("te", "trailers"),
                                Header("content-type", "application/grpc"),
                                Header("user-agent", "tactus-load")};
  const nghttp2_data_provider messages = {.source = {.ptr = nullptr},
                                          .read_callback = Callbacks::OnSend};
  const int32_t stream = nghttp2_submit_request(
      session_.get(), nullptr, headers, std::size(headers), &messages, call);
  // Below 0 only without memory or after 2^30 calls.
  call->OnStarted(this, stream);
  if (stream < 0) call->End(Broken(stream));
}

bool Http2Calls::takes_calls() const {
  return !failed_ && nghttp2_session_check_request_allowed(session_.get()) != 0;
}

absl::Status Http2Calls::Receive(absl::string_view bytes) {
  const ssize_t taken = nghttp2_session_mem_recv(
      session_.get(), reinterpret_cast<const uint8_t*>(bytes.data()),
      bytes.size());
  if (taken < 0) return Broken(static_cast<int>(taken));
  on_work_();
  return absl::OkStatus();
}

absl::Status Http2Calls::Collect(size_t most, std::string* out) {
  while (out->size() < most) {
    const uint8_t* bytes = nullptr;
    const ssize_t size = nghttp2_session_mem_send(session_.get(), &bytes);
    if (size < 0) return Broken(static_cast<int>(size));
    if (size == 0) break;
    out->append(reinterpret_cast<const char*>(bytes), size);
  }
  return absl::OkStatus();
}

void Http2Calls::Fail(const absl::Status& status) {
  failed_ = true;
  const std::vector<GrpcCall*> calls(calls_.begin(), calls_.end());
  for (GrpcCall* call : calls) call->End(status);
}

void Http2Calls::Resume(GrpcCall* call) {
  // Fails if it is not deferred: then it will be asked anyway.
  nghttp2_session_resume_data(session_.get(), call->stream());
  on_work_();
}

void Http2Calls::Consume(GrpcCall* call, size_t bytes) {
  nghttp2_session_consume_stream(session_.get(), call->stream(), bytes);
  on_work_();
}

void Http2Calls::Forget(GrpcCall* call) {
  calls_.erase(call);
  if (failed_ || call->stream() < 0) return;
  nghttp2_session_set_stream_user_data(session_.get(), call->stream(), nullptr);
  if (!call->is_open()) return;
  nghttp2_submit_rst_stream(session_.get(), NGHTTP2_FLAG_NONE, call->stream(),
                            NGHTTP2_CANCEL);
  on_work_();
}

}  // namespace tactus::internal::client
