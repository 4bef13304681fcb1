#include "tools/trainctl/remote/tls_probe.h"

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>
#include <openssl/x509_vfy.h>

#include <memory>

#include "absl/strings/str_cat.h"

namespace tactus::internal::client {
namespace {

template <typename Type, void (*kFree)(Type*)>
struct Deleter {
  void operator()(Type* object) const { kFree(object); }
};
template <typename Type, void (*kFree)(Type*)>
using Owned = std::unique_ptr<Type, Deleter<Type, kFree>>;

// "host" of "host:port" and of "[::1]:port".
std::string HostOf(const std::string& address) {
  const std::string host = address.substr(0, address.rfind(':'));
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') {
    return host.substr(1, host.size() - 2);
  }
  return host;
}

absl::Status Unreachable(const std::string& address, const char* what) {
  char text[256] = "";
  ERR_error_string_n(ERR_get_error(), text, sizeof text);
  return absl::UnavailableError(absl::StrCat(address, ": ", what, ": ", text));
}

// Lets `context` trust the certificates of a PEM text.
void Trust(SSL_CTX* context, const std::string& roots) {
  const Owned<BIO, BIO_free_all> text(
      BIO_new_mem_buf(roots.data(), static_cast<int>(roots.size())));
  while (true) {
    const Owned<X509, X509_free> certificate(
        PEM_read_bio_X509(text.get(), nullptr, nullptr, nullptr));
    if (certificate == nullptr) break;
    X509_STORE_add_cert(SSL_CTX_get_cert_store(context), certificate.get());
  }
  ERR_clear_error();
}

}  // namespace

absl::StatusOr<TlsProbe> ProbeTls(const std::string& address,
                                  const std::string& roots) {
  const Owned<SSL_CTX, SSL_CTX_free> context(SSL_CTX_new(TLS_client_method()));
  Trust(context.get(), roots);
  // The certificate is judged after the handshake, not in it.
  SSL_CTX_set_verify(context.get(), SSL_VERIFY_NONE, nullptr);
  // The chain owns the SSL object.
  const Owned<BIO, BIO_free_all> chain(BIO_new_ssl_connect(context.get()));
  SSL* ssl = nullptr;
  BIO_get_ssl(chain.get(), &ssl);
  const std::string host = HostOf(address);
  // An address of the internet is a name of another kind.
  X509_VERIFY_PARAM* wanted = SSL_get0_param(ssl);
  if (X509_VERIFY_PARAM_set1_ip_asc(wanted, host.c_str()) != 1) {
    ERR_clear_error();
    SSL_set_tlsext_host_name(ssl, host.c_str());
    SSL_set1_host(ssl, host.c_str());
  }
  constexpr unsigned char kProtocol[] = {2, 'h', '2'};
  SSL_set_alpn_protos(ssl, kProtocol, sizeof kProtocol);
  BIO_set_conn_hostname(chain.get(), address.c_str());
  if (BIO_do_connect(chain.get()) != 1) {
    return Unreachable(address, "no TLS connection");
  }
  const Owned<X509, X509_free> certificate(SSL_get1_peer_certificate(ssl));
  if (certificate == nullptr) return Unreachable(address, "no certificate");
  TlsProbe probe;
  if (const long verdict = SSL_get_verify_result(ssl); verdict != X509_V_OK) {
    probe.fault = X509_verify_cert_error_string(verdict);
  }
  int seconds = 0;
  ASN1_TIME_diff(&probe.days_left, &seconds, nullptr,
                 X509_get0_notAfter(certificate.get()));
  return probe;
}

}  // namespace tactus::internal::client
