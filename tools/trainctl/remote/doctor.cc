// trainctl doctor: checks a server, or a data directory that no server uses.
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "core/base/errors.h"
#include "core/store/file_system.h"
#include "tools/trainctl/exit_code.h"
#include "tools/trainctl/remote/doctor_remote.h"
#include "tools/trainctl/remote/doctor_report.h"
#include "tools/trainctl/remote/flags.h"

namespace tactus::internal::client {
namespace {

struct DoctorFlags {
  RemoteFlags remote;
  std::string data_dir;
  bool repair = false;
  bool accept_catalog = false;
};

absl::Status Examine(const DoctorFlags& flags) {
  if (!flags.data_dir.empty()) {
    return PrintChecks(CheckData(PosixFileSystem(), flags.data_dir,
                                 {.now_ms = absl::ToUnixMillis(absl::Now()),
                                  .repair = flags.repair,
                                  .accept_catalog = flags.accept_catalog}),
                       flags.remote.json);
  }
  if (flags.remote.server.empty()) {
    return WithExitCode(
        InvalidConfig("--data-dir and --server", "absent",
                      "one of them: the folder of a server that does not run, "
                      "or the address of one that does"),
        kExitUsage);
  }
  return PrintChecks(CheckServer(flags.remote), flags.remote.json);
}

}  // namespace

void AddDoctor(CLI::App& app, const SelectCommand& select) {
  auto flags = std::make_shared<DoctorFlags>();
  CLI::App* command = app.add_subcommand(
      "doctor",
      "Check a server, or the data directory of a server that does not run. "
      "Prints one line for each check, with what to do. Exit codes: 0 all is "
      "well, 1 there are warnings, 2 there are errors");
  flags->remote.Add(*command);
  CLI::Option* folder = command->add_option(
      "--data-dir", flags->data_dir,
      "Folder that tactusd got as --data-dir; no server is asked");
  CLI::Option* repair = command->add_flag(
      "--repair", flags->repair,
      "Move what no record names to the folder lost+found: blobs, files of "
      "uploads, folders of jobs; and uploads that nobody wrote to for 7 days. "
      "Deletes no file");
  repair->needs(folder);
  command
      ->add_flag("--accept-catalogue", flags->accept_catalog,
                 "If the catalogue is lost and there is no back-up: take what "
                 "is there as the catalogue of the folder, or begin with an "
                 "empty one. Deletes nothing")
      ->needs(folder)
      ->excludes(repair);
  command->footer(
      "Examples:\n"
      "  trainctl doctor --server=arm.lab:50051 --tls-ca=ca.pem "
      "--token-file=admin.token\n"
      "  trainctl doctor --data-dir=/var/lib/tactus --repair");
  command->callback([=] { select([flags] { return Examine(*flags); }); });
}

}  // namespace tactus::internal::client
