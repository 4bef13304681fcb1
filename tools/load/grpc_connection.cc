#include "tools/load/grpc_connection.h"

#include <array>
#include <optional>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "boost/asio/connect.hpp"
#include "boost/asio/ip/tcp.hpp"
#include "boost/asio/ssl/host_name_verification.hpp"
#include "boost/asio/ssl/stream.hpp"
#include "boost/asio/write.hpp"
#include "core/base/address.h"
#include "tools/load/http2_calls.h"

namespace tactus::internal::client {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;
using Socket = asio::generic::stream_protocol::socket;

// Bytes that are read, and about as many that are written, at once.
constexpr size_t kReadBytes = 16 * 1024;
constexpr size_t kWriteBytes = 64 * 1024;

std::string AuthorityOf(const ServerPlace& place) {
  // HTTP has no words for a socket's path.
  return IsUnixAddress(place.address) ? "localhost" : place.address;
}

}  // namespace

class GrpcConnection::Link final : public ConnectionLoop::Connection,
                                   public std::enable_shared_from_this<Link> {
 public:
  Link(ConnectionLoop* loop, const ServerPlace& place)
      : loop_(loop),
        place_(place),
        socket_(loop->io()),
        calls_(AuthorityOf(place), place.tls ? "https" : "http",
               [this] { Touch(); }) {
    if (place_.tls) tls_.emplace(socket_, *place_.tls);
  }

  void Connect() {
    asio::async_connect(
        socket_, place_.endpoints,
        [self = shared_from_this()](const error_code& error, const auto&) {
          self->OnConnected(error);
        });
  }
  void Close() {
    closed_ = true;
    error_code ignored;
    socket_.close(ignored);
  }

  Http2Calls& calls() { return calls_; }

  void Flush() override {
    touched_ = false;
    if (!ready_ || writing_ || closed_) return;
    outgoing_.clear();
    if (const auto status = calls_.Collect(kWriteBytes, &outgoing_);
        !status.ok()) {
      return Fail(status);
    }
    if (outgoing_.empty()) return;
    writing_ = true;
    const auto written = [self = shared_from_this()](const error_code& error,
                                                     size_t) {
      self->writing_ = false;
      if (error) return self->Fail(error);
      self->Touch();
    };
    if (tls_) {
      asio::async_write(*tls_, asio::buffer(outgoing_), written);
    } else {
      asio::async_write(socket_, asio::buffer(outgoing_), written);
    }
  }

 private:
  void Touch() {
    if (!std::exchange(touched_, true)) loop_->Touch(shared_from_this());
  }

  void OnConnected(const error_code& error) {
    if (error) return Fail(error);
    error_code is_unix;
    socket_.set_option(asio::ip::tcp::no_delay(true), is_unix);
    if (!tls_) return OnReady();
    SSL_set_tlsext_host_name(tls_->native_handle(), place_.host.c_str());
    error_code failed;
    tls_->set_verify_callback(asio::ssl::host_name_verification(place_.host),
                              failed);
    if (failed) return Fail(failed);
    tls_->async_handshake(asio::ssl::stream_base::client,
                          [self = shared_from_this()](const error_code& wrong) {
                            if (wrong) return self->Fail(wrong);
                            self->OnReady();
                          });
  }

  void OnReady() {
    ready_ = true;
    Touch();
    Read();
  }

  void Read() {
    const auto came = [self = shared_from_this()](const error_code& error,
                                                  size_t size) {
      self->OnRead(error, size);
    };
    if (tls_) {
      tls_->async_read_some(asio::buffer(incoming_), came);
    } else {
      socket_.async_read_some(asio::buffer(incoming_), came);
    }
  }

  void OnRead(const error_code& error, size_t size) {
    if (error) return Fail(error);
    if (closed_) return;
    const absl::string_view bytes(incoming_.data(), size);
    if (const auto status = calls_.Receive(bytes); !status.ok()) {
      return Fail(status);
    }
    Read();
  }

  void Fail(const error_code& error) {
    Fail(absl::UnavailableError(
        absl::StrCat(place_.address, ": ", error.message())));
  }
  void Fail(const absl::Status& status) {
    if (closed_) return;
    Close();
    calls_.Fail(status);
  }

  ConnectionLoop* const loop_;
  const ServerPlace place_;
  Socket socket_;
  std::optional<asio::ssl::stream<Socket&>> tls_;
  Http2Calls calls_;
  std::array<char, kReadBytes> incoming_;
  std::string outgoing_;
  // The socket, and TLS if there is some, are connected.
  bool ready_ = false;
  bool writing_ = false;
  bool touched_ = false;
  bool closed_ = false;
};

GrpcConnection::GrpcConnection(ConnectionLoop* loop, const ServerPlace& place)
    : link_(std::make_shared<Link>(loop, place)) {
  link_->Connect();
}

GrpcConnection::~GrpcConnection() { link_->Close(); }

void GrpcConnection::Start(GrpcCall* call) { link_->calls().Start(call); }

bool GrpcConnection::takes_calls() const {
  return link_->calls().takes_calls();
}

}  // namespace tactus::internal::client
