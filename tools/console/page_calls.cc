#include "tools/console/page_calls.h"

#include <boost/asio/post.hpp>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/address.h"
#include "core/base/errors.h"
#include "core/base/limits_console.h"
#include "core/base/status_macros.h"
#include "tools/console/page_json.h"

namespace tactus::internal::console {
namespace {

Response ResponseOf(const PageMethod& method, const ServerCalls::Reply& reply) {
  if (!reply.status.ok()) return ErrorOfCall(reply.status);
  auto json = JsonOfReply(method, reply.messages);
  if (!json.ok()) return ErrorOfCall(json.status());
  return JsonTextResponse(*std::move(json));
}

}  // namespace

PageCalls::PageCalls(const std::vector<ServerAddress>& servers,
                     boost::asio::thread_pool* pool,
                     std::shared_ptr<Waker> waker)
    : pool_(*pool), waker_(std::move(waker)) {
  for (const ServerAddress& server : servers) {
    client::ChannelOptions options = server.channel;
    options.max_receive_bytes = limits::kMaxPageReplyBytes;
    servers_.push_back({server, client::MakeChannel(server.address, options)});
  }
}

absl::Status PageCalls::Check(const PageTarget& target,
                              const std::string& token) const {
  if (target.server >= servers_.size()) {
    return InvalidConfig("server", target.server,
                         absl::StrCat("below ", servers_.size()));
  }
  TACTUS_RETURN_IF_ERROR(MayTakeToken(servers_[target.server].address, token));
  const auto own = by_token_.find(token);
  if (own != by_token_.end() && own->second >= limits::kMaxPageCallsOfPerson) {
    return StreamLimit("requests of one person", limits::kMaxPageCallsOfPerson);
  }
  if (all_ >= limits::kMaxPageCalls) {
    return StreamLimit("requests of pages", limits::kMaxPageCalls);
  }
  return absl::OkStatus();
}

std::shared_ptr<ServerCalls::Call> PageCalls::Start(
    const PageTarget& target, const Doorkeeper::Person& person,
    std::string body, Done done) {
  const absl::Status status = Check(target, person->token);
  if (!status.ok()) {
    done(ErrorOfCall(status));
    return nullptr;
  }
  ++all_;
  ++by_token_[person->token];
  auto trip = std::make_shared<Trip>();
  trip->method = target.method;
  trip->channel = servers_[target.server].channel;
  trip->call = std::make_shared<ServerCalls::Call>(person->token);
  trip->token = person->token;
  trip->body = std::move(body);
  trip->done = std::move(done);
  boost::asio::post(pool_, [this, trip] { Call(trip); });
  return trip->call;
}

void PageCalls::Call(const std::shared_ptr<Trip>& trip) {
  const auto request = RequestFromJson(*trip->method, trip->body);
  if (!request.ok()) return Deliver(trip, ErrorOfCall(request.status()));
  calls_.Run(trip->call, trip->channel, trip->method->Path(),
             trip->method->answer, *request,
             [this, trip](ServerCalls::Reply reply) {
               boost::asio::post(pool_, [this, trip, reply = std::move(reply)] {
                 Answer(trip, reply);
               });
             });
}

void PageCalls::Answer(const std::shared_ptr<Trip>& trip,
                       const ServerCalls::Reply& reply) {
  Deliver(trip, ResponseOf(*trip->method, reply));
}

void PageCalls::Deliver(const std::shared_ptr<Trip>& trip, Response response) {
  waker_->Post([this, trip, response = std::move(response)]() mutable {
    --all_;
    const auto own = by_token_.find(trip->token);
    if (--own->second == 0) by_token_.erase(own);
    trip->done(std::move(response));
  });
}

}  // namespace tactus::internal::console
