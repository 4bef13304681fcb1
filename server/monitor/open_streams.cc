#include "server/monitor/open_streams.h"

#include <algorithm>
#include <utility>

namespace tactus::internal::server {

std::shared_ptr<WatchedStream> OpenStreams::Add(v1::OpenStream description) {
  auto stream =
      std::make_shared<WatchedStream>(std::move(description), followers_ > 0);
  const std::lock_guard lock(mutex_);
  streams_.push_back(stream);
  return stream;
}

void OpenStreams::Remove(const WatchedStream* stream) {
  const std::lock_guard lock(mutex_);
  const auto found =
      std::ranges::find(streams_, stream, &std::shared_ptr<WatchedStream>::get);
  (*found)->End();
  streams_.erase(found);
}

std::vector<std::shared_ptr<WatchedStream>> OpenStreams::List() const {
  const std::lock_guard lock(mutex_);
  return streams_;
}

std::shared_ptr<WatchedStream> OpenStreams::Find(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find(
      streams_, id, [](const auto& stream) { return stream->id(); });
  return found == streams_.end() ? nullptr : *found;
}

}  // namespace tactus::internal::server
