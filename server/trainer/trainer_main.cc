#include "server/trainer/trainer_main.h"

#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <string>
#include <system_error>

#include "absl/strings/numbers.h"
#include "core/base/errors.h"
#include "core/base/run_on_threads.h"
#include "core/store/file_system.h"
#include "server/trainer/event_writer.h"
#include "server/trainer/exit_status.h"
#include "server/trainer/file_journal.h"
#include "server/trainer/job.h"
#include "server/trainer/yield_timer.h"

namespace tactus::internal::server {
namespace {

FileJournal* running_journal = nullptr;

// Uncaught errors of memory get an exit status. Threads
// that cannot be started have no memory for their stack.
[[noreturn]] void OnUncaught() {
  try {
    if (std::current_exception() != nullptr) throw;
  } catch (const std::bad_alloc&) {
    _exit(kExitOutOfMemory);
  } catch (const std::system_error& error) {
    if (error.code() == std::errc::resource_unavailable_try_again ||
        error.code() == std::errc::not_enough_memory) {
      _exit(kExitOutOfMemory);
    }
  } catch (...) {  // Not ours to explain.
  }
  std::abort();
}

void OnTerminate(int) {
  if (running_journal != nullptr) running_journal->Cancel();
}

}  // namespace

int TrainerMain(int argc, char** argv, Team& team) {
  int start_threads = 0;
  int threads = 0;
  const bool run = argc == 4 && absl::SimpleAtoi(argv[2], &start_threads) &&
                   absl::SimpleAtoi(argv[3], &threads) && start_threads >= 1 &&
                   threads >= 1;
  if (!run) {
    const bool asked = argc == 2 && std::string(argv[1]) == "--help";
    std::fprintf(asked ? stdout : stderr,
                 "usage: tactus-trainer JOB_FOLDER START_THREADS THREADS\n"
                 "Runs one training or evaluation job; tactusd starts it.\n");
    return asked ? 0 : 2;
  }
  std::set_terminate(OnUncaught);
  YieldAtIntervals();
  const std::string folder = argv[1];
  FileSystem& files = PosixFileSystem();
  EventWriter events(STDOUT_FILENO, &team);
  const std::string parts = folder + "/parts";
  absl::Status status = files.MakeDirectory(parts);
  if (status.ok()) {
    FileJournal journal(files, parts, &events);
    running_journal = &journal;
    std::signal(SIGTERM, OnTerminate);
    status = RunJob(files, folder,
                    {.start = Yielding(OnThreads(start_threads)),
                     .run = Yielding(OnThreads(threads))},
                    &events, &journal, team);
    std::signal(SIGTERM, SIG_DFL);
  }
  if (status.ok()) return kExitDone;
  std::fprintf(stderr, "tactus-trainer: %s\n", status.ToString().c_str());
  return ReasonOf(status) == "STORAGE_FULL" ? kExitStorageFull : kExitFailed;
}

}  // namespace tactus::internal::server
