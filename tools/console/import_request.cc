#include "tools/console/import_request.h"

#include <unistd.h>

#include <algorithm>
#include <boost/asio/read.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cerrno>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>

#include "client/training/training_client.h"
#include "core/base/errors.h"
#include "core/base/limits_console.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "tools/console/import_target.h"
#include "tools/console/imports.h"
#include "tools/console/page_call.h"
#include "tools/console/page_json.h"
#include "tools/console/request_checks.h"

namespace tactus::internal::console {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using boost::system::error_code;
using client::Json;

constexpr std::chrono::seconds kHeadPatience(limits::kBrowserPatienceS);
constexpr std::chrono::seconds kServerPatience(5);
// How often it looks whether the browser is still there.
constexpr std::chrono::milliseconds kBrowserLook(250);

// The server's word on whether a person may have datasets, before it costs
// anybody anything.
absl::Status MayHaveDatasets(const ServerAddress& server,
                             const std::string& token) {
  client::TrainingClient client(
      client::MakeTrainingChannel(server.address, server.channel),
      {.token = token, .timeout = kServerPatience});
  v1::ListDatasetsRequest request;
  request.set_page_size(1);
  v1::ListDatasetsResponse response;
  const auto context = client.NewContext(client.timeout());
  return client::TrainingClient::ErrorOf(
      client.training().ListDatasets(context.get(), request, &response),
      "the import", client.timeout());
}

absl::Status WriteAll(int file, const std::string& bytes) {
  size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t now = write(file, bytes.data() + done, bytes.size() - done);
    if (now < 0 && errno == EINTR) continue;
    if (now < 0) return IoError("a file of the import", std::strerror(errno));
    done += static_cast<size_t>(now);
  }
  return absl::OkStatus();
}

template <class Stream>
class ImportRequest
    : public std::enable_shared_from_this<ImportRequest<Stream>> {
 public:
  ImportRequest(Stream stream, beast::flat_buffer buffer, ImportHead head,
                Browsers* browsers)
      : stream_(std::move(stream)),
        buffer_(std::move(buffer)),
        head_(std::move(head)),
        browsers_(*browsers),
        timer_(stream_.get_executor()) {
    ++browsers_.connections;
  }
  ~ImportRequest() {
    if (file_ >= 0) close(file_);
    --browsers_.connections;
  }

  void Run() {
    const Request& request = head_.request;
    const auto target = request.target();
    const auto found = FindImportStep({target.data(), target.size()});
    person_ = browsers_.doorkeeper.Find(CookieOf(request));
    if (request.method() != http::verb::post) {
      return Refuse(http::status::method_not_allowed, "no such method");
    }
    if (!HasAllowedHost(request, browsers_.is_loopback) ||
        !IsOwnOrigin(request)) {
      return Refuse(http::status::forbidden,
                    "only the console's own page may do that");
    }
    if (person_ == nullptr) return Write(SignedOutResponse());
    if (!IsFromPage(request, person_->csrf)) {
      return Refuse(http::status::forbidden,
                    "only the console's own page may do that");
    }
    if (!found) return Refuse(http::status::not_found, "no such step");
    if (!head_.body_bytes) {
      return Refuse(http::status::length_required,
                    "the body needs its length before it");
    }
    const absl::Status may = MayCall(*person_, browsers_.is_loopback);
    if (!may.ok()) return Fail(may);
    target_ = *found;
    target_.step == ImportStep::kFile ? ReceiveFile() : ReadBody();
  }

 private:
  auto& Lowest() { return beast::get_lowest_layer(stream_); }
  Imports& All() { return *browsers_.imports; }
  const ServerAddress& Server() {
    return browsers_.doorkeeper.servers()[target_.server];
  }

  // Calls `done` when the next `bytes` of the body are in `part_`, or with an
  // error.
  template <typename Done>
  void ReadPart(size_t bytes, std::chrono::milliseconds patience, Done done) {
    part_.resize(bytes);
    // Some of it came with the header.
    const size_t early = asio::buffer_copy(asio::buffer(part_), buffer_.data());
    buffer_.consume(early);
    if (early == bytes) return done(error_code());
    Lowest().expires_after(patience);
    asio::async_read(
        stream_, asio::buffer(part_) + early,
        [done = std::move(done)](error_code error, size_t) { done(error); });
  }

  void ReadBody() {
    if (*head_.body_bytes > limits::kMaxBrowserBodyBytes) {
      return Refuse(http::status::payload_too_large, "the body is too large");
    }
    ReadPart(static_cast<size_t>(*head_.body_bytes), kHeadPatience,
             [self = this->shared_from_this()](error_code error) {
               if (!error) self->OnBody();
             });
  }

  void OnBody() {
    Lowest().expires_never();
    if (target_.step == ImportStep::kBegin) return Begin();
    import_ = All().Find(target_.id, person_);
    if (import_ == nullptr) return HasEnded();
    if (target_.step == ImportStep::kEnd) return End();
    if (import_->is_busy) return IsBusy();
    const absl::Status status =
        target_.step == ImportStep::kCheck ? Check(part_) : Finish(part_);
    if (!status.ok()) Fail(status);
  }

  void Begin() {
    if (target_.server >= browsers_.doorkeeper.servers().size()) {
      return Fail(InvalidConfig(
          "server", target_.server,
          absl::StrCat("below ", browsers_.doorkeeper.servers().size())));
    }
    const absl::Status may = MayTakeToken(Server(), person_->token);
    if (!may.ok()) return Fail(may);
    const auto own = All().OfPerson(person_);
    if (own != nullptr && (target_.replaces || own->is_over)) {
      return All().End(own,
                       [self = this->shared_from_this()] { self->Begin(); });
    }
    auto begun = All().Begin(target_.server, person_, CookieOf(head_.request),
                             stream_.get_executor());
    if (!begun.ok()) return Fail(begun.status());
    import_ = *std::move(begun);
    RunStep([import = import_, server = Server()]() -> absl::StatusOr<Json> {
      TACTUS_RETURN_IF_ERROR(MayHaveDatasets(server, import->person->token));
      TACTUS_ASSIGN_OR_RETURN(import->files, ImportFiles::Make(import->folder));
      return Json{{"id", import->id},
                  {"file_bytes", limits::kMaxImportFileBytes},
                  {"bytes", limits::kMaxImportBytes},
                  {"files", limits::kMaxImportFiles}};
    });
  }

  absl::Status Check(const std::string& body) {
    TACTUS_ASSIGN_OR_RETURN(ReadOptions options,
                            ReadOptionsFrom(body, *import_->files));
    import_->is_checked = false;
    RunStep([import = import_, program = All().Program(),
             options = std::move(options)] {
      return ReadTrials(program, *import->files, options, import->cancelled);
    });
    return absl::OkStatus();
  }

  absl::Status Finish(const std::string& body) {
    TACTUS_ASSIGN_OR_RETURN(SendOptions options, SendOptionsFrom(body));
    if (!import_->is_checked) {
      return absl::FailedPreconditionError(
          "the files are not checked, or other ones came since");
    }
    RunStep([import = import_, program = All().Program(), server = Server(),
             options = std::move(options)] {
      return SendTrials(program, *import->files, options, server,
                        import->person->token, import->cancelled);
    });
    return absl::OkStatus();
  }

  void End() {
    All().End(import_, [self = this->shared_from_this()] {
      self->Write(EmptyResponse());
    });
  }

  // Works for as long as the browser waits.
  void RunStep(Imports::Work work) {
    is_running_ = true;
    WatchBrowser();
    All().Run(import_, std::move(work),
              [self = this->shared_from_this()](absl::StatusOr<Json> answer) {
                self->is_running_ = false;
                self->timer_.cancel();
                self->OnAnswer(std::move(answer));
              });
  }

  void WatchBrowser() {
    timer_.expires_after(kBrowserLook);
    timer_.async_wait([self = this->shared_from_this()](error_code) {
      if (!self->is_running_) return;
      if (HasGone(self->Lowest().socket().native_handle())) {
        return self->All().End(self->import_);
      }
      self->WatchBrowser();
    });
  }

  void OnAnswer(absl::StatusOr<Json> answer) {
    if (import_->is_over) return HasEnded();
    if (!answer.ok()) {
      if (target_.step == ImportStep::kBegin) All().End(import_);
      return Fail(answer.status());
    }
    const bool is_accepted = answer->value("accepted", false);
    if (target_.step == ImportStep::kCheck) import_->is_checked = is_accepted;
    if (target_.step == ImportStep::kFinish && is_accepted) All().End(import_);
    Write(JsonResponse(http::status::ok, *answer));
  }

  void ReceiveFile() {
    import_ = All().Find(target_.id, person_);
    if (import_ == nullptr) return HasEnded();
    if (import_->is_busy || import_->files == nullptr) return IsBusy();
    constexpr uint64_t kMost = std::numeric_limits<int64_t>::max() / 2;
    length_ = static_cast<int64_t>(std::min(*head_.body_bytes, kMost));
    const auto file = import_->files->Open(target_.name, length_);
    if (!file.ok()) return Fail(file.status());
    file_ = *file;
    import_->is_checked = false;
    All().Take(import_);
    import_->on_over = [weak = this->weak_from_this()] {
      if (const auto self = weak.lock()) self->Lowest().cancel();
    };
    ReceivePart();
  }

  void ReceivePart() {
    if (import_->is_over) return OnLost();
    const auto bytes = std::min(length_ - received_,
                                static_cast<int64_t>(limits::kImportPartBytes));
    // A part must come in time, so that a sender may be slow, but not for ever.
    ReadPart(static_cast<size_t>(bytes), All().settings().part_patience,
             [self = this->shared_from_this()](error_code error) {
               error ? self->OnLost() : self->KeepPart();
             });
  }

  void KeepPart() {
    Lowest().expires_never();
    received_ += static_cast<int64_t>(part_.size());
    All().Post(
        [self = this->shared_from_this()]() -> absl::StatusOr<Json> {
          TACTUS_RETURN_IF_ERROR(WriteAll(self->file_, self->part_));
          return Json();
        },
        [self = this->shared_from_this()](const absl::StatusOr<Json>& kept) {
          if (!kept.ok()) return self->OnLost(kept.status());
          if (self->received_ < self->length_) return self->ReceivePart();
          self->All().Release(self->import_);
          self->OnAnswer(Json{{"bytes", self->received_}});
        });
  }

  // Half a file is of no use.
  void OnLost(const absl::Status& why = absl::OkStatus()) {
    const bool was_over = import_->is_over;
    All().End(import_);
    All().Release(import_);
    if (!why.ok()) return Fail(why);
    // A browser that is gone, or too slow, gets no response.
    if (was_over) HasEnded();
  }

  void HasEnded() {
    const bool is_signed_in =
        browsers_.doorkeeper.Find(CookieOf(head_.request)) == person_;
    if (!is_signed_in) return Write(SignedOutResponse());
    Fail(absl::AbortedError("the import has ended; begin it again"));
  }
  void IsBusy() {
    Fail(absl::AbortedError("another request of the import is under way"));
  }
  void Fail(const absl::Status& status) { Write(ErrorOfCall(status)); }
  void Refuse(http::status status, absl::string_view text) {
    Write(ErrorResponse(status, text));
  }

  void Write(Response response) {
    response.keep_alive(false);
    response.prepare_payload();
    response_ = std::move(response);
    Lowest().expires_after(kHeadPatience);
    http::async_write(
        stream_, response_,
        [self = this->shared_from_this()](error_code error, size_t) {
          if (error) return;
          error_code ignored;
          self->Lowest().socket().shutdown(asio::ip::tcp::socket::shutdown_send,
                                           ignored);
          self->Discard();
        });
  }

  // A connection that is closed while bytes come is reset, and the browser may
  // not see the response.
  void Discard() {
    part_.resize(limits::kImportPartBytes);
    stream_.async_read_some(
        asio::buffer(part_),
        [self = this->shared_from_this()](error_code error, size_t) {
          if (!error) self->Discard();
        });
  }

  Stream stream_;
  beast::flat_buffer buffer_;
  ImportHead head_;
  Browsers& browsers_;
  Doorkeeper::Person person_;
  ImportTarget target_;
  Imports::Handle import_;
  // Looks whether the browser is there while a step runs.
  asio::steady_timer timer_;
  bool is_running_ = false;
  // A file that comes, and the part of it that is read or written.
  int file_ = -1;
  int64_t length_ = 0;
  int64_t received_ = 0;
  std::string part_;
  Response response_;
};

}  // namespace

template <class Stream>
void ServeImport(Stream stream, beast::flat_buffer buffer, ImportHead head,
                 Browsers* browsers) {
  std::make_shared<ImportRequest<Stream>>(std::move(stream), std::move(buffer),
                                          std::move(head), browsers)
      ->Run();
}

template void ServeImport(PlainStream, beast::flat_buffer, ImportHead,
                          Browsers*);
template void ServeImport(TlsStream, beast::flat_buffer, ImportHead, Browsers*);

}  // namespace tactus::internal::console
