#include "client/bench/child_server.h"

#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <thread>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::client {

namespace fs = std::filesystem;

absl::StatusOr<std::unique_ptr<ChildServer>> ChildServer::Start() {
  std::error_code error;
  const fs::path self = fs::read_symlink("/proc/self/exe", error);
  const std::string program = self.parent_path() / "tactusd";
  const std::string port_file =
      fs::temp_directory_path() / absl::StrCat("tactusd-port-", getpid());
  fs::remove(port_file, error);
  std::string arguments[] = {program, "--listen=127.0.0.1:0",
                             "--port-file=" + port_file, "--log-level=warn"};
  char* argv[] = {arguments[0].data(), arguments[1].data(), arguments[2].data(),
                  arguments[3].data(), nullptr};
  std::unique_ptr<ChildServer> server(new ChildServer());
  const int failed = posix_spawn(&server->pid_, program.c_str(), nullptr,
                                 nullptr, argv, environ);
  if (failed != 0) {
    server->pid_ = -1;
    return IoError(program, std::strerror(failed));
  }
  const absl::Status status = server->Await(port_file);
  fs::remove(port_file, error);
  TACTUS_RETURN_IF_ERROR(status);
  return server;
}

absl::Status ChildServer::Await(const std::string& port_file) {
  for (int i = 0; i < 1000; ++i) {
    int port = 0;
    if (std::ifstream(port_file) >> port) {
      address_ = absl::StrCat("127.0.0.1:", port);
      return absl::OkStatus();
    }
    if (waitpid(pid_, nullptr, WNOHANG) == pid_) {
      pid_ = -1;
      return IoError("tactusd", "ended before it served");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return IoError("tactusd", "does not serve after 10 s");
}

ChildServer::~ChildServer() {
  if (pid_ < 0) return;
  kill(pid_, SIGTERM);
  waitpid(pid_, nullptr, 0);
}

}  // namespace tactus::client
