// File: families.h
//
// Families of metrics as prometheus-cpp serialises them.
//
//   Family streams = GaugeFamily("tactus_streams", "Open streams.");
//   Add({}, 7, &streams);
//
// Thread-safe: free functions without state.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "prometheus/metric_family.h"
#include "server/metrics/histogram.h"

namespace tactus::internal::server {

using Family = prometheus::MetricFamily;
using Families = std::vector<Family>;
using Labels = std::vector<std::pair<std::string, std::string>>;

// The name of a counter ends in "_total".
Family CounterFamily(std::string name, std::string help);
Family GaugeFamily(std::string name, std::string help);
Family HistogramFamily(std::string name, std::string help);

// Adds a value to a counter or a gauge.
void Add(const Labels& labels, double value, Family* family);
void Add(const Labels& labels, const Histogram::Data& data,
         std::span<const double> bounds, Family* family);

}  // namespace tactus::internal::server
