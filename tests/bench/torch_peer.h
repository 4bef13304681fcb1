// File: torch_peer.h
//
// PyTorch's nn.LSTM on one CPU thread, in a Python process of its own that does
// one repetition whenever asked: so ours and its can take turns.
//
//   TACTUS_ASSIGN_OR_RETURN(auto peer, TorchPeer::Start());
//   if (peer == nullptr) { ... PyTorch is not installed ... }
//   TACTUS_RETURN_IF_ERROR(peer->Load({.network = &network, ...}));
//   Interleave(15, [&] { Ours(); }, [&] { return peer->Repeat(); });
//
// Owns the process. Not thread-safe.
#pragma once

#include <sys/types.h>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/lstm/network.h"

namespace tactus::client {

inline constexpr char kTorch[] = "PyTorch nn.LSTM, one thread";

// What one repetition does: steps a batch of streams through all inputs, one
// frame at a time, or makes one training step (last step's cross entropy,
// RMSprop) with them as sequences.
struct TorchCase {
  // Of tanh and sigmoid.
  const LstmNetwork* network = nullptr;
  int steps = 0;
  int batch = 0;
  // steps x batch x I.
  std::vector<float> inputs = {};
  bool train = false;
  // To train with: one label a sequence.
  std::vector<int> labels = {};
};

class TorchPeer {
 public:
  // Null where no Python can import torch.
  static absl::StatusOr<std::unique_ptr<TorchPeer>> Start();
  ~TorchPeer();

  TorchPeer(const TorchPeer&) = delete;
  TorchPeer& operator=(const TorchPeer&) = delete;

  absl::Status Load(const TorchCase& work);

  // Processor time of one repetition, s, by the process's own clock; NaN if it
  // has ended.
  double Repeat();

  // Stepped: the probabilities, steps x batch x classes. Trained: the gradient
  // by the weights before any step, layer by layer kernel, recurrent weights
  // and bias, then those of the dense layer.
  absl::StatusOr<std::vector<double>> Answer();

 private:
  TorchPeer() = default;
  absl::Status Spawn(const std::string& python);
  void Send(absl::string_view line);
  // Empty if the process has ended.
  std::string Receive();

  pid_t pid_ = -1;
  FILE* to_ = nullptr;
  FILE* from_ = nullptr;
};

}  // namespace tactus::client
