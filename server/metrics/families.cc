#include "server/metrics/families.h"

namespace tactus::internal::server {
namespace {

using prometheus::ClientMetric;
using prometheus::MetricType;

Family Make(MetricType type, std::string name, std::string help) {
  Family family;
  family.name = std::move(name);
  family.help = std::move(help);
  family.type = type;
  return family;
}

ClientMetric& AddMetric(const Labels& labels, Family* family) {
  ClientMetric& metric = family->metric.emplace_back();
  for (const auto& [name, value] : labels)
    metric.label.push_back({name, value});
  return metric;
}

}  // namespace

Family CounterFamily(std::string name, std::string help) {
  return Make(MetricType::Counter, std::move(name), std::move(help));
}

Family GaugeFamily(std::string name, std::string help) {
  return Make(MetricType::Gauge, std::move(name), std::move(help));
}

Family HistogramFamily(std::string name, std::string help) {
  return Make(MetricType::Histogram, std::move(name), std::move(help));
}

void Add(const Labels& labels, double value, Family* family) {
  ClientMetric& metric = AddMetric(labels, family);
  if (family->type == MetricType::Counter) {
    metric.counter.value = value;
  } else {
    metric.gauge.value = value;
  }
}

void Add(const Labels& labels, const Histogram::Data& data,
         std::span<const double> bounds, Family* family) {
  ClientMetric& metric = AddMetric(labels, family);
  metric.histogram.sample_count = data.count;
  metric.histogram.sample_sum = data.sum;
  for (size_t b = 0; b < data.at_most.size(); ++b) {
    metric.histogram.bucket.push_back({data.at_most[b], bounds[b]});
  }
}

}  // namespace tactus::internal::server
