#include "core/files/hdf5_probe.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <new>

#include "absl/base/config.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "core/base/errors.h"
#include "core/base/limits.h"

namespace tactus::internal {
namespace {

// Seconds of processor time granted: a floor, and more for large files.
constexpr rlim_t kBaseSeconds = 10;
constexpr rlim_t kBytesPerSecond = 5'000'000;
// Bytes of memory granted beyond what the process has: a floor, and for each
// byte of the file twice what deflate can make of it.
constexpr rlim_t kBaseBytes = 256UL * 1024 * 1024;
constexpr rlim_t kBytesPerFileByte = 2200;

// How the child exits.
constexpr int kRead = 0;
constexpr int kRefused = 1;
constexpr int kOutOfMemory = 2;

// At most this much of an error's text: a pipe takes it without waiting.
constexpr size_t kMaxMessageBytes = 4096;

void Limit(__rlimit_resource resource, rlim_t value) {
  rlimit limit = {};
  getrlimit(resource, &limit);
  limit.rlim_cur = std::min(value, limit.rlim_max);
  limit.rlim_max = limit.rlim_cur;
  setrlimit(resource, &limit);
}

// Address space in use, in bytes.
rlim_t AddressSpace() {
  rlim_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
}

[[noreturn]] void RunChild(absl::FunctionRef<absl::Status()> read,
                           rlim_t file_bytes, int report, pid_t parent) {
  // Nobody waits for it then.
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(kRefused);
  for (const int number : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) {
    signal(number, SIG_DFL);
  }
  Limit(RLIMIT_CORE, 0);
  Limit(RLIMIT_CPU, kBaseSeconds + file_bytes / kBytesPerSecond);
  const rlim_t most = limits::kMaxProbeBytes;
  Limit(RLIMIT_AS,
        AddressSpace() +
            (file_bytes < most / kBytesPerFileByte
                 ? std::min(most, kBaseBytes + file_bytes * kBytesPerFileByte)
                 : most));
  std::set_new_handler([] { _exit(kOutOfMemory); });
  const absl::Status status = read();
  if (status.ok()) _exit(kRead);
  const absl::string_view text = status.message().substr(0, kMaxMessageBytes);
  const ssize_t written = write(report, text.data(), text.size());
  _exit(written < 0 ? kOutOfMemory : kRefused);
}

// What arrives until all writers have closed.
std::string ReadAll(int fd) {
  std::string text;
  char buffer[kMaxMessageBytes];
  while (true) {
    const ssize_t got = read(fd, buffer, sizeof(buffer));
    if (got > 0) text.append(buffer, static_cast<size_t>(got));
    if (got == 0 || (got < 0 && errno != EINTR)) return text;
  }
}

// AddressSanitizer leaves the locks of its allocator in a child as other
// threads held them at the fork, so that the child may wait for ever. glibc's
// allocator does not.
bool ForkIsSafe() {
#if defined(ABSL_HAVE_ADDRESS_SANITIZER)
  const std::filesystem::directory_iterator threads("/proc/self/task");
  return std::distance(threads, std::filesystem::directory_iterator()) == 1;
#else
  return true;
#endif
}

std::string WhyItDied(int outcome) {
  if (WIFSIGNALED(outcome)) return strsignal(WTERMSIG(outcome));
  if (WEXITSTATUS(outcome) == kOutOfMemory) return "out of memory";
  return "unexpected exit";
}

}  // namespace

absl::Status ProbeInChild(const std::string& path,
                          absl::FunctionRef<absl::Status()> read) {
  struct stat info;
  if (stat(path.c_str(), &info) != 0) {
    return IoError(path, std::strerror(errno));
  }
  if (!S_ISREG(info.st_mode)) {
    return TrialFileInvalid(path, "is not a regular file");
  }
  if (!ForkIsSafe()) return read();
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return IoError(path, std::strerror(errno));
  const pid_t parent = getpid();
  const pid_t child = fork();
  const std::string error = std::strerror(errno);
  if (child == 0) {
    RunChild(read, static_cast<rlim_t>(info.st_size), ends[1], parent);
  }
  close(ends[1]);
  const std::string message = child < 0 ? "" : ReadAll(ends[0]);
  close(ends[0]);
  if (child < 0) return IoError(path, error);
  int outcome = 0;
  while (waitpid(child, &outcome, 0) < 0) {
    if (errno != EINTR) return IoError(path, std::strerror(errno));
  }
  if (WIFEXITED(outcome) && WEXITSTATUS(outcome) == kRead) {
    return absl::OkStatus();
  }
  if (WIFEXITED(outcome) && WEXITSTATUS(outcome) == kRefused) {
    absl::string_view text = message;
    absl::ConsumePrefix(&text, absl::StrCat(path, ": "));
    return TrialFileInvalid(path, text);
  }
  return TrialFileInvalid(
      path, absl::StrCat("is damaged: the HDF5 library fails on it (",
                         WhyItDied(outcome), ")"));
}

}  // namespace tactus::internal
