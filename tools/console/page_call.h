// File: page_call.h
//
// RunPageCall: a call of a server for one request of a browser, as long as
// somebody waits for it.
//
//   RunPageCall({.browsers = &browsers, .executor = executor, .socket = socket,
//                .cookie = cookie, .target = target, .body = body},
//               [self](Response response) { self->Write(response); });
//
// Ends the call when the browser goes, and when the person signs out; then
// nobody gets the response. `done` comes once, unless the console ends before.
// For the thread that serves browsers. `browsers` must outlive the call, and
// `done` keeps the socket open.
#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <functional>
#include <string>

#include "tools/console/browsers.h"

namespace tactus::internal::console {

struct PageRequest {
  Browsers* browsers = nullptr;
  boost::asio::any_io_executor executor;
  int socket = -1;
  // That of a person who is signed in.
  std::string cookie;
  PageTarget target;
  std::string body;
};

void RunPageCall(PageRequest request, std::function<void(Response)> done);

// What somebody gets who is not signed in, or no longer.
Response SignedOutResponse();

}  // namespace tactus::internal::console
