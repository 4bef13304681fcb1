#include "core/connections/vetted_connections.h"

#include <sys/socket.h>

#include <array>
#include <atomic>
#include <mutex>

#include "core/base/limits_http2.h"
#include "core/connections/vetted_reads.h"

namespace tactus::internal {
namespace {

// The first byte of a TLS record that begins a connection: a handshake or an
// alert. HTTP/2 begins with the length of a SETTINGS frame, far below.
constexpr uint8_t kTlsAlert = 21;
constexpr uint8_t kTlsHandshake = 22;

struct Connection {
  explicit Connection(Http2Vet::Peer peer)
      : vet(peer), may_be_tls(peer == Http2Vet::Peer::kServer) {}

  Http2Vet vet;
  // Whether it is TLS shows in the first byte of a server.
  bool may_be_tls;
  bool is_tls = false;
  bool has_fault = false;
};

VettedConnections::Options options;
std::atomic<bool> started = false;
std::atomic<uint64_t> vetted_bytes = 0;
// By descriptor. The kernel gives memory to the pages that are used.
std::array<std::atomic<Connection*>, limits::kMaxVettedDescriptors> table;

std::atomic<Connection*>* Find(int fd) {
  return fd >= 0 && fd < limits::kMaxVettedDescriptors ? &table[fd] : nullptr;
}

Connection* Get(int fd) {
  const auto* entry = Find(fd);
  return entry == nullptr ? nullptr : entry->load(std::memory_order_acquire);
}

void Set(int fd, Connection* connection) {
  if (auto* entry = Find(fd)) {
    delete entry->exchange(connection, std::memory_order_acq_rel);
  }
}

// False at the first fault, which it reports.
bool Check(Http2Vet& vet, int fd, const uint8_t* bytes, size_t size) {
  vetted_bytes.fetch_add(size, std::memory_order_relaxed);
  const absl::string_view fault = vet.Check({bytes, size}, options.now_ns());
  if (fault.empty()) return true;
  options.on_fault(fd, fault);
  return false;
}

void DeleteVet(void*, void* vet, CRYPTO_EX_DATA*, int, long, void*) {
  delete static_cast<Http2Vet*>(vet);
}

int VetIndex() {
  static const int index =
      SSL_get_ex_new_index(0, nullptr, nullptr, nullptr, DeleteVet);
  return index;
}

// Over TLS, gRPC agrees on "h2" with its peer; others that use OpenSSL do not.
bool SpeaksHttp2(SSL* ssl) {
  const unsigned char* protocol = nullptr;
  unsigned int size = 0;
  SSL_get0_alpn_selected(ssl, &protocol, &size);
  return absl::string_view(reinterpret_cast<const char*>(protocol), size) ==
         "h2";
}

}  // namespace

void VettedConnections::Start(const Options& given) {
  static std::once_flag once;
  std::call_once(once, [&given] {
    options = given;
    VetIndex();
    started = true;
  });
}

bool VettedConnections::Add(int fd) {
  if (Find(fd) == nullptr) return false;
  Set(fd, new Connection(Http2Vet::Peer::kClient));
  return true;
}

uint64_t VettedConnections::bytes() { return vetted_bytes; }

namespace vetted_reads {

void Opened(int fd) {
  if (started && options.connects) {
    Set(fd, new Connection(Http2Vet::Peer::kServer));
  }
}

void Closed(int fd) {
  if (Get(fd) != nullptr) Set(fd, nullptr);
}

bool IsVetted(int fd) { return Get(fd) != nullptr; }

bool HasFault(int fd) {
  const Connection* connection = Get(fd);
  return connection != nullptr && connection->has_fault;
}

bool Passes(int fd, const uint8_t* bytes, size_t size) {
  Connection* connection = Get(fd);
  if (connection == nullptr || size == 0) return true;
  if (connection->may_be_tls) {
    connection->may_be_tls = false;
    connection->is_tls = *bytes == kTlsHandshake || *bytes == kTlsAlert;
  }
  if (connection->is_tls) return true;
  if (connection->has_fault) return false;
  connection->has_fault = !Check(connection->vet, fd, bytes, size);
  return !connection->has_fault;
}

bool Passes(SSL* ssl, const uint8_t* bytes, size_t size) {
  const bool server = SSL_is_server(ssl) == 1;
  if (!started || !(server ? options.accepts : options.connects)) return true;
  auto* vet = static_cast<Http2Vet*>(SSL_get_ex_data(ssl, VetIndex()));
  if (vet == nullptr) {
    if (!SpeaksHttp2(ssl)) return true;
    vet = new Http2Vet(server ? Http2Vet::Peer::kClient
                              : Http2Vet::Peer::kServer);
    if (SSL_set_ex_data(ssl, VetIndex(), vet) != 1) {
      delete vet;
      return false;
    }
  }
  return Check(*vet, -1, bytes, size);
}

}  // namespace vetted_reads
}  // namespace tactus::internal
