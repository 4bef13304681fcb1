#include "tools/console/responses.h"

#include <utility>

namespace tactus::internal::console {
namespace {

constexpr char kContentPolicy[] =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' "
    "data: blob:; connect-src 'self'; base-uri 'none'; form-action 'self'; "
    "frame-ancestors 'none'";

Response NewResponse(http::status status) {
  Response response(status, 11);
  response.set("Content-Security-Policy", kContentPolicy);
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Referrer-Policy", "no-referrer");
  response.set("Cross-Origin-Opener-Policy", "same-origin");
  response.set("Cross-Origin-Resource-Policy", "same-origin");
  response.set(http::field::cache_control, "no-store");
  return response;
}

}  // namespace

Response FileResponse(const PageFile& file) {
  Response response = NewResponse(http::status::ok);
  response.set(http::field::content_type, file.content_type);
  response.body() = file.bytes;
  return response;
}

Response JsonResponse(http::status status, const client::Json& json) {
  Response response = NewResponse(status);
  response.set(http::field::content_type, "application/json");
  response.body() = client::JsonText(json);
  return response;
}

Response JsonTextResponse(std::string json) {
  Response response = NewResponse(http::status::ok);
  response.set(http::field::content_type, "application/json");
  response.body() = std::move(json);
  return response;
}

Response ErrorResponse(http::status status, absl::string_view text) {
  return JsonResponse(status, {{"error", std::string(text)}});
}

Response EmptyResponse() { return NewResponse(http::status::no_content); }

}  // namespace tactus::internal::console
