// Experiment files. One that is accepted is the same experiment after it went over the wire in its canonical form.
#include "common/experiment/experiment.hpp"

#include <nlohmann/json.hpp>

#include "common/experiment/warnings.hpp"
#include "tests/fuzz/target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace aloft;
  fuzz::accepted([&] {
    const experiment::Experiment read = experiment::parse(fuzz::text(data, size), "input");
    (void)experiment::warnings(read);
    const std::string canonical = read.canonical.dump();
    const experiment::Experiment again = experiment::parse(canonical, "canonical form");
    fuzz::require(again.id == read.id, "the canonical form has another id");
    fuzz::require(again.canonical.dump() == canonical, "the canonical form has another canonical form");
  });
  return 0;
}
