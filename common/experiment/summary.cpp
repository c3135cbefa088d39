#include "common/experiment/summary.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "common/experiment/statistics.hpp"

namespace aloft::experiment {
namespace {

using OrderedJson = nlohmann::ordered_json;

/// All flights of one agent in one condition.
struct Sample {
  std::vector<std::uint32_t> trials;                                   // ascending
  std::vector<std::vector<double>> metrics{flight::metrics().size()};  // NaN: unknown

  [[nodiscard]] const std::vector<double>& qos() const { return metrics[flight::quality]; }
};

using SamplesByAgent = std::map<std::string, Sample, std::less<>>;

std::vector<SamplesByAgent> sorted_into_conditions(const Experiment& experiment,
                                                   std::span<const FlightSummary> flights) {
  std::vector<SamplesByAgent> conditions(experiment.conditions.size());
  for (const FlightSummary& flight : flights) {
    Sample& sample = conditions.at(flight.key.condition)[flight.key.agent];
    sample.trials.push_back(flight.key.trial);
    for (std::size_t i = 0; i < sample.metrics.size(); ++i) sample.metrics[i].push_back(flight.metrics.number(i));
  }
  return conditions;
}

/// QoS of `agent` minus QoS of `reference` on the trials that both flew.
std::vector<double> paired_gains(const Sample& agent, const Sample& reference) {
  std::vector<double> gains;
  for (const auto& [i, k] : matches(agent.trials, reference.trials))
    gains.push_back(agent.qos()[i] - reference.qos()[k]);
  return gains;
}

/// The agent that all others are compared with.
const Sample* min_height_sample(const Experiment& experiment, const SamplesByAgent& samples) {
  for (const agents::AgentSpec& spec : experiment.agents)
    if (spec.type == "min-height")
      if (const auto found = samples.find(spec.name); found != samples.end()) return &found->second;
  return nullptr;
}

/// Collects samples, so that those of one size share their resamples.
class Intervals {
 public:
  std::size_t want(std::vector<double> sample) {
    samples_.push_back(std::move(sample));
    return samples_.size() - 1;
  }
  void compute(std::uint64_t seed) {
    std::map<std::size_t, std::vector<std::size_t>> by_size;
    for (std::size_t i = 0; i < samples_.size(); ++i) by_size[samples_[i].size()].push_back(i);
    intervals_.resize(samples_.size());
    for (const auto& [size, members] : by_size) {
      std::vector<std::span<const double>> views;
      for (const std::size_t member : members) views.emplace_back(samples_[member]);
      const std::vector<Interval> intervals = bootstrap_ci95(views, seed);
      for (std::size_t i = 0; i < members.size(); ++i) intervals_[members[i]] = intervals[i];
    }
  }
  [[nodiscard]] const std::vector<double>& sample(std::size_t i) const { return samples_.at(i); }
  [[nodiscard]] const Interval& interval(std::size_t i) const { return intervals_.at(i); }

 private:
  std::vector<std::vector<double>> samples_;
  std::vector<Interval> intervals_;
};

OrderedJson number(double value) {
  return std::isfinite(value) ? OrderedJson(value) : OrderedJson();
}

OrderedJson pair_of(const Interval& interval) {
  if (!interval.known()) return nullptr;
  return OrderedJson::array({interval.low, interval.high});
}

OrderedJson agent_summary(const agents::AgentSpec& spec, const Sample& sample, const Intervals& intervals,
                          std::size_t qos, std::size_t gain) {
  OrderedJson summary{{"privilege", agents::privilege_tier(spec.privilege()).name},
                      {"trials", sample.trials.size()},
                      {flight::metrics()[flight::quality].mean_key, number(mean(sample.qos()))},
                      {"qos_ci95", pair_of(intervals.interval(qos))},
                      {"qos_median", number(quantile(sample.qos(), 0.5))},
                      {"qos_q25", number(quantile(sample.qos(), 0.25))},
                      {"qos_q75", number(quantile(sample.qos(), 0.75))}};
  for (std::size_t i = flight::quality + 1; i < sample.metrics.size(); ++i)
    summary[flight::metrics()[i].mean_key] = number(mean(sample.metrics[i]));
  summary["gain_over_min_height_mean"] = number(mean(intervals.sample(gain)));
  summary["gain_over_min_height_ci95"] = pair_of(intervals.interval(gain));
  return summary;
}

OrderedJson agent_summaries(const Experiment& experiment, SamplesByAgent& samples) {
  const Sample* reference = min_height_sample(experiment, samples);
  Intervals intervals;
  std::vector<std::pair<std::size_t, std::size_t>> wanted;  // QoS, gain
  for (const agents::AgentSpec& spec : experiment.agents) {
    const Sample& sample = samples[spec.name];
    const std::size_t qos = intervals.want(sample.qos());
    wanted.emplace_back(
        qos, intervals.want(reference == nullptr ? std::vector<double>{} : paired_gains(sample, *reference)));
  }
  intervals.compute(experiment.seed);
  OrderedJson summaries = OrderedJson::object();
  for (std::size_t i = 0; i < experiment.agents.size(); ++i) {
    const agents::AgentSpec& spec = experiment.agents[i];
    summaries[spec.name] = agent_summary(spec, samples[spec.name], intervals, wanted[i].first, wanted[i].second);
  }
  return summaries;
}

OrderedJson parameters_of(const Condition& condition) {
  OrderedJson parameters = condition.world.to_json();
  parameters["kind"] = condition.kind == WorldKind::generated ? "generated" : "measured";
  return parameters;
}

}  // namespace

radio::QosKind qos_kind(WorldKind kind) noexcept {
  return kind == WorldKind::generated ? radio::QosKind::spectral_efficiency : radio::QosKind::throughput;
}

std::string_view qos_unit(WorldKind kind) {
  return flight::metrics()[flight::quality].unit_in(qos_kind(kind)).stored;
}

OrderedJson summarise(const Experiment& experiment, std::span<const FlightSummary> flights, std::string_view build) {
  std::vector<SamplesByAgent> samples = sorted_into_conditions(experiment, flights);
  OrderedJson conditions = OrderedJson::array();
  OrderedJson common_unit = qos_unit(experiment.conditions.front().kind);
  for (const Condition& condition : experiment.conditions) {
    if (common_unit != qos_unit(condition.kind)) common_unit = nullptr;
    conditions.push_back({{"name", condition.name},
                          {"parameters", parameters_of(condition)},
                          {"qos_unit", qos_unit(condition.kind)},
                          {"agents", agent_summaries(experiment, samples[condition.index])}});
  }
  return {{"experiment", experiment.name}, {"experiment_id", experiment.id},
          {"seed", experiment.seed},       {"build", build},
          {"qos_unit", common_unit},       {"conditions", std::move(conditions)}};
}

}  // namespace aloft::experiment
