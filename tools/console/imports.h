// File: imports.h
//
// Imports: the imports that are under way. Each belongs to one person and has
// files in a private folder, which go with it: when it is done or given up,
// when the person signs out, and when nobody asks anything of it for long.
//
//   Imports imports(settings, &doorkeeper, waker);
//   TACTUS_ASSIGN_OR_RETURN(const auto import,
//                           imports.Begin(0, person, cookie, executor));
//   imports.Run(import, [] { return Work(); },           // on another thread
//               [](absl::StatusOr<client::Json> answer) {});
//   imports.End(import);
//   imports.Stop();
//
// At most so many are under way as core/base/limits_console.h says. For the
// thread that serves browsers, where all functions that are given are called,
// but for work. `doorkeeper` must outlive the object.
#pragma once

#include <atomic>
#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/limits_console.h"
#include "tools/common/json.h"
#include "tools/console/doorkeeper.h"
#include "tools/console/import_files.h"
#include "tools/console/import_program.h"
#include "tools/console/private_folder.h"
#include "tools/console/waker.h"

namespace tactus::internal::console {

struct ImportSettings {
  // Path of trainctl; empty: beside this program.
  std::string program = {};
  // Where the private folder is made; empty: $TMPDIR or /var/tmp.
  std::string folder = {};
  int64_t memory_bytes = limits::kMaxImportMemoryBytes;
  // For a part of a file to come, for the program, and between requests.
  std::chrono::milliseconds part_patience{1'000 * limits::kImportPatienceS};
  std::chrono::milliseconds program_patience{1'000 * limits::kMaxImportS};
  std::chrono::milliseconds idle_patience{1'000 * limits::kImportIdleS};
};

// One import. Work may use what does not change while it runs, and `cancelled`.
struct Import {
  std::string id;
  size_t server = 0;
  Doorkeeper::Person person;
  std::string cookie;
  // Where its files are, or will be.
  std::string folder;
  std::unique_ptr<ImportFiles> files;
  // Its trial file is made of all its files.
  bool is_checked = false;
  // A request of it is under way.
  bool is_busy = false;
  // It has ended; its files go once no request is under way.
  bool is_over = false;
  std::atomic<bool> cancelled = false;
  std::chrono::steady_clock::time_point used;
  // Called when it ends while a request is under way.
  std::function<void()> on_over;
  // Called when its files are gone.
  std::vector<std::function<void()>> when_gone;
};

class Imports {
 public:
  using Work = std::function<absl::StatusOr<client::Json>()>;
  using Done = std::function<void(absl::StatusOr<client::Json>)>;
  using Handle = std::shared_ptr<Import>;

  // Removes what consoles that crashed have left.
  Imports(ImportSettings settings, const Doorkeeper* doorkeeper,
          std::shared_ptr<Waker> waker);
  ~Imports() { Stop(); }

  // An import without files. RESOURCE_EXHAUSTED if the person has one already,
  // which metadata says ("own"), or if too many people have one; IO if the
  // console cannot import.
  absl::StatusOr<Handle> Begin(size_t server, const Doorkeeper::Person& person,
                               const std::string& cookie,
                               boost::asio::any_io_executor executor);
  // Null if the person has no such import, or no longer.
  Handle Find(const std::string& id, const Doorkeeper::Person& person) const;
  // Any import of the person's; null if there is none.
  Handle OfPerson(const Doorkeeper::Person& person) const;

  // A request of the import begins, and ends.
  void Take(const Handle& import);
  void Release(const Handle& import);
  // Takes the import, does work, releases it, and calls `done`.
  void Run(const Handle& import, Work work, Done done);
  // Does work for an import that is taken.
  void Post(Work work, Done done);

  // Ends it: work is cancelled, files are removed.
  void End(const Handle& import, std::function<void()> when_gone = {});
  // Ends all, and waits for work. Later functions are not called.
  void Stop();

  const ImportSettings& settings() const { return settings_; }
  ImportProgram Program() const;

 private:
  void Watch(const Handle& import,
             std::shared_ptr<boost::asio::steady_timer> timer);
  void Remove(const Handle& import);

  ImportSettings settings_;
  const Doorkeeper& doorkeeper_;
  const std::shared_ptr<Waker> waker_;
  absl::StatusOr<std::unique_ptr<PrivateFolder>> folder_;
  int begun_ = 0;
  std::map<std::string, Handle> imports_;
  // One thread for each import, so that none waits for the program of another.
  boost::asio::thread_pool pool_{limits::kMaxImports};
};

}  // namespace tactus::internal::console
