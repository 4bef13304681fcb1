#include "tools/console/child_program.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/string_view.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/thread_priority.h"

namespace tactus::internal::console {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kChildLook(20);

// A descriptor that closes itself.
class OwnDescriptor {
 public:
  explicit OwnDescriptor(int number) : number_(number) {}
  OwnDescriptor(OwnDescriptor&& other) noexcept
      : number_(std::exchange(other.number_, -1)) {}
  ~OwnDescriptor() { Close(); }
  OwnDescriptor(const OwnDescriptor&) = delete;
  OwnDescriptor& operator=(const OwnDescriptor&) = delete;

  int number() const { return number_; }
  void Close() {
    if (number_ >= 0) close(number_);
    number_ = -1;
  }

 private:
  int number_;
};

// The text as a file in memory, which no other user can read.
absl::StatusOr<OwnDescriptor> MemoryFile(absl::string_view text) {
  OwnDescriptor file(memfd_create("input", MFD_CLOEXEC));
  if (file.number() < 0) return IoError("memory file", std::strerror(errno));
  while (!text.empty()) {
    const ssize_t written = write(file.number(), text.data(), text.size());
    if (written < 0) return IoError("memory file", std::strerror(errno));
    text.remove_prefix(static_cast<size_t>(written));
  }
  lseek(file.number(), 0, SEEK_SET);
  return file;
}

struct Pipe {
  OwnDescriptor read;
  OwnDescriptor write;
};

absl::StatusOr<Pipe> NewPipe() {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) {
    return IoError("pipe", std::strerror(errno));
  }
  Pipe made{OwnDescriptor(ends[0]), OwnDescriptor(ends[1])};
  fcntl(made.read.number(), F_SETFL, O_NONBLOCK);
  return made;
}

// Words as a list that ends with null. The words must outlive it.
std::vector<char*> PointersTo(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return pointers;
}

std::vector<std::string> Environment() {
  std::vector<std::string> variables;
  for (char** each = environ; *each != nullptr; ++each) {
    if (!absl::StartsWith(*each, "TACTUS")) variables.emplace_back(*each);
  }
  return variables;
}

void SetLimit(__rlimit_resource resource, int64_t value) {
  const rlimit limit = {static_cast<rlim_t>(value), static_cast<rlim_t>(value)};
  setrlimit(resource, &limit);
}

// In the child, between fork and exec: only calls that are safe there. Exits
// with 127, as a shell does, if the program cannot be run.
[[noreturn]] void Exec(const ChildOptions& options, char* const* words,
                       char* const* variables, int input, int out, int err,
                       pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  // The parent may have died before that.
  if (getppid() != parent) _exit(127);
  setpgid(0, 0);
  prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  umask(077);
  SetThreadPriority(ThreadPriority::kBackground);
  // A dump would hold the input.
  SetLimit(RLIMIT_CORE, 0);
  SetLimit(RLIMIT_FSIZE, options.file_bytes);
  SetLimit(RLIMIT_CPU, 1 + options.patience / std::chrono::seconds(1));
  if (options.memory_bytes > 0) SetLimit(RLIMIT_AS, options.memory_bytes);
  // If the host has no memory left, this process goes first.
  const int score = open("/proc/self/oom_score_adj", O_WRONLY);
  if (score >= 0) static_cast<void>(!write(score, "1000", 4));
  if (chdir(options.folder.c_str()) != 0) _exit(127);
  dup2(input, STDIN_FILENO);
  dup2(out, STDOUT_FILENO);
  dup2(err, STDERR_FILENO);
  close_range(3, ~0U, 0);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  for (const int number : {SIGPIPE, SIGTERM, SIGINT, SIGHUP}) {
    std::signal(number, SIG_DFL);
  }
  execve(options.program.c_str(), words, variables);
  _exit(127);
}

// Takes what is there to read; false once there will be no more.
bool Take(int pipe, size_t most, std::string& text) {
  std::array<char, 16 * 1024> part;
  while (true) {
    const ssize_t got = read(pipe, part.data(), part.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return got < 0 && errno == EAGAIN;
    // The program is not held up by what nobody wants to read.
    text.append(part.data(),
                std::min(static_cast<size_t>(got), most - text.size()));
  }
}

// True if the process has ended. It stays a zombie, so that nothing else gets
// its number.
bool HasEnded(pid_t pid) {
  siginfo_t info = {};
  const int asked =
      waitid(P_PID, static_cast<id_t>(pid), &info, WEXITED | WNOHANG | WNOWAIT);
  return asked != 0 || info.si_pid == pid;
}

// Reads until the process has ended, or must.
void Follow(pid_t pid, const Pipe& out, const Pipe& err,
            const ChildOptions& options, const std::atomic<bool>& cancelled,
            ChildEnd& end) {
  const auto deadline = Clock::now() + options.patience;
  std::array<pollfd, 2> pipes = {
      pollfd{.fd = out.read.number(), .events = POLLIN, .revents = 0},
      pollfd{.fd = err.read.number(), .events = POLLIN, .revents = 0}};
  const std::array<std::string*, 2> texts = {&end.out, &end.err};
  const auto take = [&] {
    for (size_t i = 0; i < pipes.size(); ++i) {
      // A negative number is not polled.
      if (pipes[i].fd >= 0 &&
          !Take(pipes[i].fd, options.text_bytes, *texts[i])) {
        pipes[i].fd = -1;
      }
    }
  };
  while (!HasEnded(pid)) {
    end.was_cancelled = cancelled;
    end.took_too_long = Clock::now() >= deadline;
    if (end.was_cancelled || end.took_too_long) break;
    poll(pipes.data(), pipes.size(), static_cast<int>(kChildLook.count()));
    take();
  }
  kill(-pid, SIGKILL);
  take();
}

}  // namespace

absl::StatusOr<ChildEnd> RunChild(const ChildOptions& options,
                                  const std::atomic<bool>& cancelled) {
  if (access(options.program.c_str(), X_OK) != 0) {
    return IoError(options.program, std::strerror(errno));
  }
  std::vector<std::string> words = options.arguments;
  words.insert(words.begin(), options.program);
  const std::vector<char*> word_pointers = PointersTo(words);
  std::vector<std::string> variables = Environment();
  const std::vector<char*> variable_pointers = PointersTo(variables);
  TACTUS_ASSIGN_OR_RETURN(const OwnDescriptor input, MemoryFile(options.input));
  TACTUS_ASSIGN_OR_RETURN(Pipe out, NewPipe());
  TACTUS_ASSIGN_OR_RETURN(Pipe err, NewPipe());
  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid == 0) {
    Exec(options, word_pointers.data(), variable_pointers.data(),
         input.number(), out.write.number(), err.write.number(), parent);
  }
  if (pid < 0) return IoError("fork", std::strerror(errno));
  // Whoever comes first; the other one fails.
  setpgid(pid, pid);
  out.write.Close();
  err.write.Close();
  ChildEnd end;
  Follow(pid, out, err, options, cancelled, end);
  int status = 0;
  while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status)) end.status = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) end.signal = WTERMSIG(status);
  return end;
}

}  // namespace tactus::internal::console
