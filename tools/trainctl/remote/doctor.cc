// trainctl doctor: checks a server, a data directory that no server uses, or a
// catalogue that several servers share.
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "core/base/errors.h"
#include "core/postgres/pg_connection.h"
#include "core/postgres/postgres_catalog.h"
#include "core/store/file_system.h"
#include "tools/trainctl/exit_code.h"
#include "tools/trainctl/remote/doctor_remote.h"
#include "tools/trainctl/remote/doctor_report.h"
#include "tools/trainctl/remote/flags.h"
#include "tools/trainctl/remote/shared_data.h"

namespace tactus::internal::client {
namespace {

struct DoctorFlags {
  RemoteFlags remote;
  std::string data_dir;
  SharedDataFlags shared;
  bool repair = false;
  bool accept_catalog = false;
};

// A database that cannot be read is what was found.
std::vector<CheckResult> ExamineShared(const DoctorFlags& flags) {
  const std::string& address = flags.shared.catalog;
  const auto refused = [](const absl::Status& status) {
    return std::vector<CheckResult>{
        {.check = "catalogue",
         .severity = CheckResult::Severity::kError,
         .text = std::string(status.message()),
         .advice = "look whether PostgreSQL runs, and give the address that "
                   "tactusd got as --catalog"}};
  };
  const auto catalog = OpenExistingPostgresCatalog(address);
  if (!catalog.ok()) return refused(catalog.status());
  auto servers = ServersAtWork(**catalog);
  if (!servers.ok()) return refused(servers.status());
  return CheckSharedData(
      PosixFileSystem(), flags.shared.blobs,
      {.catalog = catalog->get(),
       .address = ShownAddress(address),
       .servers = *std::move(servers)},
      {.now_ms = absl::ToUnixMillis(absl::Now()), .repair = flags.repair});
}

absl::Status Examine(const DoctorFlags& flags) {
  if (flags.shared.given()) {
    return PrintChecks(ExamineShared(flags), flags.remote.json);
  }
  if (!flags.data_dir.empty()) {
    return PrintChecks(CheckData(PosixFileSystem(), flags.data_dir,
                                 {.now_ms = absl::ToUnixMillis(absl::Now()),
                                  .repair = flags.repair,
                                  .accept_catalog = flags.accept_catalog}),
                       flags.remote.json);
  }
  if (flags.remote.server.empty()) {
    return WithExitCode(
        InvalidConfig("--data-dir, --catalog and --server", "absent",
                      "one of them: the folder of a server that does not run, "
                      "the catalogue of several, or the address of one that "
                      "runs"),
        kExitUsage);
  }
  return PrintChecks(CheckServer(flags.remote), flags.remote.json);
}

}  // namespace

void AddDoctor(CLI::App& app, const SelectCommand& select) {
  auto flags = std::make_shared<DoctorFlags>();
  CLI::App* command = app.add_subcommand(
      "doctor",
      "Check a server, the data directory of a server that does not run, or "
      "the catalogue that several servers share. "
      "Prints one line for each check, with what to do. Exit codes: 0 all is "
      "well, 1 there are warnings, 2 there are errors");
  flags->remote.Add(*command);
  CLI::Option* folder = command->add_option(
      "--data-dir", flags->data_dir,
      "Folder that tactusd got as --data-dir; no server is asked");
  flags->shared.Add(*command, "--catalog", "--blobs")->excludes(folder);
  CLI::Option* repair = command->add_flag(
      "--repair", flags->repair,
      "Move what no record names to the folder lost+found: blobs, files of "
      "uploads, folders of jobs; and uploads that nobody wrote to for 7 days. "
      "Deletes no file");
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
      "  trainctl doctor --data-dir=/var/lib/tactus --repair\n"
      "  trainctl doctor --catalog=postgresql://tactus@db/tactus "
      "--blobs=/mnt/tactus");
  command->callback([=] {
    if (flags->repair && flags->data_dir.empty() && !flags->shared.given()) {
      throw CLI::RequiresError("--repair", "--data-dir or --catalog");
    }
    select([flags] { return Examine(*flags); });
  });
}

}  // namespace tactus::internal::client
