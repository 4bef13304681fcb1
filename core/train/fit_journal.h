// File: fit_journal.h
//
// FitJournal: through it a caller of FitModel watches a fit, cancels it, and
// keeps its finished parts so that an interrupted fit can continue.
//
//   class Files : public FitJournal {
//    public:
//     std::optional<std::string> Find(absl::string_view part) override {
//       return Read(part);
//     }
//     absl::Status Put(absl::string_view part, std::string bytes) override {
//       return Write(part, bytes);
//     }
//   };
//   Files files;
//   FitModel(contacts, options, RunOnThreads, progress, &files);
//
// FitModel asks for a part before it computes it. The same contacts and
// options with a journal that holds any of the parts that were put before give
// the same model, bit for bit. Parts are sealed with the SHA-256 of the
// contacts, the options and the program version: other bytes under a part's
// name end the fit with CHECKPOINT_INVALID.
//
// Parts: "inputs", "hmm/<class>", "lstm/<number>", "estimator", and these with
// "fold/<number>/" before them and "fold/<number>/scores". A network's part is
// put again after every epoch and replaces the one before. Once a fold's scores
// are there, FitModel does not ask for other parts of the fold.
//
// The base class keeps nothing and never cancels. A journal that keeps no parts
// says so, and spares the fit making and sealing them. Methods may be called
// from several threads at once.
#pragma once

#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace tactus::internal {

// A point of a learning curve.
struct LearningPoint {
  // "fit HMMs", "train LSTMs" or "calibrate on left-out folds".
  std::string phase;
  // What is trained: the name of the journal's part, with "/<component>" for
  // each HMM of a class; "fold/<number>" for a fold's scores.
  std::string part;
  // Iterations, epochs or folds done, and how many there will be at most.
  int iteration = 0;
  int max_iterations = 0;
  // HMMs: log-likelihood summed over the component's training sequences, in
  // nats. LSTMs: mean loss and accuracy of the epoch.
  std::optional<double> log_likelihood = {};
  std::optional<double> loss = {};
  std::optional<double> accuracy = {};
  // On contacts that were left out: the mean of -log(probability of the label)
  // before calibration, and the accuracy, at the end of the contact.
  std::optional<double> validation_loss = {};
  std::optional<double> validation_accuracy = {};
};

class FitJournal {
 public:
  virtual ~FitJournal() = default;

  // False: Find and Put are not called.
  virtual bool KeepsParts() const { return true; }
  // Returns the bytes that were put last under this name, if any.
  virtual std::optional<std::string> Find(absl::string_view /*part*/) {
    return std::nullopt;
  }
  // Keeps the bytes. An error ends the fit and is returned.
  virtual absl::Status Put(absl::string_view /*part*/, std::string /*bytes*/) {
    return absl::OkStatus();
  }
  virtual void OnPoint(const LearningPoint& /*point*/) {}
  // Asked before each batch of an LSTM, each iteration of Baum-Welch and each
  // contact that is scored. True ends the fit with CANCELLED.
  virtual bool Cancelled() { return false; }
};

}  // namespace tactus::internal
