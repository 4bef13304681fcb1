// File: request_checks.h
//
// Whether a request comes from the console's own page, and whether somebody
// still waits for the response.
//
//   if (!HasAllowedHost(request, is_loopback)) return Forbidden();
//   if (!IsOwnOrigin(request)) return Forbidden();
//   const std::string cookie = CookieOf(request);
//
//   if (HasGone(socket)) return Cancel();
//
// Thread-safe: free functions without state.
#pragma once

#include <optional>
#include <string>

#include "absl/strings/string_view.h"
#include "tools/console/responses.h"

namespace tactus::internal::console {

// False if a console listens on this machine alone and the browser took
// another name for it: a page elsewhere could have that name point here.
bool HasAllowedHost(const Request& request, bool is_loopback);

// True if the header "Origin" names the host that the request is for. Browsers
// add it to requests that change something and to those of WebSockets.
bool IsOwnOrigin(const Request& request);

// True if the request has such a header: a browser's page made it, or a program
// that looks like one.
bool HasOrigin(const Request& request);

// The path of a request without what follows a question mark.
absl::string_view PathOf(const Request& request);

// What a request gives as "key" behind the question mark; none if it does not.
std::optional<std::string> WatchKeyOf(const Request& request);

// True if it is also the page of the person whose sign-in has this secret
// (SignIn::csrf).
bool IsFromPage(const Request& request, absl::string_view csrf);

constexpr char kCookieName[] = "tactus";

// True if the other side has closed the connection, also if it said something
// before that nobody has read.
bool HasGone(int socket);

// The value of the console's cookie; empty if there is none.
std::string CookieOf(const Request& request);

}  // namespace tactus::internal::console
