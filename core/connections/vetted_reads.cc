// The functions with which gRPC reads, opens and closes a connection. gRPC's
// library finds these instead of libc's and OpenSSL's, because the program
// comes first in the search for a name (ELF symbol interposition). Each does
// what the original does, for every descriptor.
#include "core/connections/vetted_reads.h"

#include <dlfcn.h>
#include <openssl/err.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>

namespace {

// False at a fault.
bool PassesAll(int fd, const msghdr& message, size_t size) {
  for (size_t i = 0; i < message.msg_iovlen && size > 0; ++i) {
    const iovec& part = message.msg_iov[i];
    const size_t bytes = std::min(size, part.iov_len);
    if (!tactus::internal::vetted_reads::Passes(
            fd, static_cast<const uint8_t*>(part.iov_base), bytes)) {
      return false;
    }
    size -= bytes;
  }
  return true;
}

}  // namespace

extern "C" {

ssize_t recvmsg(int fd, msghdr* message, int flags) {
  // What follows a fault stays in the kernel.
  if (tactus::internal::vetted_reads::HasFault(fd)) return 0;
  const ssize_t size = syscall(SYS_recvmsg, fd, message, flags);
  if (size <= 0 || (flags & MSG_ERRQUEUE) != 0 ||
      !tactus::internal::vetted_reads::IsVetted(fd)) {
    return size;
  }
  if (PassesAll(fd, *message, static_cast<size_t>(size))) return size;
  // To gRPC the peer has closed; to the peer the connection has ended.
  shutdown(fd, SHUT_RDWR);
  return 0;
}

int connect(int fd, const sockaddr* address, socklen_t length) {
  tactus::internal::vetted_reads::Opened(fd);
  return static_cast<int>(syscall(SYS_connect, fd, address, length));
}

int close(int fd) {
  tactus::internal::vetted_reads::Closed(fd);
  return static_cast<int>(syscall(SYS_close, fd));
}

int SSL_read(SSL* ssl, void* buffer, int size) {
  using Function = int (*)(SSL*, void*, int);
  static const auto original =
      reinterpret_cast<Function>(dlsym(RTLD_NEXT, "SSL_read"));
  const int got = original(ssl, buffer, size);
  if (got <= 0 ||
      tactus::internal::vetted_reads::Passes(
          ssl, static_cast<const uint8_t*>(buffer), static_cast<size_t>(got))) {
    return got;
  }
  // Makes SSL_get_error return SSL_ERROR_SSL.
  ERR_raise(ERR_LIB_USER, ERR_R_PASSED_INVALID_ARGUMENT);
  return -1;
}

}  // extern "C"
