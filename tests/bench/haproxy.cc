#include "tests/bench/haproxy.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <sstream>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "tests/bench/child_server.h"

namespace tactus::internal::client {
namespace {

constexpr char kProgram[] = "/usr/sbin/haproxy";
// Those of deploy/haproxy.cfg.
constexpr char kItsPort[] = "\"${TACTUS_BIND}:50051\"";
constexpr char kItsServer[] = "127.0.0.1:50052";

sockaddr_in LoopbackAddress(int port) {
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

bool Accepts(int port) {
  const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address = LoopbackAddress(port);
  const bool accepted =
      connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0;
  close(fd);
  return accepted;
}

}  // namespace

bool Haproxy::Installed() { return access(kProgram, X_OK) == 0; }

absl::StatusOr<std::unique_ptr<Haproxy>> Haproxy::Start(
    const std::string& backend) {
  std::ostringstream text;
  text << std::ifstream(TACTUS_HAPROXY_CFG).rdbuf();
  const int port = FreePort();
  std::string configuration = text.str();
  if (absl::StrReplaceAll(
          {{kItsPort, absl::StrCat("127.0.0.1:", port)}, {kItsServer, backend}},
          &configuration) < 2) {
    return IoError(TACTUS_HAPROXY_CFG, absl::StrCat("names ", kItsPort, " and ",
                                                    kItsServer, " no more"));
  }
  TACTUS_ASSIGN_OR_RETURN(TemporaryFolder folder, TemporaryFolder::Create());
  std::string file = folder.path() + "/haproxy.cfg";
  if (!(std::ofstream(file) << configuration).flush()) {
    return IoError(file, std::strerror(errno));
  }
  std::unique_ptr<Haproxy> proxy(new Haproxy(std::move(folder)));
  std::string program = kProgram;
  std::string no_children = "-db";
  std::string option = "-f";
  char* const argv[] = {program.data(), no_children.data(), option.data(),
                        file.data(), nullptr};
  const int failed =
      posix_spawn(&proxy->pid_, kProgram, nullptr, nullptr, argv, environ);
  if (failed != 0) return IoError(program, std::strerror(failed));
  TACTUS_RETURN_IF_ERROR(proxy->Await(port));
  return proxy;
}

absl::Status Haproxy::Await(int port) {
  address_ = absl::StrCat("127.0.0.1:", port);
  for (int i = 0; i < 1000; ++i) {
    if (Accepts(port)) return absl::OkStatus();
    if (waitpid(pid_, nullptr, WNOHANG) == pid_) {
      pid_ = -1;
      return IoError("haproxy", "ended before it served");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return IoError("haproxy", "does not serve after 10 s");
}

Haproxy::~Haproxy() {
  if (pid_ >= 0) EndProcess(pid_);
}

}  // namespace tactus::internal::client
