#include "tools/console/page_call.h"

#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <memory>
#include <utility>

#include "core/base/errors.h"
#include "tools/console/page_json.h"
#include "tools/console/request_checks.h"

namespace tactus::internal::console {
namespace {

// How often a call looks whether somebody waits for it.
constexpr std::chrono::milliseconds kLook(250);

// Kept by what it waits for.
class PageCall : public std::enable_shared_from_this<PageCall> {
 public:
  PageCall(PageRequest request, std::function<void(Response)> done)
      : request_(std::move(request)),
        done_(std::move(done)),
        person_(Person()),
        timer_(request_.executor) {}

  void Run() {
    if (person_ == nullptr) return End(SignedOutResponse());
    const absl::Status status =
        MayCall(*person_, request_.browsers->is_loopback);
    if (!status.ok()) return End(ErrorOfCall(status));
    call_ = request_.browsers->page_calls->Start(
        request_.target, person_, std::move(request_.body),
        [weak = weak_from_this()](Response response) {
          const auto self = weak.lock();
          if (self != nullptr) self->OnReply(std::move(response));
        });
    if (call_ != nullptr) Watch();
  }

 private:
  Doorkeeper::Person Person() const {
    return request_.browsers->doorkeeper.Find(request_.cookie);
  }

  void Watch() {
    timer_.expires_after(kLook);
    timer_.async_wait([self = shared_from_this()](boost::system::error_code) {
      if (self->done_ == nullptr) return;
      if (HasGone(self->request_.socket) || self->Person() != self->person_) {
        self->call_->Cancel();
      }
      self->Watch();
    });
  }

  void OnReply(Response response) {
    // What a person may see is for that person alone.
    End(Person() == person_ ? std::move(response) : SignedOutResponse());
  }

  void End(Response response) {
    timer_.cancel();
    std::exchange(done_, nullptr)(std::move(response));
  }

  PageRequest request_;
  std::function<void(Response)> done_;
  const Doorkeeper::Person person_;
  boost::asio::steady_timer timer_;
  std::shared_ptr<ServerCalls::Call> call_;
};

}  // namespace

void RunPageCall(PageRequest request, std::function<void(Response)> done) {
  std::make_shared<PageCall>(std::move(request), std::move(done))->Run();
}

Response SignedOutResponse() {
  return ErrorOfCall(Unauthenticated("nobody is signed in here"));
}

}  // namespace tactus::internal::console
