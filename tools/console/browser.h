// File: browser.h
//
// Serves one connection of a browser: the page's files, who is signed in, and
// the WebSockets of those who watch.
//
//   ServeBrowser(std::move(socket), &browsers, tls);  // tls: null for none
//
//   GET  /api/session   who is signed in, and the names of the servers
//   POST /api/sign-in   {"token": "..."}; sets the cookie
//   POST /api/sign-out  with the header X-CSRF-Token
//   GET  /api/live      a WebSocket (live_page.h)
//   GET  /foxglove?key=<key>
//                       a WebSocket (foxglove_page.h). The key is that of a
//                       sign-in; with it, the request may come from anywhere.
//                       The console's own page needs none, nor does a program
//                       on the console's host that is no browser, if the
//                       servers want no token.
//   POST /api/servers/<number>/<Service>/<Method>
//                       a call of a server (page_methods.h), with the header
//                       X-CSRF-Token; message and response as JSON
//   POST /api/import/<server>/<step>
//                       files that become trials (import_target.h)
//
// For the thread that serves browsers. `browsers` and `tls` must outlive the
// connection, which keeps itself alive.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>

#include "tools/console/browsers.h"

namespace tactus::internal::console {

void ServeBrowser(boost::asio::ip::tcp::socket socket, Browsers* browsers,
                  boost::asio::ssl::context* tls);

}  // namespace tactus::internal::console
