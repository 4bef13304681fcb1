#include "tools/load/load_processes.h"

#include <spawn.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <iostream>
#include <string_view>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "tools/load/load_run.h"

namespace tactus::internal::client {
namespace {

// What is said: the parent asks for "open ROBOTS" and gets "opened", then
// "start NANOSECONDS" and gets a tally.
constexpr absl::string_view kOpen = "open ";
constexpr absl::string_view kOpened = "opened";
constexpr absl::string_view kStart = "start ";

}  // namespace

struct LoadProcesses::Process {
  ~Process() {
    if (socket_fd >= 0) close(socket_fd);
    if (pid <= 0) return;
    kill(pid, SIGKILL);
    waitpid(pid, nullptr, 0);
  }

  absl::Status Write(absl::string_view line) const {
    // Short enough for one piece.
    if (send(socket_fd, line.data(), line.size(), MSG_NOSIGNAL) ==
        static_cast<ssize_t>(line.size())) {
      return absl::OkStatus();
    }
    return IoError(name, "ended");
  }

  absl::StatusOr<std::string> Read() {
    while (true) {
      const size_t end = unread.find('\n');
      if (end != std::string::npos) {
        std::string line = unread.substr(0, end);
        unread.erase(0, end + 1);
        return line;
      }
      char bytes[64 * 1024];
      const ssize_t size = recv(socket_fd, bytes, sizeof(bytes), 0);
      if (size < 0 && errno == EINTR) continue;
      if (size <= 0) return IoError(name, "ended");
      unread.append(bytes, size);
    }
  }

  std::string name;
  pid_t pid = 0;
  int socket_fd = -1;
  std::string unread;
};

absl::StatusOr<std::unique_ptr<LoadProcesses>> LoadProcesses::Start(
    const std::string& program, const std::vector<std::string>& flags,
    int count) {
  std::unique_ptr<LoadProcesses> all(new LoadProcesses());
  for (int part = 0; part < count; ++part) {
    std::vector<std::string> words = {program};
    words.insert(words.end(), flags.begin(), flags.end());
    words.push_back(absl::StrCat("--part=", part));
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    int sockets[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets) != 0) {
      return IoError(program, strerror(errno));
    }
    auto process = std::make_unique<Process>();
    process->name = absl::StrCat("process ", part, " of the generator");
    process->socket_fd = sockets[0];
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, sockets[1], STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&files, sockets[1], STDOUT_FILENO);
    const int error = posix_spawn(&process->pid, program.c_str(), &files,
                                  nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    close(sockets[1]);
    if (error != 0) {
      process->pid = 0;
      return IoError(program, strerror(error));
    }
    all->processes_.push_back(std::move(process));
  }
  return all;
}

LoadProcesses::~LoadProcesses() = default;

absl::Status LoadProcesses::Tell(const std::string& line) {
  for (const auto& process : processes_) {
    TACTUS_RETURN_IF_ERROR(process->Write(line));
  }
  return absl::OkStatus();
}

absl::StatusOr<LoadReport> LoadProcesses::Run(int robots) {
  TACTUS_RETURN_IF_ERROR(Tell(absl::StrCat(kOpen, robots, "\n")));
  for (const auto& process : processes_) {
    TACTUS_ASSIGN_OR_RETURN(const std::string line, process->Read());
    if (line != kOpened) return IoError(process->name, line);
  }
  TACTUS_RETURN_IF_ERROR(
      Tell(absl::StrCat(kStart, LoadClockNs() + LoadRun::kLeadNs, "\n")));
  const auto all = std::make_unique<LoadTally>();
  for (const auto& process : processes_) {
    TACTUS_ASSIGN_OR_RETURN(const std::string line, process->Read());
    const auto tally = std::make_unique<LoadTally>();
    TACTUS_RETURN_IF_ERROR(ReadTally(line, tally.get()));
    all->Add(*tally);
  }
  return ReportOf(*all);
}

absl::Status ServeLoadParts(LoadOptions options) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  TACTUS_ASSIGN_OR_RETURN(const FrameScript script, MakeScript(options));
  std::string line;
  while (std::getline(std::cin, line)) {
    absl::string_view number = line;
    if (!absl::ConsumePrefix(&number, kOpen) ||
        !absl::SimpleAtoi(number, &options.robots)) {
      return InvalidConfig("order", line, "open ROBOTS");
    }
    TACTUS_RETURN_IF_ERROR(LoadRun::Check(options));
    const auto run = std::make_unique<LoadRun>(options, script);
    TACTUS_RETURN_IF_ERROR(run->Open());
    std::cout << kOpened << std::endl;
    int64_t start_ns = 0;
    if (!std::getline(std::cin, line)) break;
    number = line;
    if (!absl::ConsumePrefix(&number, kStart) ||
        !absl::SimpleAtoi(number, &start_ns)) {
      return InvalidConfig("order", line, "start NANOSECONDS");
    }
    std::cout << TallyToText(run->Send(start_ns)) << std::endl;
  }
  return absl::OkStatus();
}

}  // namespace tactus::internal::client
