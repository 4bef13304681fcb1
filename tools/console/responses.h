// File: responses.h
//
// Responses to browsers. All of them forbid that the page loads or sends
// anything elsewhere, or is shown inside of another one.
//
//   Response response = JsonResponse(http::status::ok, json);
//   response.set(http::field::set_cookie, cookie);
//
// Thread-safe: free functions without state.
#pragma once

#include <boost/beast/http.hpp>
#include <string>

#include "absl/strings/string_view.h"
#include "tools/common/json.h"
#include "tools/console/page_files.h"

namespace tactus::internal::console {

namespace http = boost::beast::http;
using Request = http::request<http::string_body>;
using Response = http::response<http::string_body>;

Response FileResponse(const PageFile& file);
Response JsonResponse(http::status status, const client::Json& json);
// Text that is JSON already.
Response JsonTextResponse(std::string json);
// {"error": text}.
Response ErrorResponse(http::status status, absl::string_view text);
// Without a body.
Response EmptyResponse();

}  // namespace tactus::internal::console
