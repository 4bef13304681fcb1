#include "tools/console/watch_socket.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <utility>

#include "core/base/limits_console.h"

namespace tactus::internal::console {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using boost::system::error_code;

// How long a viewer waits for news.
constexpr std::chrono::seconds kLongestSilence(1);
// Bytes that wait to be sent, beyond which a write waits. The system's default
// holds seconds of frames that are old when they are read.
constexpr int kMostUnsentBytes = 32 * 1024;
// A code of the range for applications.
constexpr uint16_t kSignedOut = 4401;

}  // namespace

template <class Stream>
WatchSocket<Stream>::WatchSocket(Stream stream, Browsers* browsers,
                                 Doorkeeper::Person person,
                                 std::unique_ptr<Viewer> viewer)
    : socket_(std::move(stream)),
      browsers_(*browsers),
      person_(std::move(person)),
      viewer_(std::move(viewer)),
      woken_(std::make_shared<std::atomic<bool>>(false)),
      timer_(socket_.get_executor()) {
  ++browsers_.connections;
  ++browsers_.live_pages;
}

template <class Stream>
WatchSocket<Stream>::~WatchSocket() {
  --browsers_.connections;
  --browsers_.live_pages;
  if (feed_ == nullptr) return;
  feed_->Unsubscribe(subscription_);
  // The end of a feed waits for its calls.
  asio::post(*browsers_.calls,
             [feed = std::move(feed_)]() mutable { feed.reset(); });
}

template <class Stream>
void WatchSocket<Stream>::Run(const Request& request,
                              const std::string& protocol) {
  auto& lowest = beast::get_lowest_layer(socket_);
  lowest.expires_never();
  // If the system refuses, frames are only older.
  setsockopt(lowest.socket().native_handle(), IPPROTO_TCP, TCP_NOTSENT_LOWAT,
             &kMostUnsentBytes, sizeof kMostUnsentBytes);
  socket_.set_option(websocket::stream_base::timeout{
      .handshake_timeout = std::chrono::seconds(limits::kBrowserPatienceS),
      .idle_timeout = std::chrono::seconds(6 * limits::kBrowserPatienceS),
      .keep_alive_pings = true});
  socket_.read_message_max(viewer_->bounds().message_bytes);
  if (!protocol.empty()) {
    socket_.set_option(websocket::stream_base::decorator(
        [protocol](websocket::response_type& response) {
          response.set(http::field::sec_websocket_protocol, protocol);
        }));
  }
  socket_.async_accept(request,
                       [self = this->shared_from_this()](error_code error) {
                         if (!error) self->Open();
                       });
}

template <class Stream>
void WatchSocket<Stream>::Open() {
  if (person_ == nullptr) return Close(kSignedOut, "signed out");
  feed_ = browsers_.doorkeeper.FeedOf(person_);
  subscription_ = feed_->Subscribe(
      [weak = this->weak_from_this(), woken = woken_, waker = browsers_.waker] {
        if (woken->exchange(true)) return;
        waker->Post([weak, woken] {
          *woken = false;
          if (const auto self = weak.lock()) self->SendOrWait(false);
        });
      });
  Read();
  SendOrWait(false);
}

template <class Stream>
void WatchSocket<Stream>::Read() {
  socket_.async_read(
      incoming_, [self = this->shared_from_this()](error_code error, size_t) {
        if (error) {
          self->closing_ = true;
          self->timer_.cancel();
          return;
        }
        self->OnRead();
      });
}

template <class Stream>
void WatchSocket<Stream>::OnRead() {
  const std::string why =
      viewer_->Hear({.bytes = beast::buffers_to_string(incoming_.data()),
                     .is_text = socket_.got_text()});
  incoming_.clear();
  if (!why.empty()) return Close(websocket::close_code::policy_error, why);
  if (HearsTooMuch()) {
    return Close(websocket::close_code::policy_error, "too many messages");
  }
  SendOrWait(false);
  Read();
}

template <class Stream>
bool WatchSocket<Stream>::HearsTooMuch() {
  const auto now = std::chrono::steady_clock::now();
  if (now - heard_since_ >= std::chrono::seconds(1)) {
    heard_since_ = now;
    heard_ = 0;
  }
  return ++heard_ > viewer_->bounds().messages_per_s;
}

template <class Stream>
void WatchSocket<Stream>::SendOrWait(bool even_if_old) {
  if (closing_) return;
  if (!browsers_.doorkeeper.IsSignedIn(person_)) {
    return Close(kSignedOut, "signed out");
  }
  if (feed_->IsRefused()) {
    browsers_.doorkeeper.EndSignIn(person_);
    return Close(kSignedOut, "the server refused the token");
  }
  if (!writing_) {
    auto message = viewer_->Next(*feed_, even_if_old);
    if (message) Send(*std::move(message));
  }
  // The sign-in may end while the other side reads nothing.
  timer_.expires_after(kLongestSilence);
  timer_.async_wait([weak = this->weak_from_this()](error_code error) {
    if (error) return;
    if (const auto self = weak.lock()) self->SendOrWait(true);
  });
}

template <class Stream>
void WatchSocket<Stream>::Send(Viewer::Message message) {
  writing_ = true;
  socket_.text(message.is_text);
  outgoing_ = std::move(message.bytes);
  socket_.async_write(
      asio::buffer(outgoing_),
      [self = this->shared_from_this()](error_code error, size_t) {
        self->writing_ = false;
        if (!error) self->SendOrWait(false);
      });
}

template <class Stream>
void WatchSocket<Stream>::Close(uint16_t code, const std::string& reason) {
  if (closing_) return;
  closing_ = true;
  // The closing waits for the message that is on its way, which the other side
  // may never read.
  timer_.expires_after(std::chrono::seconds(limits::kBrowserPatienceS));
  timer_.async_wait([self = this->shared_from_this()](error_code error) {
    if (!error) beast::get_lowest_layer(self->socket_).close();
  });
  socket_.async_close(
      websocket::close_reason(websocket::close_code(code), reason),
      [self = this->shared_from_this()](error_code) { self->timer_.cancel(); });
}

template class WatchSocket<PlainStream>;
template class WatchSocket<TlsStream>;

}  // namespace tactus::internal::console
