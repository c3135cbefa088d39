// Results of Aloft 0.2.0: a run that was interrupted after 21 of 63 flights (results-0.2.0/interrupted), and the
// summary of the whole experiment. Later versions can add columns, but must not change one.
#include <catch2/catch.hpp>
#include <filesystem>
#include <map>
#include <sstream>

#include "common/base/digest.hpp"
#include "common/learn/network.hpp"
#include "tests/integration/command.hpp"
#include "tests/paths.hpp"
#include "tests/skip.hpp"

using namespace aloft::test;

namespace {

const std::filesystem::path folder = source_dir() / "tests/golden/results-0.2.0";
constexpr const char* digest_interrupted = "986af6a933bfd55cc65f522c8fcf20b09b8d8ecd6dc4568380dd9714383b9dc5";
constexpr const char* digest_complete = "b626d8df1f2bfe0f644fc23dc7d95ade3973a7890f65e472d4126f52d47e1b6f";

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

/// The cells of each column, by its name. No cell of these files holds a comma.
std::map<std::string, std::vector<std::string>> columns(const std::string& csv) {
  const std::vector<std::string> lines = split(csv, '\n');
  const std::vector<std::string> names = split(lines.at(0), ',');
  std::map<std::string, std::vector<std::string>> columns;
  for (std::size_t row = 1; row < lines.size(); ++row) {
    std::vector<std::string> cells = split(lines[row], ',');
    cells.resize(names.size());
    for (std::size_t i = 0; i < names.size(); ++i) columns[names[i]].push_back(cells[i]);
  }
  return columns;
}

/// A CSV with these columns alone, in this order.
std::string with_columns(const std::string& csv, const std::vector<std::string>& names) {
  const auto all = columns(csv);
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ",") + name;
  text += '\n';
  for (std::size_t row = 0; row < all.at(names.front()).size(); ++row)
    for (const std::string& name : names) text += all.at(name)[row] + (&name == &names.back() ? '\n' : ',');
  return text;
}

/// Compares the first `rows` of a stored file; 0: all.
void check_same_columns(const std::string& now, const std::filesystem::path& stored, std::size_t rows = 0) {
  auto found = columns(now);
  auto expected = columns(read_text(stored));
  for (auto& [name, cells] : expected) {
    if (rows != 0) cells.resize(rows);
    INFO(stored.filename().string() << ", column " << name);
    CHECK(found[name] == cells);
  }
}

std::string output_of(const std::vector<std::string>& arguments) {
  const Finished finished = run_command(arguments);
  INFO(finished.err);
  CHECK(finished.exit_code == 0);
  return finished.out;
}

std::string copy_of_results(const ScratchDir& scratch) {
  std::filesystem::copy(folder / "interrupted", scratch / "results");
  return (scratch / "results").string();
}

}  // namespace

TEST_CASE("results of version 0.2.0 are read as they are") {
  const ScratchDir scratch;
  const std::string results = copy_of_results(scratch);
  CHECK(output_of({"aloft", "digest", results}) == std::string(digest_interrupted) + "\n");
  check_same_columns(output_of({"aloft", "export", results, "--flights"}), folder / "flights.csv", 21);
}

TEST_CASE("an interrupted run of version 0.2.0 goes on to the results of that version", "[needs-avx2]") {
  if (aloft::learn::available_paths().back() == aloft::learn::Path::portable)
    return skip("this CPU has no AVX2 with FMA, and the portable code rounds differently");
  const ScratchDir scratch;
  const std::string results = copy_of_results(scratch);
  const Finished run =
      run_command({"aloft", "run", (folder / "results.json").string(), "--in-process", "--out", results});
  INFO(run.err);
  CHECK(run.exit_code == 0);
  CHECK_THAT(run.err, Catch::Contains("21 of 63 flights are already there"));
  CHECK(output_of({"aloft", "digest", results}) == std::string(digest_complete) + "\n");
  check_same_columns(output_of({"aloft", "export", results, "--flights"}), folder / "flights.csv");
  check_same_columns(read_text(scratch / "results/summary.csv"), folder / "summary.csv");
  const std::vector<std::string> columns_then{
      "condition", "trial",    "agent",        "privilege",       "qos_unit", "step",   "action",   "flown_by", "x_m",
      "y_m",       "height_m", "serving_cell", "serving_sinr_db", "qos",      "reward", "energy_j", "epsilon",  "loss",
      "q_down",    "q_hold",   "q_up"};
  CHECK(aloft::sha256_hex(with_columns(output_of({"aloft", "export", results, "--steps"}), columns_then)) ==
        "c3c85c64d31cb1139068869e6de09b8f79a9ce2a9c1445225bb3e9cd0edb6336");
}
