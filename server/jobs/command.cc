#include "server/jobs/command.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstring>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"

namespace tactus::internal::server {
namespace {

using std::chrono::steady_clock;

constexpr size_t kMaxOutputBytes = 64 * 1024;

// Starts the program; its output goes to `output`. 0 or an error number.
int Spawn(const std::vector<std::string>& words, int output, pid_t* pid) {
  std::vector<std::string> copies = words;
  std::vector<char*> arguments;
  for (std::string& word : copies) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null",
                                   O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, output, STDERR_FILENO);
  posix_spawn_file_actions_addclosefrom_np(&actions, 3);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  sigset_t usual;
  sigemptyset(&usual);
  for (const int number : {SIGPIPE, SIGTERM, SIGINT, SIGHUP}) {
    sigaddset(&usual, number);
  }
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &usual);
  posix_spawnattr_setflags(&attributes,
                           POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  const int error = posix_spawnp(pid, arguments[0], &actions, &attributes,
                                 arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  return error;
}

// Reads to the end, or until `deadline`. False if it came.
bool ReadOutput(int output, steady_clock::time_point deadline,
                std::string* text) {
  while (true) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(
        deadline - steady_clock::now());
    if (left.count() <= 0) return false;
    pollfd wait = {.fd = output, .events = POLLIN, .revents = 0};
    if (poll(&wait, 1, static_cast<int>(left.count())) <= 0) continue;
    std::array<char, 4096> buffer;
    const ssize_t got = read(output, buffer.data(), buffer.size());
    if (got == 0 || (got < 0 && errno != EINTR)) return true;
    const size_t room = kMaxOutputBytes - text->size();
    if (got > 0) {
      text->append(buffer.data(), std::min(room, static_cast<size_t>(got)));
    }
  }
}

}  // namespace

absl::StatusOr<CommandResult> RunCommand(const std::vector<std::string>& words,
                                         std::chrono::milliseconds patience) {
  const auto deadline = steady_clock::now() + patience;
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) {
    return IoError("pipe", std::strerror(errno));
  }
  pid_t pid = 0;
  const int error = Spawn(words, ends[1], &pid);
  close(ends[1]);
  if (error != 0) {
    close(ends[0]);
    return IoError(words[0], std::strerror(error));
  }
  CommandResult result;
  const bool ended = ReadOutput(ends[0], deadline, &result.output);
  close(ends[0]);
  if (!ended) kill(pid, SIGKILL);
  int status = 0;
  while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  result.late = !ended;
  if (WIFEXITED(status)) result.status = WEXITSTATUS(status);
  return result;
}

}  // namespace tactus::internal::server
