// trainctl catalog copy: moves all data of a server to another place.
#include <iostream>
#include <utility>

#include "core/base/bytes_text.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/postgres/pg_connection.h"
#include "core/postgres/postgres_catalog.h"
#include "core/store/data_copy.h"
#include "core/store/directory_to_copy.h"
#include "tools/trainctl/command.h"
#include "tools/trainctl/exit_code.h"
#include "tools/trainctl/progress_display.h"
#include "tools/trainctl/remote/shared_data.h"
#include "tools/trainctl/text.h"

namespace tactus::internal::client {
namespace {

// One side, as the user names it.
struct PlaceFlags {
  std::string data_dir;
  SharedDataFlags shared;

  absl::Status Check(const char* side) const {
    if (data_dir.empty() != shared.catalog.empty()) return absl::OkStatus();
    return WithExitCode(
        InvalidConfig(
            absl::StrCat("--", side, "-data-dir and --", side, "-catalog"),
            data_dir.empty() ? "absent" : "both there", "one of them"),
        kExitUsage);
  }
  std::string Text() const {
    return shared.given() ? absl::StrCat(ShownAddress(shared.catalog), " and ",
                                         shared.blobs)
                          : data_dir;
  }
  // How a server is started with it.
  std::string ServerFlags() const {
    return shared.given()
               ? absl::StrCat("--catalog=", ShownAddress(shared.catalog),
                              " --blobs=", shared.blobs)
               : absl::StrCat("--data-dir=", data_dir);
  }
};

struct CopyFlags {
  PlaceFlags from;
  PlaceFlags to;
  bool json = false;
};

// Holds what a CopyPlace refers to.
struct OpenPlace {
  std::unique_ptr<DirectoryToCopy> directory;
  std::unique_ptr<Catalog> catalog;
  CopyPlace place;
};

absl::StatusOr<OpenPlace> Open(const PlaceFlags& flags, bool is_source) {
  OpenPlace open;
  if (!flags.shared.given()) {
    TACTUS_ASSIGN_OR_RETURN(
        open.directory,
        is_source ? OpenDirectoryToCopy(PosixFileSystem(), flags.data_dir)
                  : MakeDirectoryToCopy(PosixFileSystem(), flags.data_dir));
    open.place = open.directory->place();
    return open;
  }
  TACTUS_ASSIGN_OR_RETURN(
      open.catalog, is_source
                        ? OpenExistingPostgresCatalog(flags.shared.catalog)
                        : OpenPostgresCatalog(flags.shared.catalog));
  open.place = {.catalog = open.catalog.get(),
                .folder = flags.shared.blobs,
                .shared = true,
                .servers = [catalog = open.catalog.get()] {
                  return ServersAtWork(*catalog);
                }};
  return open;
}

void PrintReport(const CopyReport& report, const CopyFlags& flags) {
  if (flags.json) {
    std::cout << JsonText({{"resumed", report.resumed},
                           {"records", report.records},
                           {"records_sha256", report.records_sha256},
                           {"blobs", report.blobs},
                           {"blob_bytes", report.blob_bytes},
                           {"uploads", report.uploads},
                           {"jobs", report.jobs},
                           {"unnamed_blobs", report.unnamed_blobs}})
              << "\n";
    return;
  }
  std::cout << (report.resumed ? "went on with the copy of " : "copied ")
            << flags.from.Text() << " to " << flags.to.Text() << "\n"
            << "records: " << report.records
            << ", the same on both sides, SHA-256 " << report.records_sha256
            << "\n"
            << "blobs: " << report.blobs << ", " << BytesText(report.blob_bytes)
            << ", each has its SHA-256\n"
            << "unfinished uploads: " << report.uploads
            << ", unfinished jobs with files: " << report.jobs << "\n"
            << "not copied: " << report.unnamed_blobs
            << " blobs that no record names, lost+found, contacts that a "
               "server keeps\n"
            << "next: tactusd " << flags.to.ServerFlags() << "\n"
            << "The source is as it was. Start no server with it any more: "
               "what it stores would not be in the copy\n";
}

absl::Status Copy(const CopyFlags& flags) {
  TACTUS_RETURN_IF_ERROR(flags.from.Check("from"));
  TACTUS_RETURN_IF_ERROR(flags.to.Check("to"));
  TACTUS_ASSIGN_OR_RETURN(const OpenPlace from, Open(flags.from, true));
  TACTUS_ASSIGN_OR_RETURN(const OpenPlace to, Open(flags.to, false));
  ProgressDisplay display;
  const auto report =
      CopyData(PosixFileSystem(), from.place, to.place, display.progress());
  display.Clear();
  TACTUS_RETURN_IF_ERROR(report.status());
  PrintReport(*report, flags);
  return absl::OkStatus();
}

void AddPlace(CLI::App& command, const std::string& side,
              const std::string& what, PlaceFlags& flags) {
  CLI::Option* const folder =
      command.add_option("--" + side + "-data-dir", flags.data_dir,
                         what + ": folder of --data-dir");
  flags.shared.Add(command, "--" + side + "-catalog", "--" + side + "-blobs")
      ->excludes(folder);
}

}  // namespace

void AddCatalogCopy(CLI::App& app, const SelectCommand& select) {
  auto flags = std::make_shared<CopyFlags>();
  CLI::App& group = CommandGroup(
      app, "catalog", "Move the data of a server that does not run",
      "copy --from-data-dir=/var/lib/tactus "
      "--to-catalog=postgresql://tactus@db/tactus --to-blobs=/mnt/tactus");
  CLI::App& copy = AddVerb(
      group, "copy",
      "Copy all data from a data directory to a catalogue that several servers "
      "share, or back. Stop the servers of both first. The source is only "
      "read, and the target must be empty. If the copy ends early, run the "
      "same command again: it goes on. Until it is finished, no server starts "
      "with the target",
      "copy --from-catalog=postgresql://tactus@db/tactus "
      "--from-blobs=/mnt/tactus --to-data-dir=/var/lib/tactus");
  AddPlace(copy, "from", "The source", flags->from);
  AddPlace(copy, "to", "The target", flags->to);
  copy.add_flag("--json", flags->json, "Print one JSON object");
  copy.callback([=] { select([=] { return Copy(*flags); }); });
}

}  // namespace tactus::internal::client
