// Writes first inputs for the fuzz targets, made by the code that writes such data in earnest:
//   aloft_fuzz_seeds FOLDER      FOLDER/TARGET/NAME
#include <fmt/format.h>
#include <idl/agent_state.pb.h>
#include <idl/model.pb.h>

#include <cstdio>
#include <filesystem>

#include "common/agents/pretrained_model.hpp"
#include "common/base/read_file.hpp"
#include "common/base/write_file.hpp"
#include "common/bus/guard/testing/bad_datagrams.hpp"
#include "common/bus/testing/sample_limits.hpp"
#include "common/flight/testing/synthetic_map.hpp"
#include "common/store/result_store.hpp"
#include "tests/faults/rogue.hpp"
#include "tests/fuzz/receive.hpp"
#include "tests/fuzz/remembering.hpp"
#include "tests/fuzz/target.hpp"
#include "tests/paths.hpp"
#include "tools/importer/test_npz.hpp"
#include "tools/importer/test_workspace.hpp"

namespace {

using namespace aloft;
namespace fs = std::filesystem;

constexpr std::size_t largest_seed_bytes = 4096;  // libFuzzer makes nothing longer of shorter ones

class Seeds {
 public:
  explicit Seeds(fs::path folder) : folder_(std::move(folder)) { fs::remove_all(folder_); }

  void add(const std::string& target, const std::string& name, const std::string& bytes) {
    fs::create_directories(folder_ / target);
    write_file(folder_ / target / name, bytes);
  }

 private:
  fs::path folder_;
};

template <class T, class Generated>
void add_payloads(Seeds& seeds, std::size_t row) {
  const std::string topic(bus::topic_settings<T>().name);
  const auto add = [&](const std::string& name, const T& sample) {
    const std::vector<unsigned char> payload = test::Rogue<T, Generated>::bytes_of(sample);
    if (payload.size() > largest_seed_bytes) return false;
    seeds.add("wire", name, static_cast<char>(row) + std::string(payload.begin(), payload.end()));
    return fuzz::receivers[row](payload);
  };
  fuzz::require(add(topic, bus::testing::SampleLimits<T>::good()), "a good sample is refused");
  int number = 0;
  for (const auto& [what, spoil] : bus::testing::SampleLimits<T>::spoilers()) {
    T sample = bus::testing::SampleLimits<T>::good();
    spoil(sample);
    fuzz::require(!add(fmt::format("{}-{}", topic, ++number), sample), "a bad sample is accepted");
  }
}

void add_all_payloads(Seeds& seeds) {
  std::size_t row = 0;
#define ALOFT_TOPIC(type, ...) add_payloads<wire::type, wire::type##PubSubType>(seeds, row++);
#include "common/bus/topics.def"
}

/// What every agent remembers, and the trace of its flight.
void add_flights(Seeds& seeds) {
  const std::vector<agents::AgentSpec>& specs = fuzz::agents_with_state();
  for (std::size_t i = 0; i < specs.size(); ++i) {
    flight::SyntheticMap map = flight::SyntheticMap::random(radio::QosKind::throughput, 6, 5, 1);
    const std::unique_ptr<agents::Agent> agent = specs[i].make();
    const flight::FlightRecord record = flight::fly(map, 1, 0, *agent, specs[i]);
    seeds.add("trace", fmt::format("{}-{}", i, specs[i].type), store::encode_trace(record));
    proto::SealedAgentState sealed;
    fuzz::require(sealed.ParseFromString(agent->save_state()), "a state is not sealed");
    seeds.add("agent_state", fmt::format("{}-{}", i, specs[i].type), static_cast<char>(i) + sealed.state());
  }
}

void add_model(Seeds& seeds) {
  const agents::PretrainedModel::Network network{1, std::vector<float>(agents::pretrained_shape(1).parameters(), 0.5F)};
  const std::string file = agents::PretrainedModel{network, network, "{}"}.to_bytes();
  proto::SealedModel sealed;
  fuzz::require(sealed.ParseFromString(file), "a model is not sealed");
  seeds.add("model", "file", file);
  seeds.add("model", "content", sealed.model());
}

void add_datagrams(Seeds& seeds) {
  using namespace bus::guard::testing;
  int number = 0;
  const auto sized = [](const Bytes& bytes) {
    const std::string size{static_cast<char>(bytes.size() % 256), static_cast<char>(bytes.size() / 256)};
    return size + std::string(bytes.begin(), bytes.end());
  };
  for (const bool little : {true, false}) {
    std::string all;
    for (const auto& [what, bytes] : good_datagrams(little)) all += sized(bytes);
    seeds.add("datagram", little ? "good" : "good-big-endian", all);
    for (const Bad& bad : bad_datagrams(little))
      seeds.add("datagram", fmt::format("bad-{}", ++number), sized(bad.bytes));
  }
}

void add_texts(Seeds& seeds) {
  for (const auto& file : fs::directory_iterator(test::source_dir() / "data/experiments"))
    seeds.add("experiment", file.path().filename(), read_file(file.path()));
  const std::string csv = read_file(test::source_dir() / "data/samples/measured_sample.csv");
  seeds.add("measured_flight", "beginning", csv.substr(0, largest_seed_bytes));
  seeds.add("measured_flight", "all-columns",
            "step,height_m,throughput_kbps,sinr_db,latitude,longitude,serving_cell,observed\n"
            "1,20,1e4,3.5,53.3,-6.2,7,1\n1,30,2e4,4.5,53.3,-6.2,8,0\n");
  seeds.add("measured_flight", "derived", "height_m,step,throughput_kbps\r\n20,1,29020\r\n30,1,76650\r\n");
  seeds.add("measured_sites", "required", "cell,latitude,longitude,antenna_height_m\n7,53.341,-6.239,25\n");
  seeds.add("measured_sites", "all-columns",
            "azimuth_deg,power_w,cell,latitude,longitude,antenna_height_m\r\n120,40,270000001,53.34,-6.24,30\r\n"
            "0,2e1,8,53.35,-6.2,18.5\r\n");
  const std::string scatter = read_file(test::source_dir() / "data/samples/scatter_sample.csv");
  seeds.add("scatter", "sample", scatter.substr(0, scatter.rfind('\n', largest_seed_bytes) + 1));
  seeds.add("scatter", "two-heights",
            "time,latitude,longitude,altitude_m,cell,sinr_db\n0,0,0,20,1,5\n\"10\",0,0.0001,20,1,6\n"
            "2026-05-01 12:00:00+02:00,0,0,30,2,-7\n2026-05-01T12:00:10.5Z,0,0.0001,30,2,8\n");
  seeds.add("radio_map", "npz", importer::test::npz(importer::test::small_map()));
  seeds.add("radio_map", "packed", read_file(test::source_dir() / "data/samples/map_sample.npz"));
  for (const auto& [name, content] : importer::test::small_map()) seeds.add("radio_map", name, content);
  const std::string workspace = importer::test::xdr_workspace({{"history", std::vector<double>{1.0}, true},
                                                               {"rate", std::vector<double>{46905.66, 0.1}},
                                                               {"level", std::vector<std::int32_t>{1, -7}},
                                                               {"empty", std::vector<double>{}}});
  const importer::test::Recorder recorder{2, 2, {1e4, 2e4, 3e4, 4e4}};
  const auto vectors = recorder.record(importer::test::one_flight_per_level(recorder));
  seeds.add("r_workspace", "other-forms",
            importer::test::xdr_workspace({}, importer::test::sequence(3.0) + importer::test::wrapped({0.5})));
  seeds.add("r_workspace", "vectors", workspace);
  seeds.add("r_workspace", "packed", importer::test::gzip(workspace));
  seeds.add("r_workspace", "flights", importer::test::xdr_workspace(importer::test::objects(vectors)));
  seeds.add("http", "get", "GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n");
  seeds.add("http", "two", "GET /healthz?x HTTP/1.1\r\nHost: [::1]:9\r\n\r\nHEAD /metrics HTTP/1.0\r\n\r\n");
  seeds.add("http", "body", "POST / HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 3\r\n\r\nabc");
  seeds.add("http", "chunks",
            "PUT / HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n2;x=1\r\nab\r\n0\r\nT: 1\r\n\r\n");
  seeds.add("http", "close", "GET /x HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nExpect: 100-continue\r\n\r\n");
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) {
    std::fputs("usage: aloft_fuzz_seeds FOLDER, which is replaced\n", stderr);
    return exit_bad_input;
  }
  Seeds seeds(arguments[1]);
  add_all_payloads(seeds);
  add_flights(seeds);
  add_model(seeds);
  add_datagrams(seeds);
  add_texts(seeds);
  return exit_ok;
}
