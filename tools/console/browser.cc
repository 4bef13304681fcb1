#include "tools/console/browser.h"

#include <limits>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/limits_console.h"
#include "tools/console/foxglove_page.h"
#include "tools/console/foxglove_protocol.h"
#include "tools/console/import_request.h"
#include "tools/console/import_target.h"
#include "tools/console/live_page.h"
#include "tools/console/page_call.h"
#include "tools/console/request_checks.h"
#include "tools/console/responses.h"
#include "tools/console/watch_rights.h"
#include "tools/console/watch_socket.h"

namespace tactus::internal::console {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using asio::ip::tcp;
using boost::system::error_code;

constexpr std::chrono::seconds kPatience(limits::kBrowserPatienceS);

http::status StatusOf(const absl::Status& status) {
  switch (status.code()) {
    case absl::StatusCode::kUnauthenticated:
    case absl::StatusCode::kPermissionDenied:
      return http::status::unauthorized;
    default:
      return http::status::service_unavailable;
  }
}

// The token of a request to sign in; none if it is not one.
std::optional<std::string> TokenOf(const Request& request) {
  const auto json = client::Json::parse(request.body(), nullptr, false);
  if (!json.is_object()) return std::nullopt;
  const auto token = json.find("token");
  if (token == json.end() || !token->is_string()) return std::nullopt;
  const auto& text = token->get_ref<const std::string&>();
  const bool is_word =
      std::ranges::all_of(text, [](char c) { return c > ' ' && c <= '~'; });
  if (text.empty() || !is_word) return std::nullopt;
  return text;
}

template <class Stream>
class Browser : public std::enable_shared_from_this<Browser<Stream>> {
 public:
  Browser(Stream stream, Browsers* browsers)
      : stream_(std::move(stream)), browsers_(*browsers) {
    ++browsers_.connections;
  }
  ~Browser() { --browsers_.connections; }

  void Run() {
    if constexpr (std::is_same_v<Stream, TlsStream>) {
      Lowest().expires_after(kPatience);
      stream_.async_handshake(
          asio::ssl::stream_base::server,
          [self = this->shared_from_this()](error_code error) {
            if (!error) self->Read();
          });
    } else {
      Read();
    }
  }

 private:
  auto& Lowest() { return beast::get_lowest_layer(stream_); }

  void Read() {
    parser_.emplace();
    parser_->header_limit(limits::kMaxBrowserHeaderBytes);
    // How large a body may be depends on what it is for.
    parser_->body_limit(std::numeric_limits<uint64_t>::max());
    Lowest().expires_after(kPatience);
    http::async_read_header(
        stream_, buffer_, *parser_,
        [self = this->shared_from_this()](error_code error, size_t) {
          if (error) return self->OnRead(error);
          self->ReadBody();
        });
  }

  // Only who may call a server may send a large body.
  void ReadBody() {
    const auto target = parser_->get().target();
    if (IsImport({target.data(), target.size()})) {
      return ServeImport(std::move(stream_), std::move(buffer_),
                         {parser_->release(), parser_->content_length()},
                         &browsers_);
    }
    const uint64_t limit = MayCallServers() ? limits::kMaxPageCallBytes
                                            : limits::kMaxBrowserBodyBytes;
    parser_->body_limit(limit);
    const auto length = parser_->content_length();
    if (length && *length > limit) return BodyTooLarge();
    http::async_read(stream_, buffer_, *parser_,
                     [self = this->shared_from_this()](
                         error_code error, size_t) { self->OnRead(error); });
  }

  void BodyTooLarge() {
    Write(ErrorResponse(
              http::status::payload_too_large,
              absl::StrCat("a body has at most ", limits::kMaxBrowserBodyBytes,
                           " bytes, and that of a call at most ",
                           limits::kMaxPageCallBytes)),
          false);
  }

  void OnRead(error_code error) {
    if (error == http::error::body_limit) return BodyTooLarge();
    if (error) return Shutdown();
    const Request& request = parser_->get();
    if (!HasAllowedHost(request, browsers_.is_loopback)) {
      return Write(ErrorResponse(http::status::forbidden,
                                 "the console listens on this machine alone: "
                                 "address it as localhost"));
    }
    const std::string target(request.target());
    if (beast::websocket::is_upgrade(request)) return Upgrade();
    const bool reads = request.method() == http::verb::get ||
                       request.method() == http::verb::head;
    if (target == "/api/session" && reads) return Session();
    if (target == "/api/sign-in") return SignIn();
    if (target == "/api/sign-out") return SignOut();
    if (IsPageCall(target)) return CallServer(target);
    const PageFile* file = FindPageFile(browsers_.files, target);
    if (file == nullptr) {
      return Write(ErrorResponse(http::status::not_found, "no such page"));
    }
    if (!reads) return WrongMethod();
    Write(FileResponse(*file));
  }

  void WrongMethod() {
    Write(ErrorResponse(http::status::method_not_allowed, "no such method"));
  }

  void Upgrade() {
    const Request& request = parser_->get();
    if (PathOf(request) == "/foxglove") return UpgradeFoxglove();
    if (request.target() != "/api/live") {
      return Write(ErrorResponse(http::status::not_found, "no such page"));
    }
    if (!IsOwnOrigin(request)) {
      return Write(ErrorResponse(http::status::forbidden,
                                 "only the console's own page may watch"));
    }
    Watch(FindPerson(), std::make_unique<LivePage>());
  }

  void UpgradeFoxglove() {
    const Request& request = parser_->get();
    if (!IsLocalProgram(request, browsers_.is_loopback) ||
        browsers_.doorkeeper.is_open()) {
      return WatchAsFoxglove();
    }
    Ask("", [this](const absl::Status& status) {
      if (status.ok()) {
        browsers_.doorkeeper.Open();
      } else if (StatusOf(status) != http::status::unauthorized) {
        return Write(ErrorResponse(StatusOf(status), status.message()));
      }
      WatchAsFoxglove();
    });
  }

  void WatchAsFoxglove() {
    const Request& request = parser_->get();
    const auto person =
        FindWatcher(request, browsers_.doorkeeper, browsers_.is_loopback);
    if (person == nullptr) {
      return Write(ErrorResponse(
          http::status::forbidden,
          "take the address that the console's page Live copies for you; it "
          "is good until you sign out"));
    }
    const auto offered = request[http::field::sec_websocket_protocol];
    const std::string protocol =
        FoxgloveProtocolOf({offered.data(), offered.size()});
    if (protocol.empty()) {
      return Write(
          ErrorResponse(http::status::bad_request,
                        absl::StrCat("the subprotocol must be one of ",
                                     absl::StrJoin(kFoxgloveProtocols, ", "))));
    }
    Watch(person, std::make_unique<FoxglovePage>(browsers_.session), protocol);
  }

  void Watch(const Doorkeeper::Person& person, std::unique_ptr<Viewer> viewer,
             const std::string& protocol = "") {
    if (browsers_.live_pages >= limits::kMaxLivePages) {
      return Write(ErrorResponse(
          http::status::service_unavailable,
          absl::StrCat(limits::kMaxLivePages, " pages watch already")));
    }
    std::make_shared<WatchSocket<Stream>>(std::move(stream_), &browsers_,
                                          person, std::move(viewer))
        ->Run(parser_->get(), protocol);
  }

  void Session() {
    const auto person = FindPerson();
    if (person != nullptr) return Write(SessionResponse(person.get()));
    // Perhaps the servers want no token.
    Ask("", [this](const absl::Status& status) {
      if (status.ok()) browsers_.doorkeeper.Open();
      const auto everybody = browsers_.doorkeeper.Find("");
      Write(SessionResponse(everybody.get()));
    });
  }

  void SignIn() {
    const Request& request = parser_->get();
    if (request.method() != http::verb::post) return WrongMethod();
    if (!IsOwnOrigin(request)) return Forbidden();
    const auto token = TokenOf(request);
    if (!token) {
      return Write(ErrorResponse(http::status::bad_request,
                                 "a token is one word of ASCII"));
    }
    Ask(*token, [this, token = *token](const absl::Status& status) {
      if (!status.ok()) {
        return Write(ErrorResponse(StatusOf(status), status.message()));
      }
      // Whoever had set a cookie before does not know the new one.
      browsers_.doorkeeper.SignOut(CookieOf(parser_->get()));
      const std::string cookie = browsers_.doorkeeper.SignInWith(token);
      Response response =
          SessionResponse(browsers_.doorkeeper.Find(cookie).get());
      SetCookie(cookie, limits::kSignInHours * 3'600, response);
      Write(std::move(response));
    });
  }

  // True if it is the page of `person` that asks, and no other one.
  bool IsFrom(const Doorkeeper::Person& person) const {
    return person != nullptr && IsFromPage(parser_->get(), person->csrf);
  }

  bool MayCallServers() const {
    const Request& request = parser_->get();
    const auto target = request.target();
    return IsPageCall({target.data(), target.size()}) &&
           HasAllowedHost(request, browsers_.is_loopback) &&
           IsFrom(FindPerson());
  }

  void CallServer(const std::string& path) {
    const Request& request = parser_->get();
    if (request.method() != http::verb::post) return WrongMethod();
    if (!IsOwnOrigin(request)) return Forbidden();
    const auto person = FindPerson();
    if (person == nullptr) return Write(SignedOutResponse());
    if (!IsFrom(person)) return Forbidden();
    const auto target = FindPageMethod(path);
    if (!target) {
      return Write(ErrorResponse(http::status::not_found,
                                 "pages may not call such a method"));
    }
    // The calls have their own patience.
    Lowest().expires_never();
    RunPageCall({.browsers = &browsers_,
                 .executor = stream_.get_executor(),
                 .socket = Lowest().socket().native_handle(),
                 .cookie = CookieOf(request),
                 .target = *target,
                 .body = std::move(parser_->get().body())},
                [self = this->shared_from_this()](Response response) {
                  self->Write(std::move(response));
                });
  }

  Doorkeeper::Person FindPerson() const {
    return browsers_.doorkeeper.Find(CookieOf(parser_->get()));
  }

  void SignOut() {
    const Request& request = parser_->get();
    if (request.method() != http::verb::post) return WrongMethod();
    const std::string cookie = CookieOf(request);
    if (!IsFrom(browsers_.doorkeeper.Find(cookie))) return Forbidden();
    browsers_.doorkeeper.SignOut(cookie);
    Response response = EmptyResponse();
    SetCookie("", 0, response);
    Write(std::move(response));
  }

  void Forbidden() {
    Write(ErrorResponse(http::status::forbidden,
                        "only the console's own page may do that"));
  }

  // Asks the servers about a token, then calls `done` with the connection
  // alive.
  template <typename Done>
  void Ask(std::string token, Done done) {
    if (browsers_.token_checks >= limits::kMaxTokenChecks) {
      return Write(ErrorResponse(http::status::service_unavailable,
                                 "too many people sign in at once"));
    }
    ++browsers_.token_checks;
    // The servers have their own patience.
    Lowest().expires_never();
    asio::post(*browsers_.calls,
               [self = this->shared_from_this(), token = std::move(token),
                done = std::move(done)]() mutable {
                 Browsers& browsers = self->browsers_;
                 const absl::Status status = browsers.doorkeeper.Ask(token);
                 // The connection ends on the thread that serves browsers.
                 browsers.waker->Post(
                     [self = std::move(self), done = std::move(done), status] {
                       --self->browsers_.token_checks;
                       done(status);
                     });
               });
  }

  Response SessionResponse(const console::SignIn* person) const {
    client::Json servers = client::Json::array();
    for (const ServerAddress& server : browsers_.doorkeeper.servers()) {
      servers.push_back(server.address);
    }
    return JsonResponse(
        http::status::ok,
        {{"signed_in", person != nullptr},
         {"needs_token", !browsers_.doorkeeper.is_open()},
         {"csrf", person != nullptr ? person->csrf : ""},
         {"watch_key", person != nullptr ? person->watch_key : ""},
         {"servers", std::move(servers)}});
  }

  void SetCookie(const std::string& value, int seconds,
                 Response& response) const {
    response.set(http::field::set_cookie,
                 absl::StrCat(kCookieName, "=", value,
                              "; HttpOnly; SameSite=Strict; Path=/; Max-Age=",
                              seconds, browsers_.uses_tls ? "; Secure" : ""));
  }

  void Write(Response response, bool keep_alive = true) {
    const Request& request = parser_->get();
    keep_alive = keep_alive && request.keep_alive();
    response.keep_alive(keep_alive);
    response.prepare_payload();
    if (request.method() == http::verb::head) response.body().clear();
    response_ = std::move(response);
    Lowest().expires_after(kPatience);
    http::async_write(stream_, response_,
                      [self = this->shared_from_this(), keep_alive](
                          error_code error, size_t) {
                        if (error) return;
                        keep_alive ? self->Read() : self->Shutdown();
                      });
  }

  void Shutdown() {
    error_code ignored;
    Lowest().socket().shutdown(tcp::socket::shutdown_send, ignored);
  }

  Stream stream_;
  Browsers& browsers_;
  beast::flat_buffer buffer_{limits::kMaxBrowserHeaderBytes +
                             limits::kMaxBrowserBodyBytes};
  std::optional<http::request_parser<http::string_body>> parser_;
  Response response_;
};

}  // namespace

void ServeBrowser(tcp::socket socket, Browsers* browsers,
                  asio::ssl::context* tls) {
  PlainStream stream(std::move(socket));
  if (tls == nullptr) {
    std::make_shared<Browser<PlainStream>>(std::move(stream), browsers)->Run();
  } else {
    std::make_shared<Browser<TlsStream>>(TlsStream(std::move(stream), *tls),
                                         browsers)
        ->Run();
  }
}

}  // namespace tactus::internal::console
