// File: lstm_work.h
//
// What the training of LSTMs costs, counted and not timed, so that a limit on
// it decides the same on all machines.
//
//   LstmWork(contacts, options) / 1e9;  // billions of multiplications
//
// Thread-safe: a free function without state.
#pragma once

#include <vector>

#include "core/contacts/labelled_contact.h"
#include "core/train/fit_options.h"

namespace tactus::internal {

// Multiplications of training the options' LSTMs on `contacts`, without an
// estimator of the object: three per weight and step (forwards, and backwards
// to the inputs and to the weights), for all steps of the contacts and of their
// copies, in all epochs.
double LstmWork(const std::vector<const LabelledContact*>& contacts,
                const FitOptions& options);

}  // namespace tactus::internal
