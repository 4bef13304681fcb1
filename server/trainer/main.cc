// tactus-trainer: runs one job of tactusd. Started by tactusd, not by people.
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <string>

#include "core/store/file_system.h"
#include "server/trainer/event_writer.h"
#include "server/trainer/file_journal.h"
#include "server/trainer/job.h"

namespace tactus::server {
namespace {

FileJournal* running_journal = nullptr;

void OnTerminate(int) {
  if (running_journal != nullptr) running_journal->Cancel();
}

int Main(int argc, char** argv) {
  if (argc != 2 || argv[1][0] == '-') {
    const bool asked = argc == 2 && std::string(argv[1]) == "--help";
    std::fprintf(asked ? stdout : stderr,
                 "usage: tactus-trainer JOB_FOLDER\n"
                 "Runs one training or evaluation job; tactusd starts it.\n");
    return asked ? 0 : 2;
  }
  const std::string folder = argv[1];
  FileSystem& files = PosixFileSystem();
  EventWriter events(STDOUT_FILENO);
  const std::string parts = folder + "/parts";
  absl::Status status = files.MakeDirectory(parts);
  if (status.ok()) {
    FileJournal journal(files, parts, &events);
    running_journal = &journal;
    std::signal(SIGTERM, OnTerminate);
    status = RunJob(files, folder, &events, &journal);
    std::signal(SIGTERM, SIG_DFL);
  }
  if (status.ok()) return 0;
  std::fprintf(stderr, "tactus-trainer: %s\n", status.ToString().c_str());
  return 1;
}

}  // namespace
}  // namespace tactus::server

int main(int argc, char** argv) { return tactus::server::Main(argc, argv); }
