#include "core/data/hdf5_probe.h"

#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"

namespace tactus {
namespace {

// Seconds of processor time granted: a floor, and more for large files.
constexpr rlim_t kBaseSeconds = 10;
constexpr off_t kBytesPerSecond = 5'000'000;

[[noreturn]] void RunChild(absl::FunctionRef<void()> read, off_t file_bytes) {
  for (const int number : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) {
    signal(number, SIG_DFL);
  }
  const rlimit no_core = {0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  const rlim_t seconds = kBaseSeconds + file_bytes / kBytesPerSecond;
  const rlimit time = {seconds, seconds};
  setrlimit(RLIMIT_CPU, &time);
  read();
  _exit(0);
}

}  // namespace

bool HasChecksums(const std::string& path) {
  constexpr char kSignature[] = "\x89HDF\r\n\x1a\n";
  char head[9] = {};
  std::ifstream(path, std::ios::binary).read(head, sizeof(head));
  return std::memcmp(head, kSignature, 8) == 0 && head[8] >= 2;
}

absl::Status ProbeInChild(const std::string& path,
                          absl::FunctionRef<void()> read) {
  struct stat info;
  // Whoever opens the file next reports why it cannot be read.
  if (stat(path.c_str(), &info) != 0 || !S_ISREG(info.st_mode)) {
    return absl::OkStatus();
  }
  const pid_t child = fork();
  if (child < 0) return IoError(path, std::strerror(errno));
  if (child == 0) RunChild(read, info.st_size);
  int outcome = 0;
  while (waitpid(child, &outcome, 0) < 0) {
    if (errno != EINTR) return IoError(path, std::strerror(errno));
  }
  if (WIFEXITED(outcome) && WEXITSTATUS(outcome) == 0) return absl::OkStatus();
  return TrialFileInvalid(
      path, absl::StrCat("is damaged: the HDF5 library fails on it (",
                         WIFSIGNALED(outcome) ? strsignal(WTERMSIG(outcome))
                                              : "unexpected exit",
                         ")"));
}

}  // namespace tactus
