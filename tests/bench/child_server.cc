#include "tests/bench/child_server.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/socket.h>
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

namespace tactus::internal::client {

namespace fs = std::filesystem;

std::string ProgramBeside(const std::string& name) {
  std::error_code error;
  return fs::read_symlink("/proc/self/exe", error).parent_path() / name;
}

absl::StatusOr<pid_t> SpawnBeside(const std::string& name,
                                  const std::vector<std::string>& arguments,
                                  ChildOutput output) {
  std::string program = ProgramBeside(name);
  std::vector<std::string> words = arguments;
  std::vector<char*> argv = {program.data()};
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  if (output == ChildOutput::kErrors) {
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null",
                                     O_WRONLY, 0);
  }
  pid_t pid = -1;
  const int failed =
      posix_spawn(&pid, program.c_str(), &files, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (failed != 0) return IoError(program, std::strerror(failed));
  return pid;
}

absl::Status AwaitSuccess(pid_t pid, absl::string_view what, rusage* used) {
  int status = 0;
  if (wait4(pid, &status, 0, used) == pid && WIFEXITED(status) &&
      WEXITSTATUS(status) == 0) {
    return absl::OkStatus();
  }
  return IoError(what, absl::StrCat("ended with wait status ", status));
}

void EndProcess(pid_t pid) {
  kill(pid, SIGTERM);
  waitpid(pid, nullptr, 0);
}

int FreePort() {
  const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return 0;
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  const bool bound =
      bind(fd, reinterpret_cast<sockaddr*>(&address), size) == 0 &&
      getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size) == 0;
  close(fd);
  return bound ? ntohs(address.sin_port) : 0;
}

absl::StatusOr<std::unique_ptr<ChildServer>> ChildServer::Start(
    const std::string& program, const std::vector<std::string>& arguments) {
  static int count = 0;
  const std::string port_file =
      fs::temp_directory_path() /
      absl::StrCat("tactus-port-", getpid(), "-", ++count);
  std::error_code error;
  fs::remove(port_file, error);
  std::vector<std::string> all = arguments;
  all.push_back("--port-file=" + port_file);
  std::unique_ptr<ChildServer> server(new ChildServer());
  TACTUS_ASSIGN_OR_RETURN(server->pid_, SpawnBeside(program, all));
  const absl::Status status = server->Await(port_file);
  fs::remove(port_file, error);
  TACTUS_RETURN_IF_ERROR(Annotate(status, program));
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
      return IoError("the server", "ended before it served");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return IoError("the server", "does not serve after 10 s");
}

double ChildServer::ResidentKib() const {
  double total_pages = 0;
  double resident_pages = 0;
  std::ifstream(absl::StrCat("/proc/", pid_, "/statm")) >> total_pages >>
      resident_pages;
  return resident_pages * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1024;
}

double ChildServer::CpuSeconds() const {
  std::ifstream stat(absl::StrCat("/proc/", pid_, "/stat"));
  // Fields 14 and 15; the name, field 2, has no space in our programs.
  std::string skipped;
  for (int i = 0; i < 13; ++i) stat >> skipped;
  double user = 0;
  double system = 0;
  stat >> user >> system;
  return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

void ChildServer::Kill() {
  kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
  pid_ = -1;
}

ChildServer::~ChildServer() {
  if (pid_ >= 0) EndProcess(pid_);
}

}  // namespace tactus::internal::client
