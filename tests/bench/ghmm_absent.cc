// Stands in for ghmm_peer.cc where libghmm is not installed.
#include "tests/bench/ghmm_peer.h"

namespace tactus::internal::client {

std::unique_ptr<GhmmPeer> MakeGhmmPeer(const GaussianHmm& /*model*/) {
  return nullptr;
}

}  // namespace tactus::internal::client
