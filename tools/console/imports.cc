#include "tools/console/imports.h"

#include <unistd.h>

#include <algorithm>
#include <boost/asio/post.hpp>
#include <cstdlib>
#include <filesystem>
#include <utility>

#include "absl/base/config.h"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal::console {
namespace {

namespace asio = boost::asio;
namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

// How often an import looks whether its person is still there.
constexpr std::chrono::milliseconds kImportLook(250);

// The shadow memory of a sanitizer is larger than any limit.
constexpr bool kHasShadow =
#if defined(ABSL_HAVE_ADDRESS_SANITIZER) || defined(ABSL_HAVE_THREAD_SANITIZER)
    true;
#else
    false;
#endif

std::string ProgramBeside() {
  std::error_code error;
  const fs::path self = fs::read_symlink("/proc/self/exe", error);
  return (self.parent_path() / "trainctl").string();
}

// /tmp is often kept in memory, and the files of imports may be large.
std::string TemporaryFolder() {
  const char* own = std::getenv("TMPDIR");
  return own != nullptr && *own != '\0' ? own : "/var/tmp";
}

ImportSettings Complete(ImportSettings settings) {
  if (settings.program.empty()) settings.program = ProgramBeside();
  if (settings.folder.empty()) settings.folder = TemporaryFolder();
  if (kHasShadow) settings.memory_bytes = 0;
  return settings;
}

absl::Status LimitReached(absl::string_view message,
                          const ErrorMetadata& metadata) {
  return MakeError(absl::StatusCode::kResourceExhausted,
                   v1::ERROR_REASON_STREAM_LIMIT, message, metadata);
}

}  // namespace

Imports::Imports(ImportSettings settings, const Doorkeeper* doorkeeper,
                 std::shared_ptr<Waker> waker)
    : settings_(Complete(std::move(settings))),
      doorkeeper_(*doorkeeper),
      waker_(std::move(waker)),
      folder_(PrivateFolder::Make(settings_.folder)) {}

ImportProgram Imports::Program() const {
  return {.path = settings_.program,
          .memory_bytes = settings_.memory_bytes,
          .patience = settings_.program_patience};
}

absl::StatusOr<Imports::Handle> Imports::Begin(size_t server,
                                               const Doorkeeper::Person& person,
                                               const std::string& cookie,
                                               asio::any_io_executor executor) {
  TACTUS_RETURN_IF_ERROR(folder_.status());
  if (access(settings_.program.c_str(), X_OK) != 0) {
    return IoError("trainctl",
                   "is not installed beside the console, which needs it to "
                   "import files");
  }
  const auto own = std::ranges::count_if(imports_, [&](const auto& item) {
    return item.second->person->token == person->token;
  });
  if (own >= limits::kMaxImportsOfPerson) {
    return LimitReached("another import of yours is under way",
                        {{"import", "own"}});
  }
  if (imports_.size() >= limits::kMaxImports) {
    return LimitReached(
        absl::StrCat("other people import files; at most ", limits::kMaxImports,
                     " imports are under way at once. Try again in a minute"),
        {});
  }
  auto import = std::make_shared<Import>();
  import->id = NewSecret();
  import->server = server;
  import->person = person;
  import->cookie = cookie;
  import->folder = absl::StrCat((*folder_)->path(), "/", ++begun_);
  import->used = Clock::now();
  imports_.emplace(import->id, import);
  Watch(import, std::make_shared<asio::steady_timer>(executor));
  return import;
}

Imports::Handle Imports::Find(const std::string& id,
                              const Doorkeeper::Person& person) const {
  const auto found = imports_.find(id);
  if (found == imports_.end() || found->second->is_over ||
      found->second->person->token != person->token) {
    return nullptr;
  }
  return found->second;
}

Imports::Handle Imports::OfPerson(const Doorkeeper::Person& person) const {
  for (const auto& [id, import] : imports_) {
    if (import->person->token == person->token) return import;
  }
  return nullptr;
}

void Imports::Take(const Handle& import) { import->is_busy = true; }

void Imports::Release(const Handle& import) {
  import->is_busy = false;
  import->on_over = nullptr;
  import->used = Clock::now();
  if (import->is_over) Remove(import);
}

void Imports::Run(const Handle& import, Work work, Done done) {
  Take(import);
  Post(std::move(work), [this, import, done = std::move(done)](
                            absl::StatusOr<client::Json> answer) {
    Release(import);
    done(std::move(answer));
  });
}

void Imports::Post(Work work, Done done) {
  asio::post(pool_,
             [this, work = std::move(work), done = std::move(done)]() mutable {
               auto answer = work();
               // What work holds ends on the thread that serves browsers.
               waker_->Post([work = std::move(work), done = std::move(done),
                             answer = std::move(answer)]() mutable {
                 done(std::move(answer));
               });
             });
}

void Imports::End(const Handle& import, std::function<void()> when_gone) {
  if (when_gone) import->when_gone.push_back(std::move(when_gone));
  if (import->is_over) return;
  import->is_over = true;
  import->cancelled = true;
  if (import->on_over) std::exchange(import->on_over, nullptr)();
  if (!import->is_busy) Remove(import);
}

void Imports::Remove(const Handle& import) {
  Post(
      [import]() -> absl::StatusOr<client::Json> {
        std::error_code ignored;
        fs::remove_all(import->folder, ignored);
        return client::Json();
      },
      [this, import](const absl::StatusOr<client::Json>&) {
        imports_.erase(import->id);
        for (const auto& call : std::exchange(import->when_gone, {})) call();
      });
}

void Imports::Watch(const Handle& import,
                    std::shared_ptr<asio::steady_timer> timer) {
  timer->expires_after(kImportLook);
  timer->async_wait([this, import, timer](boost::system::error_code) {
    if (import->is_over) return;
    const bool is_forgotten = !import->is_busy && Clock::now() - import->used >
                                                      settings_.idle_patience;
    if (is_forgotten || doorkeeper_.Find(import->cookie) != import->person) {
      return End(import);
    }
    Watch(import, timer);
  });
}

void Imports::Stop() {
  for (const auto& [id, import] : imports_) import->cancelled = true;
  pool_.join();
  imports_.clear();
}

}  // namespace tactus::internal::console
