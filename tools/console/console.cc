#include "tools/console/console.h"

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <optional>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/address.h"
#include "core/base/errors.h"
#include "core/base/limits_console.h"
#include "core/base/status_macros.h"
#include "tools/console/browser.h"
#include "tools/console/browsers.h"

namespace tactus::internal::console {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

constexpr int kCallThreads = 4;

absl::StatusOr<tcp::endpoint> EndpointOf(const ConsoleOptions& options) {
  TACTUS_ASSIGN_OR_RETURN(const HostPort at, ParseHostPort(options.listen));
  const std::string host = at.host == "localhost" ? "127.0.0.1" : at.host;
  error_code error;
  const auto ip = asio::ip::make_address(host, error);
  if (error) {
    return InvalidConfig("--listen", options.listen,
                         "a numeric address of this machine and a port, like "
                         "127.0.0.1:8080");
  }
  if (options.tls_certificate.empty() && !ip.is_loopback()) {
    return InvalidConfig("--listen", options.listen,
                         "an address of this machine alone, or given with "
                         "--tls-certificate and --tls-key, because tokens must "
                         "not leave this host unencrypted");
  }
  return tcp::endpoint(ip, static_cast<uint16_t>(at.port));
}

absl::Status ReadTls(const ConsoleOptions& options,
                     std::optional<asio::ssl::context>& tls) {
  if (options.tls_certificate.empty() != options.tls_key.empty()) {
    return InvalidConfig("--tls-certificate and --tls-key", "one alone",
                         "both or none");
  }
  if (options.tls_certificate.empty()) return absl::OkStatus();
  tls.emplace(asio::ssl::context::tls_server);
  tls->set_options(asio::ssl::context::default_workarounds |
                   asio::ssl::context::no_tlsv1 |
                   asio::ssl::context::no_tlsv1_1);
  error_code error;
  tls->use_certificate_chain_file(options.tls_certificate, error);
  if (error) return IoError(options.tls_certificate, error.message());
  tls->use_private_key_file(options.tls_key, asio::ssl::context::pem, error);
  if (error) return IoError(options.tls_key, error.message());
  return absl::OkStatus();
}

}  // namespace

class Console::Impl {
 public:
  Impl(ConsoleOptions options, PageFiles files)
      : browsers_{.files = std::move(files),
                  .doorkeeper = Doorkeeper(std::move(options.servers)),
                  .waker = std::make_shared<Waker>(&context_),
                  .calls = &calls_},
        page_calls_(browsers_.doorkeeper.servers(), &calls_, browsers_.waker),
        imports_(std::move(options.imports), &browsers_.doorkeeper,
                 browsers_.waker) {
    browsers_.page_calls = &page_calls_;
    browsers_.imports = &imports_;
  }

  ~Impl() {
    context_.stop();
    if (thread_.joinable()) thread_.join();
    browsers_.waker->Stop();
    imports_.Stop();
    page_calls_.Stop();
    calls_.join();
  }

  absl::Status Listen(const ConsoleOptions& options) {
    TACTUS_ASSIGN_OR_RETURN(const tcp::endpoint endpoint, EndpointOf(options));
    TACTUS_RETURN_IF_ERROR(ReadTls(options, tls_));
    browsers_.is_loopback = endpoint.address().is_loopback();
    browsers_.uses_tls = tls_.has_value();
    error_code error;
    acceptor_.open(endpoint.protocol(), error);
    if (!error) acceptor_.set_option(tcp::acceptor::reuse_address(true), error);
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(limits::kMaxBrowserConnections, error);
    if (!error) port_ = acceptor_.local_endpoint(error).port();
    if (error) {
      return IoError(
          options.listen,
          absl::StrCat("cannot listen for browsers: ", error.message()));
    }
    Accept();
    thread_ = std::thread([this] { context_.run(); });
    return absl::OkStatus();
  }

  int port() const { return port_; }

 private:
  void Accept() {
    acceptor_.async_accept([this](error_code error, tcp::socket socket) {
      // No descriptor is left: not at once again.
      if (error) return AcceptLater();
      if (browsers_.connections < limits::kMaxBrowserConnections) {
        ServeBrowser(std::move(socket), &browsers_, tls_ ? &*tls_ : nullptr);
      }
      Accept();
    });
  }
  void AcceptLater() {
    timer_.expires_after(std::chrono::seconds(1));
    timer_.async_wait([this](error_code) { Accept(); });
  }

  int port_ = 0;
  std::optional<asio::ssl::context> tls_;
  // Outlives the pages, whose feeds end there.
  asio::thread_pool calls_{kCallThreads};
  Browsers browsers_;
  PageCalls page_calls_;
  Imports imports_;
  asio::io_context context_{1};
  tcp::acceptor acceptor_{context_};
  asio::steady_timer timer_{context_};
  std::thread thread_;
};

Console::Console(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Console::~Console() = default;

absl::StatusOr<std::unique_ptr<Console>> Console::Start(
    ConsoleOptions options) {
  if (options.servers.empty() ||
      options.servers.size() > limits::kMaxConsoleServers) {
    return InvalidConfig("servers of the console", options.servers.size(),
                         absl::StrCat("1 to ", limits::kMaxConsoleServers));
  }
  TACTUS_ASSIGN_OR_RETURN(PageFiles files, ReadPageFiles(options.page));
  auto impl = std::make_unique<Impl>(options, std::move(files));
  TACTUS_RETURN_IF_ERROR(impl->Listen(options));
  return std::unique_ptr<Console>(new Console(std::move(impl)));
}

int Console::port() const { return impl_->port(); }

}  // namespace tactus::internal::console
