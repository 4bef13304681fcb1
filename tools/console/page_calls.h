// File: page_calls.h
//
// PageCalls: what pages ask servers, in the name of the people who look at
// them. The console adds no rights: the server gets the person's token and
// decides.
//
//   PageCalls calls(servers, &pool, waker);
//   call = calls.Start(target, person, body, [](Response response) {});
//   call->Cancel();                  // its response still comes
//   calls.Stop();
//
// JSON is read and written in the pool, and no thread waits for a server. At
// most so many calls are under way as core/base/limits_console.h says. Start is
// for the thread that serves browsers, where `done` comes, once. `pool` must
// outlive the object, and have run out after Stop before that ends.
#pragma once

#include <boost/asio/thread_pool.hpp>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tools/console/doorkeeper.h"
#include "tools/console/page_methods.h"
#include "tools/console/responses.h"
#include "tools/console/server_calls.h"
#include "tools/console/waker.h"

namespace tactus::internal::console {

class PageCalls {
 public:
  using Done = std::function<void(Response)>;

  PageCalls(const std::vector<ServerAddress>& servers,
            boost::asio::thread_pool* pool, std::shared_ptr<Waker> waker);

  // Null if the call is refused; then `done` has come.
  std::shared_ptr<ServerCalls::Call> Start(const PageTarget& target,
                                           const Doorkeeper::Person& person,
                                           std::string body, Done done);
  // Cancels what is under way. Of later calls no response comes.
  void Stop() { calls_.Stop(); }

 private:
  struct Server {
    ServerAddress address;
    std::shared_ptr<grpc::Channel> channel;
  };
  // What a call needs on its way through the threads.
  struct Trip {
    const PageMethod* method = nullptr;
    std::shared_ptr<grpc::Channel> channel;
    std::shared_ptr<ServerCalls::Call> call;
    std::string token;
    std::string body;
    Done done;
  };

  absl::Status Check(const PageTarget& target, const std::string& token) const;
  void Call(const std::shared_ptr<Trip>& trip);
  void Answer(const std::shared_ptr<Trip>& trip,
              const ServerCalls::Reply& reply);
  void Deliver(const std::shared_ptr<Trip>& trip, Response response);

  std::vector<Server> servers_;
  boost::asio::thread_pool& pool_;
  const std::shared_ptr<Waker> waker_;
  ServerCalls calls_;
  // Calls under way, of all people and of each; a person is a token.
  int all_ = 0;
  std::map<std::string, int> by_token_;
};

}  // namespace tactus::internal::console
