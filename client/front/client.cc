#include "tactus/client.h"

#include <mutex>
#include <utility>

#include "client/front/remote_stream.h"
#include "client/stream/channel.h"
#include "core/base/status_macros.h"

namespace tactus {

class Client::Impl {
 public:
  Impl(std::string address, ClientOptions options)
      : address_(std::move(address)), options_(std::move(options)) {}

  absl::StatusOr<std::unique_ptr<Stream>> Open(const Skin& skin,
                                               const StreamOptions& options) {
    TACTUS_ASSIGN_OR_RETURN(const std::shared_ptr<grpc::Channel> channel,
                            Channel());
    return internal::client::OpenRemoteStream(
        channel, skin, options,
        {.timeouts = {.open = options_.open_timeout,
                      .send = options_.push_timeout,
                      .final_answer = options_.answer_timeout,
                      .close = options_.close_timeout},
         .token = options_.token,
         .resume_for = options_.resume_for,
         .replay_bytes = options_.replay_bytes});
  }

 private:
  // The one of all streams; made for the first.
  absl::StatusOr<std::shared_ptr<grpc::Channel>> Channel() {
    const std::lock_guard lock(mutex_);
    if (channel_ != nullptr) return channel_;
    internal::client::ChannelOptions channel;
    if (!options_.tls_ca.empty()) {
      TACTUS_ASSIGN_OR_RETURN(
          channel.tls_roots,
          internal::client::ReadRootCertificates(options_.tls_ca));
    }
    channel_ = internal::client::MakeChannel(address_, channel);
    return channel_;
  }

  const std::string address_;
  const ClientOptions options_;
  std::mutex mutex_;
  std::shared_ptr<grpc::Channel> channel_;
};

Client::Client(std::string address, ClientOptions options)
    : impl_(std::make_unique<Impl>(std::move(address), std::move(options))) {}
Client::~Client() = default;
Client::Client(Client&&) noexcept = default;
Client& Client::operator=(Client&&) noexcept = default;

absl::StatusOr<std::unique_ptr<Stream>> Client::Open(
    const Skin& skin, const StreamOptions& options) const {
  return impl_->Open(skin, options);
}

}  // namespace tactus
