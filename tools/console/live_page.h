// File: live_page.h
//
// LivePage: the WebSocket of a page that watches robots. The page asks for each
// message, so that a slow one delays nothing and holds nothing up: it gets what
// is newest when it has time for it.
//
//   std::make_shared<LivePage<Stream>>(std::move(stream), &browsers, cookie)
//       ->Run(request);
//
// The page sends "next"; the answer comes when there is something new, or after
// a second. Other messages, and too many, end the connection. Kept alive by
// what it waits for; for the thread that serves browsers. `browsers` must
// outlive it.
#pragma once

#include <atomic>
#include <boost/asio/ssl/stream.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/ssl.hpp>
#include <boost/beast/websocket.hpp>
#include <memory>
#include <string>

#include "tools/console/browsers.h"
#include "tools/console/responses.h"

namespace tactus::internal::console {

using PlainStream = boost::beast::tcp_stream;
using TlsStream = boost::beast::ssl_stream<boost::beast::tcp_stream>;

template <class Stream>
class LivePage : public std::enable_shared_from_this<LivePage<Stream>> {
 public:
  LivePage(Stream stream, Browsers* browsers, std::string cookie);
  ~LivePage();

  void Run(const Request& request);

 private:
  void Read();
  void OnRead();
  // True if the page sends more than it has a reason to.
  bool AsksTooOften();
  // Sends what is new, if the page has asked and there is something; otherwise
  // waits for it.
  void SendOrWait(bool even_if_old);
  void Send();
  void Close(uint16_t code, const char* reason);

  boost::beast::websocket::stream<Stream> socket_;
  Browsers& browsers_;
  const std::string cookie_;
  std::shared_ptr<LiveFeed> feed_;
  int subscription_ = 0;
  // True while a call of SendOrWait is on its way.
  std::shared_ptr<std::atomic<bool>> woken_;
  LiveFeed::Cursor cursor_;
  boost::beast::flat_buffer incoming_;
  std::string outgoing_;
  boost::asio::steady_timer timer_;
  bool asked_ = false;
  bool writing_ = false;
  bool closing_ = false;
  int asks_ = 0;
  std::chrono::steady_clock::time_point asks_since_;
};

extern template class LivePage<PlainStream>;
extern template class LivePage<TlsStream>;

}  // namespace tactus::internal::console
