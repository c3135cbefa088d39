#include "tools/reference/pages.hpp"

#include <catch2/catch.hpp>
#include <fstream>
#include <stdexcept>

#include "common/agents/registry.hpp"
#include "common/radio/generated_world.hpp"
#include "tests/integration/command.hpp"
#include "tests/paths.hpp"

using namespace aloft;
using Catch::Contains;

namespace {

const std::filesystem::path folder = test::source_dir() / "docs/reference";

std::string page(const std::string& file) {
  for (const reference::Page& one : reference::pages())
    if (one.file == file) return one.text;
  throw std::out_of_range(file);
}

}  // namespace

TEST_CASE("the reference pages are those of the tables") {
  INFO("tools/reference.sh writes them anew");
  for (const reference::Page& one : reference::pages()) CHECK(test::read_text(folder / one.file) == one.text);
}

TEST_CASE("writes the reference pages anew", "[.regenerate]") {
  for (const reference::Page& one : reference::pages()) test::write_text(folder / one.file, one.text);
}

TEST_CASE("every parameter of every agent and world has its row") {
  const std::string agents_page = page("agents.md");
  for (const agents::AgentType& type : agents::agent_types()) {
    CHECK_THAT(agents_page, Contains("\n## " + type.name + "\n" + type.description));
    for (const ParameterSpec& spec : type.parameters) CHECK_THAT(agents_page, Contains("| `" + spec.name + "` | "));
  }
  const std::string experiments = page("experiments.md");
  for (const ParameterSpec& spec : radio::generated_world_parameters())
    CHECK_THAT(experiments, Contains("| `" + spec.name + "` | "));
  CHECK_THAT(experiments, Contains("| `tx_power_w` | `40` | 0.001 to 1000 | Transmit power of every base station. |"));
  CHECK_THAT(experiments, Contains("| `los_ray` | published | geometric | geometric |"));
  CHECK_THAT(experiments, Contains("| `worlds` | "));
  CHECK_THAT(experiments, Contains("| `trials` | required | whole, 1 to "));
}

TEST_CASE("columns of the database have type and meaning; one without is a mistake") {
  CHECK_THAT(reference::database_page("CREATE TABLE flight (  -- Flights.\n  id INTEGER NOT NULL,  -- One | two.\n"
                                      "  PRIMARY KEY (id, x)\n) STRICT;\n",
                                      7),
             Contains("format 7") && Contains("\n## flight\nFlights.\n\n") &&
                 Contains("|---|---|---|\n| `id` | INTEGER NOT NULL | One \\| two. |\n\nPRIMARY KEY (id, x).\n"));
  CHECK_THROWS_AS(reference::database_page("CREATE TABLE flight (  -- Flights.\n  id INTEGER\n", 1), std::logic_error);
}
