#include "server/metrics/metrics_listener.h"

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <optional>
#include <thread>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "prometheus/text_serializer.h"
#include "server/metrics/open_metrics.h"

namespace tactus::internal::server {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using asio::ip::tcp;
using boost::system::error_code;

constexpr char kTextType[] = "text/plain; version=0.0.4; charset=utf-8";
constexpr std::chrono::seconds kPatience(2);
constexpr uint32_t kMostRequestBytes = 8 * 1024;

absl::StatusOr<tcp::endpoint> ParseAddress(const std::string& address) {
  const size_t colon = address.rfind(':');
  std::string host =
      colon == std::string::npos ? "127.0.0.1" : address.substr(0, colon);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') {
    host = host.substr(1, host.size() - 2);
  }
  int port = -1;
  error_code error;
  const auto ip = asio::ip::make_address(host, error);
  const bool is_number = absl::SimpleAtoi(address.substr(colon + 1), &port);
  if (error || !is_number || port < 0 || port > 65535) {
    return InvalidConfig("--metrics", Quoted(address),
                         "IP:port, or a port of 127.0.0.1");
  }
  return tcp::endpoint(ip, static_cast<uint16_t>(port));
}

using Response = http::response<http::string_body>;

Response Answer(const http::request<http::empty_body>& request,
                const MetricsListener::Collect& collect) {
  Response response(http::status::ok, 11);
  response.set(http::field::cache_control, "no-store");
  response.set(http::field::content_type, "text/plain");
  response.keep_alive(false);
  if (request.method() != http::verb::get &&
      request.method() != http::verb::head) {
    response.result(http::status::method_not_allowed);
    response.body() = "only GET /metrics\n";
  } else if (request.target() != "/metrics") {
    response.result(http::status::not_found);
    response.body() = "only /metrics is here\n";
  } else if (request[http::field::accept].find(
                 "application/openmetrics-text") != beast::string_view::npos) {
    response.set(http::field::content_type, kOpenMetricsType);
    response.body() = OpenMetricsText(collect());
  } else {
    response.set(http::field::content_type, kTextType);
    response.body() = prometheus::TextSerializer().Serialize(collect());
  }
  response.prepare_payload();
  if (request.method() == http::verb::head) response.body().clear();
  return response;
}

// One connection, which carries one request. Kept alive by what it waits for.
class Exchange : public std::enable_shared_from_this<Exchange> {
 public:
  Exchange(tcp::socket socket, const MetricsListener::Collect& collect,
           int* open)
      : stream_(std::move(socket)), collect_(collect), open_(open) {
    ++*open_;
    parser_.header_limit(kMostRequestBytes);
    parser_.body_limit(0);
  }
  ~Exchange() { --*open_; }

  void Run() {
    stream_.expires_after(kPatience);
    http::async_read(stream_, buffer_, parser_,
                     [self = shared_from_this()](error_code error, size_t) {
                       if (!error) self->Reply();
                     });
  }

 private:
  void Reply() {
    response_ = Answer(parser_.get(), collect_);
    stream_.expires_after(kPatience);
    http::async_write(
        stream_, response_, [self = shared_from_this()](error_code, size_t) {
          error_code ignored;
          self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
        });
  }

  beast::tcp_stream stream_;
  const MetricsListener::Collect& collect_;
  int* const open_;
  beast::flat_buffer buffer_{kMostRequestBytes};
  http::request_parser<http::empty_body> parser_;
  Response response_;
};

}  // namespace

class MetricsListener::Impl {
 public:
  explicit Impl(Collect collect) : collect_(std::move(collect)) {}
  ~Impl() {
    context_.stop();
    if (thread_.joinable()) thread_.join();
  }

  absl::Status Listen(const tcp::endpoint& endpoint) {
    error_code error;
    acceptor_.open(endpoint.protocol(), error);
    if (!error) acceptor_.set_option(tcp::acceptor::reuse_address(true), error);
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(kMaxConnections, error);
    if (!error) port_ = acceptor_.local_endpoint(error).port();
    if (error) {
      return IoError(
          absl::StrCat(endpoint.address().to_string(), ":", endpoint.port()),
          absl::StrCat("cannot listen for metrics: ", error.message()));
    }
    Accept();
    thread_ = std::thread([this] { context_.run(); });
    return absl::OkStatus();
  }

  int port() const { return port_; }

 private:
  void Accept() {
    acceptor_.async_accept([this](error_code error, tcp::socket socket) {
      if (!error && open_ < kMaxConnections) {
        std::make_shared<Exchange>(std::move(socket), collect_, &open_)->Run();
      } else if (error) {
        // No descriptor is left: not at once again.
        return AcceptLater();
      }
      Accept();
    });
  }
  void AcceptLater() {
    timer_.expires_after(std::chrono::seconds(1));
    timer_.async_wait([this](error_code) { Accept(); });
  }

  const Collect collect_;
  int open_ = 0;
  int port_ = 0;
  asio::io_context context_{1};
  tcp::acceptor acceptor_{context_};
  asio::steady_timer timer_{context_};
  std::thread thread_;
};

MetricsListener::MetricsListener(std::unique_ptr<Impl> impl)
    : impl_(std::move(impl)) {}
MetricsListener::~MetricsListener() = default;

absl::StatusOr<std::unique_ptr<MetricsListener>> MetricsListener::Start(
    const std::string& address, Collect collect) {
  TACTUS_ASSIGN_OR_RETURN(const auto endpoint, ParseAddress(address));
  auto impl = std::make_unique<Impl>(std::move(collect));
  TACTUS_RETURN_IF_ERROR(impl->Listen(endpoint));
  return std::unique_ptr<MetricsListener>(new MetricsListener(std::move(impl)));
}

int MetricsListener::port() const { return impl_->port(); }

}  // namespace tactus::internal::server
