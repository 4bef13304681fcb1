#include "tools/console/live_page.h"

#include <utility>

#include "core/base/limits_console.h"
#include "tools/console/live_message.h"

namespace tactus::internal::console {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using boost::system::error_code;

// How long a page waits for news.
constexpr std::chrono::seconds kLongestSilence(1);
// A code of the range for applications.
constexpr uint16_t kSignedOut = 4401;

}  // namespace

template <class Stream>
LivePage<Stream>::LivePage(Stream stream, Browsers* browsers,
                           std::string cookie)
    : socket_(std::move(stream)),
      browsers_(*browsers),
      cookie_(std::move(cookie)),
      woken_(std::make_shared<std::atomic<bool>>(false)),
      timer_(socket_.get_executor()) {
  ++browsers_.connections;
  ++browsers_.live_pages;
}

template <class Stream>
LivePage<Stream>::~LivePage() {
  --browsers_.connections;
  --browsers_.live_pages;
  if (feed_ == nullptr) return;
  feed_->Unsubscribe(subscription_);
  // The end of a feed waits for its calls.
  asio::post(*browsers_.calls,
             [feed = std::move(feed_)]() mutable { feed.reset(); });
}

template <class Stream>
void LivePage<Stream>::Run(const Request& request) {
  beast::get_lowest_layer(socket_).expires_never();
  socket_.set_option(websocket::stream_base::timeout{
      .handshake_timeout = std::chrono::seconds(limits::kBrowserPatienceS),
      .idle_timeout = std::chrono::seconds(6 * limits::kBrowserPatienceS),
      .keep_alive_pings = true});
  socket_.read_message_max(limits::kMaxPageMessageBytes);
  socket_.binary(true);
  socket_.async_accept(
      request, [self = this->shared_from_this()](error_code error) {
        if (error) return;
        const auto person = self->browsers_.doorkeeper.Find(self->cookie_);
        if (person == nullptr) return self->Close(kSignedOut, "signed out");
        self->feed_ = self->browsers_.doorkeeper.FeedOf(person);
        self->subscription_ = self->feed_->Subscribe(
            [weak = self->weak_from_this(), woken = self->woken_,
             waker = self->browsers_.waker] {
              if (woken->exchange(true)) return;
              waker->Post([weak, woken] {
                *woken = false;
                if (const auto page = weak.lock()) page->SendOrWait(false);
              });
            });
        self->Read();
      });
}

template <class Stream>
void LivePage<Stream>::Read() {
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
void LivePage<Stream>::OnRead() {
  const bool is_next = beast::buffers_to_string(incoming_.data()) == "next";
  incoming_.clear();
  if (!is_next) return Close(websocket::close_code::policy_error, "not next");
  if (AsksTooOften()) {
    return Close(websocket::close_code::policy_error, "too many messages");
  }
  asked_ = true;
  SendOrWait(false);
  Read();
}

template <class Stream>
bool LivePage<Stream>::AsksTooOften() {
  const auto now = std::chrono::steady_clock::now();
  if (now - asks_since_ >= std::chrono::seconds(1)) {
    asks_since_ = now;
    asks_ = 0;
  }
  return ++asks_ > limits::kMaxPageMessagesPerS;
}

template <class Stream>
void LivePage<Stream>::SendOrWait(bool even_if_old) {
  if (!asked_ || writing_ || closing_) return;
  if (browsers_.doorkeeper.Find(cookie_) == nullptr) {
    return Close(kSignedOut, "signed out");
  }
  if (feed_->IsRefused()) {
    browsers_.doorkeeper.SignOut(cookie_);
    return Close(kSignedOut, "the server refused the token");
  }
  if (even_if_old || feed_->HasNews(cursor_)) return Send();
  timer_.expires_after(kLongestSilence);
  timer_.async_wait([weak = this->weak_from_this()](error_code error) {
    if (error) return;
    if (const auto page = weak.lock()) page->SendOrWait(true);
  });
}

template <class Stream>
void LivePage<Stream>::Send() {
  asked_ = false;
  writing_ = true;
  timer_.cancel();
  outgoing_ = LiveMessage(feed_->Read(cursor_), RobotNews::Time::clock::now());
  socket_.async_write(
      asio::buffer(outgoing_),
      [self = this->shared_from_this()](error_code error, size_t) {
        self->writing_ = false;
        if (!error) self->SendOrWait(false);
      });
}

template <class Stream>
void LivePage<Stream>::Close(uint16_t code, const char* reason) {
  if (closing_) return;
  closing_ = true;
  timer_.cancel();
  socket_.async_close(
      websocket::close_reason(websocket::close_code(code), reason),
      [self = this->shared_from_this()](error_code) {});
}

template class LivePage<PlainStream>;
template class LivePage<TlsStream>;

}  // namespace tactus::internal::console
