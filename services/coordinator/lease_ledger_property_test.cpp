// The ledger against a random world: workers that die, come back, stand still and go on, messages that come late, twice
// or not at all, and a coordinator that is killed. The database of the simulation is the only truth.
#include <rapidcheck.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <deque>
#include <map>
#include <set>
#include <tuple>

#include "common/base/random.hpp"
#include "services/coordinator/lease_ledger.hpp"

using namespace aloft;
using namespace aloft::coordinator;
using namespace std::chrono_literals;

namespace {

using Flight = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;  // condition, trial, agent

struct SimulatedWorker {
  std::string name;
  bool alive = true;
  bool stopped = false;  // SIGSTOP: silent, but remembers everything
  std::uint64_t incarnation = 1;
  std::map<std::uint64_t, std::vector<Flight>> leases;
};

struct Setup {
  LedgerOptions ledger;
  std::uint32_t workers = 1;
  std::uint32_t chaos_rounds = 200;
  std::uint64_t seed = 0;
};

class Simulation {
 public:
  explicit Simulation(const Setup& setup) : setup_(setup), random_(setup.seed, 0, "simulation"), ledger_(setup.ledger) {
    for (std::uint32_t i = 0; i < setup.workers; ++i) workers_.push_back({"w" + std::to_string(i), true, false, 1, {}});
  }

  void run() {
    for (std::uint32_t round = 0; round < setup_.chaos_rounds && !ledger_.finished(); ++round) {
      make_trouble();
      advance();
    }
    for (SimulatedWorker& worker : workers_) worker.alive = true, worker.stopped = false;
    failing_ = false;
    std::uint32_t calm_rounds = 0;
    while (!ledger_.finished()) {
      advance();
      // Without trouble every round flies something, apart from the time until dead workers are noticed.
      RC_ASSERT(++calm_rounds < 1000U + 2U * ledger_.flights_total());
    }
    check_end();
  }

  [[nodiscard]] std::uint64_t duplicates() const { return duplicates_; }
  [[nodiscard]] bool complete() const {
    return database_.size() == ledger_.flights_total() && ledger_.flights_stored() == ledger_.flights_total();
  }

 private:
  bool happens(double probability) { return random_.uniform() < probability; }

  void make_trouble() {
    failing_ = true;
    SimulatedWorker& worker = workers_[random_.uniform_index(static_cast<std::uint32_t>(workers_.size()))];
    if (happens(0.05)) {  // kill -9
      worker.alive = false;
      worker.leases.clear();
    } else if (!worker.alive && happens(0.5)) {  // started again, perhaps before anyone noticed
      worker.alive = true;
      ++worker.incarnation;
    } else if (happens(0.05)) {
      worker.stopped = !worker.stopped;
    }
    if (happens(0.02)) restart_coordinator();
  }

  void restart_coordinator() {
    LedgerOptions options = setup_.ledger;
    options.first_grant = random_.next_u32();
    ledger_ = LeaseLedger(options);
    for (const Flight& flight : database_) std::apply([this](auto... at) { ledger_.flight_stored(at...); }, flight);
    acknowledgements_.clear();
  }

  void advance() {
    now_ += 500ms;
    for (SimulatedWorker& worker : workers_)
      if (worker.alive && !worker.stopped) work(worker);
    deliver();
    ledger_.expire(now_);
    for (Lease lease; ledger_.grant(now_, lease);) assign(lease);
    check_counts();
  }

  void work(SimulatedWorker& worker) {
    std::vector<std::uint64_t> listed;
    for (auto& [id, flights] : worker.leases) {
      listed.push_back(id);
      if (!flights.empty() && failing_ && happens(0.02)) {
        ledger_.lease_failed(id, "simulated");
        flights.clear();
      } else if (!flights.empty()) {
        records_.push_back(flights.back());  // at-least-once: sometimes twice, sometimes again later
        if (happens(0.1)) records_.push_back(flights.back());
        if (!happens(0.1)) flights.pop_back();
      }
    }
    std::erase_if(worker.leases, [](const auto& lease) { return lease.second.empty(); });
    const HeartbeatResult result = ledger_.heartbeat({worker.name, worker.incarnation, 3, listed}, now_);
    for (const std::uint64_t id : result.cancel) worker.leases.erase(id);
  }

  void deliver() {
    while (!records_.empty() && (!failing_ || happens(0.8))) {
      const auto at = records_.begin() + random_.uniform_index(static_cast<std::uint32_t>(records_.size()));
      if (!database_.insert(*at).second) ++duplicates_;
      acknowledgements_.push_back(*at);
      records_.erase(at);
    }
    while (!acknowledgements_.empty() && (!failing_ || happens(0.8))) {
      std::apply([this](auto... at) { ledger_.flight_stored(at...); }, acknowledgements_.front());
      acknowledgements_.pop_front();
    }
  }

  void assign(const Lease& lease) {
    const auto worker =
        std::find_if(workers_.begin(), workers_.end(), [&](const auto& w) { return w.name == lease.worker; });
    RC_ASSERT(worker != workers_.end());
    RC_ASSERT(ledger_.state(lease.condition, lease.trial) == TrialState::leased);
    if (setup_.ledger.lineages > 0 && lease.trial >= setup_.ledger.lineages)
      RC_ASSERT(ledger_.state(lease.condition, lease.trial - setup_.ledger.lineages) == TrialState::done);
    std::vector<Flight> flights;
    flights.reserve(lease.agents.size());
    for (const std::uint32_t agent : lease.agents) flights.emplace_back(lease.condition, lease.trial, agent);
    RC_ASSERT_FALSE(flights.empty());
    for (const Flight& flight : flights)
      RC_ASSERT_FALSE(std::apply([this](auto... at) { return ledger_.is_stored(at...); }, flight));
    if (!worker->alive || worker->stopped || (failing_ && happens(0.1))) return;  // the assignment is lost
    worker->leases.emplace(lease.id, flights);
  }

  void check_counts() {
    std::array<std::uint64_t, trial_states> counts{};
    for (std::uint32_t condition = 0; condition < setup_.ledger.conditions; ++condition)
      for (std::uint32_t trial = 0; trial < setup_.ledger.trials; ++trial)
        ++counts[static_cast<std::size_t>(ledger_.state(condition, trial))];
    for (std::size_t state = 0; state < trial_states; ++state)
      RC_ASSERT(counts[state] == ledger_.count(static_cast<TrialState>(state)));
    RC_ASSERT(ledger_.flights_stored() <= database_.size());
  }

  void check_end() {
    std::uint64_t missing_trials = 0;
    for (std::uint32_t condition = 0; condition < setup_.ledger.conditions; ++condition) {
      for (std::uint32_t trial = 0; trial < setup_.ledger.trials; ++trial) {
        std::uint32_t stored = 0;
        for (std::uint32_t agent = 0; agent < setup_.ledger.agents; ++agent)
          stored += static_cast<std::uint32_t>(database_.count({condition, trial, agent}));
        const bool complete = stored == setup_.ledger.agents;
        if (ledger_.state(condition, trial) == TrialState::done) RC_ASSERT(complete);
        if (!complete) ++missing_trials;
      }
    }
    RC_ASSERT(missing_trials <= ledger_.count(TrialState::failed));
    RC_ASSERT(ledger_.count(TrialState::failed) + ledger_.count(TrialState::done) ==
              std::uint64_t{setup_.ledger.conditions} * setup_.ledger.trials);
  }

  Setup setup_;
  RandomStream random_;
  LeaseLedger ledger_;
  std::vector<SimulatedWorker> workers_;
  std::vector<Flight> records_;          // on their way to the collector
  std::deque<Flight> acknowledgements_;  // on their way to the coordinator
  std::set<Flight> database_;
  Clock::time_point now_{};
  bool failing_ = false;
  std::uint64_t duplicates_ = 0;
};

/// Full range from the first case on; RapidCheck would start with the smallest values.
std::uint32_t number_between(std::uint32_t low, std::uint32_t high) {
  return *rc::gen::resize(100, rc::gen::inRange<std::uint32_t>(low, high + 1));
}

Setup arbitrary_setup() {
  Setup setup;
  setup.ledger.conditions = number_between(1, 3);
  setup.ledger.trials = number_between(1, 100);
  setup.ledger.agents = number_between(1, 5);
  setup.ledger.max_attempts = number_between(1, 4);
  setup.ledger.lineages = *rc::gen::element<std::uint32_t>(0, 0, 1, 3);
  setup.ledger.order = *rc::gen::element(TrialOrder::canonical, TrialOrder::shuffled);
  setup.workers = number_between(1, 8);
  setup.seed = *rc::gen::resize(100, rc::gen::arbitrary<std::uint64_t>());
  return setup;
}

}  // namespace

TEST_CASE("nothing is lost or doubled, and it ends, whatever happens", "[ledger][property]") {
  CHECK(rc::check("random worlds", [] {
    Setup setup = arbitrary_setup();
    for (int repeat = 0; repeat < 10; ++repeat, ++setup.seed) Simulation(setup).run();
  }));
}

TEST_CASE("without failing flights everything is stored, whichever process dies", "[ledger][property]") {
  std::uint64_t duplicates = 0;
  CHECK(rc::check("enough attempts", [&] {
    Setup setup = arbitrary_setup();
    setup.ledger.max_attempts = 255;
    setup.ledger.max_losses = 255;
    Simulation simulation(setup);
    simulation.run();
    duplicates += simulation.duplicates();
    RC_ASSERT(simulation.complete());
  }));
  CHECK(duplicates > 0);  // else the simulation never repeated a message
}
