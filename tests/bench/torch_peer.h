// File: torch_peer.h
//
// PyTorch's nn.LSTM on one CPU thread, in a separate Python process. The
// process runs one repetition on request, so our code and PyTorch can take
// turns.
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

namespace tactus::internal::client {

inline constexpr char kTorch[] = "PyTorch nn.LSTM, one thread";

// The work of one repetition: step a batch of streams through all inputs, one
// frame at a time, or make one training step (cross entropy of the last step,
// RMSprop) with them as sequences.
struct TorchCase {
  // A network with tanh and sigmoid.
  const LstmNetwork* network = nullptr;
  int steps = 0;
  int batch = 0;
  // steps x batch x I.
  std::vector<float> inputs = {};
  bool train = false;
  // For training: one label per sequence.
  std::vector<int> labels = {};
};

class TorchPeer {
 public:
  // Null if no Python can import torch.
  static absl::StatusOr<std::unique_ptr<TorchPeer>> Start();
  ~TorchPeer();

  TorchPeer(const TorchPeer&) = delete;
  TorchPeer& operator=(const TorchPeer&) = delete;

  absl::Status Load(const TorchCase& work);

  // Processor time of one repetition in the Python process, s; NaN if the
  // process has ended.
  double Repeat();

  // After stepping: the probabilities, steps x batch x classes. After training:
  // the gradient with respect to the weights before the first step. Its order:
  // per layer kernel, recurrent weights and bias, then the dense layer.
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

}  // namespace tactus::internal::client
