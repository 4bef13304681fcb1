#include "server/jobs/job_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstring>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/thread_priority.h"

namespace tactus::internal::server {
namespace {

constexpr size_t kReadBytes = 64 * 1024;
// How often a process that closed its output is asked whether it has ended.
constexpr std::chrono::milliseconds kEndPoll(2);

// In the child, between fork and exec: only calls that are safe there. Exits
// with 127, as a shell does, if the program cannot be run.
[[noreturn]] void RunProgram(const JobProcess::Options& options,
                             char* const* arguments, int output, int log,
                             pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  // The parent may have died before that.
  if (getppid() != parent) _exit(127);
  SetThreadPriority(ThreadPriority::kBackground);
  if (options.memory_bytes > 0) {
    const rlimit limit = {static_cast<rlim_t>(options.memory_bytes),
                          static_cast<rlim_t>(options.memory_bytes)};
    setrlimit(RLIMIT_DATA, &limit);
  }
  const int null = open("/dev/null", O_RDONLY);
  dup2(null, STDIN_FILENO);
  dup2(output, STDOUT_FILENO);
  dup2(log, STDERR_FILENO);
  close_range(3, ~0U, 0);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  for (const int number : {SIGPIPE, SIGTERM, SIGINT, SIGHUP}) {
    std::signal(number, SIG_DFL);
  }
  execvp(arguments[0], arguments);
  _exit(127);
}

std::string Describe(int status) {
  if (WIFSIGNALED(status)) {
    const char* name = sigabbrev_np(WTERMSIG(status));
    return absl::StrCat("was ended by SIG", name == nullptr ? "?" : name);
  }
  return absl::StrCat("exited with status ", WEXITSTATUS(status));
}

}  // namespace

absl::StatusOr<std::unique_ptr<JobProcess>> JobProcess::Start(
    const Options& options, const std::string& folder) {
  if (access(options.program.c_str(), X_OK) != 0) {
    return IoError(options.program, std::strerror(errno));
  }
  const std::string log_path = folder + "/log";
  const int log =
      open(log_path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (log < 0) return IoError(log_path, std::strerror(errno));
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) {
    const absl::Status status = IoError("pipe", std::strerror(errno));
    close(log);
    return status;
  }
  std::vector<std::string> words = options.launcher;
  words.insert(words.end(),
               {options.program, folder, absl::StrCat(options.start_threads),
                absl::StrCat(options.threads)});
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid == 0) {
    RunProgram(options, arguments.data(), ends[1], log, parent);
  }
  const int error = errno;
  close(log);
  close(ends[1]);
  if (pid < 0) {
    close(ends[0]);
    return IoError("fork", std::strerror(error));
  }
  return std::unique_ptr<JobProcess>(new JobProcess(pid, ends[0]));
}

JobProcess::~JobProcess() {
  Terminate(true);
  Wait(std::chrono::milliseconds(0));
  close(output_);
}

JobProcess::News JobProcess::Next(std::chrono::milliseconds timeout,
                                  v1::JobEvent* event) {
  while (true) {
    switch (bytes_.Take(event)) {
      case EventBytes::Found::kEvent:
        return News::kEvent;
      case EventBytes::Found::kGarbage:
        return Garbage();
      case EventBytes::Found::kNone:
        break;
    }
    pollfd wait = {.fd = output_, .events = POLLIN, .revents = 0};
    const int ready = poll(&wait, 1, static_cast<int>(timeout.count()));
    if (ready == 0) return News::kNone;
    if (ready < 0) {
      if (errno == EINTR) continue;
      return News::kClosed;
    }
    std::array<char, kReadBytes> buffer;
    const ssize_t got = read(output_, buffer.data(), buffer.size());
    if (got > 0) bytes_.Append({buffer.data(), static_cast<size_t>(got)});
    if (got == 0 || (got < 0 && errno != EINTR)) return News::kClosed;
  }
}

JobProcess::News JobProcess::Garbage() {
  Terminate(true);
  return News::kClosed;
}

void JobProcess::Terminate(bool kill_it) {
  if (pid_ > 0) kill(pid_, kill_it ? SIGKILL : SIGTERM);
}

JobProcess::End JobProcess::Wait(std::chrono::milliseconds patience) {
  if (pid_ <= 0) return {};
  const auto deadline = std::chrono::steady_clock::now() + patience;
  int status = 0;
  bool killed = false;
  while (true) {
    const pid_t ended = waitpid(pid_, &status, killed ? 0 : WNOHANG);
    if (ended == pid_) break;
    if (ended < 0 && errno != EINTR) {
      pid_ = -1;
      return {.text = absl::StrCat("is lost: ", std::strerror(errno))};
    }
    if (killed) continue;
    if (std::chrono::steady_clock::now() >= deadline) {
      Terminate(true);
      killed = true;
    } else {
      std::this_thread::sleep_for(kEndPoll);
    }
  }
  pid_ = -1;
  return {.ok = WIFEXITED(status) && WEXITSTATUS(status) == 0,
          .status = WIFEXITED(status) ? WEXITSTATUS(status) : -1,
          .text = Describe(status)};
}

}  // namespace tactus::internal::server
