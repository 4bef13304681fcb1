// File: watch_socket.h
//
// WatchSocket: the WebSocket of somebody who watches robots. One message is on
// its way at a time; when it is gone, the viewer says what comes next. So a
// slow browser delays nothing and holds nothing up.
//
//   std::make_shared<WatchSocket<Stream>>(std::move(stream), &browsers, person,
//                                         std::make_unique<LivePage>())
//       ->Run(request);
//
// It ends when the sign-in does, and if too much comes from the other side.
// Kept alive by what it waits for; for the thread that serves browsers.
// `browsers` must outlive it.
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
#include "tools/console/viewer.h"

namespace tactus::internal::console {

using PlainStream = boost::beast::tcp_stream;
using TlsStream = boost::beast::ssl_stream<boost::beast::tcp_stream>;

template <class Stream>
class WatchSocket : public std::enable_shared_from_this<WatchSocket<Stream>> {
 public:
  // `person` may be null: then the other side hears that nobody is signed in.
  WatchSocket(Stream stream, Browsers* browsers, Doorkeeper::Person person,
              std::unique_ptr<Viewer> viewer);
  ~WatchSocket();

  // `protocol`: the subprotocol that was agreed on; empty without one.
  void Run(const Request& request, const std::string& protocol = "");

 private:
  void Open();
  void Read();
  void OnRead();
  // True if more comes than there is a reason for.
  bool HearsTooMuch();
  // Sends the next message, if there is one; otherwise waits for it.
  void SendOrWait(bool even_if_old);
  void Send(Viewer::Message message);
  void Close(uint16_t code, const std::string& reason);

  boost::beast::websocket::stream<Stream> socket_;
  Browsers& browsers_;
  const Doorkeeper::Person person_;
  const std::unique_ptr<Viewer> viewer_;
  std::shared_ptr<LiveFeed> feed_;
  int subscription_ = 0;
  // True while a call of SendOrWait is on its way.
  std::shared_ptr<std::atomic<bool>> woken_;
  boost::beast::flat_buffer incoming_;
  std::string outgoing_;
  boost::asio::steady_timer timer_;
  bool writing_ = false;
  bool closing_ = false;
  int heard_ = 0;
  std::chrono::steady_clock::time_point heard_since_;
};

extern template class WatchSocket<PlainStream>;
extern template class WatchSocket<TlsStream>;

}  // namespace tactus::internal::console
