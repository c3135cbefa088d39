// Unbounded input: too much, too long, endless, out of range. Each is refused at once with exit code 2 and a short
// message that says what is wrong and what to do; nothing is written.
#include <sys/stat.h>

#include <catch2/catch.hpp>

#include "tests/integration/command.hpp"
#include "tests/paths.hpp"

using aloft::test::Finished;
using aloft::test::run_command;
using aloft::test::ScratchDir;
using aloft::test::test_domain;
using aloft::test::write_text;
using Catch::Contains;

namespace {

const std::string megabyte(1 << 20, 'x');

std::string experiment_of(const std::string& world, const std::string& agents, const std::string& trials = "2") {
  return R"({"name": "small", "seed": 3, "trials": )" + trials + R"(, "world": {)" + world + R"(}, "agents": [)" +
         agents + "]}";
}

std::string list(int values) {
  std::string text = "[0";
  for (int i = 1; i < values; ++i) text += "," + std::to_string(i);
  return text + "]";
}

/// The message of a refused command; the time limit is many times what it needs.
std::string refusal(const std::vector<std::string>& arguments) {
  const Finished finished = run_command(arguments, std::chrono::seconds(20));
  INFO(finished.err);
  CHECK(finished.exit_code == 2);
  CHECK(finished.out.empty());
  CHECK(finished.err.size() < 4096);
  return finished.err;
}

/// The message by which both "run" and "validate" refuse an experiment.
std::string refusal_of(const std::string& text, const std::vector<std::string>& options = {}) {
  const ScratchDir scratch;
  const std::string file = (scratch / "experiment.json").string();
  write_text(file, text);
  const auto with = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), options.begin(), options.end());
    return arguments;
  };
  std::string said = refusal(with({"aloft", "run", file, "--in-process", "--out", (scratch / "out").string()}));
  CHECK_FALSE(std::filesystem::exists(scratch / "out"));
  refusal(with({"aloft", "validate", file}));
  return said;
}

}  // namespace

TEST_CASE("sweeps are counted before they are expanded") {
  const std::string thousand = list(1000);
  CHECK_THAT(refusal_of(experiment_of("", R"({"type": "dqn", "epochs": )" + thousand + R"(, "hidden_width": )" +
                                              thousand + R"(, "minibatch": )" + thousand + "}")),
             Contains("agents[0]") && Contains("1000000000 combinations") && Contains("at most 64 agents"));
  CHECK_THAT(refusal_of(experiment_of(
                 "", R"({"type": "dqn", "epochs": )" + list(1733) + R"(, "hidden_width": )" + list(1733) + "}")),
             Contains("3003289 combinations"));
  CHECK_THAT(refusal_of(experiment_of(R"("bs_density_per_km2": )" + list(200'000), R"("min-height")")),
             Contains("world.bs_density_per_km2") && Contains("200000 values") && Contains("10000"));
  CHECK_THAT(refusal_of(experiment_of(R"("bs_density_per_km2": [1, 2, 3], "los_ray": ["published", "geometric"])",
                                      R"("min-height")", "2000000")),
             Contains("6 conditions x 2000000 trials = 12000000 trials") && Contains("at most 10000000"));
}

TEST_CASE("pipes and devices are refused as files") {
  const ScratchDir scratch;
  const std::string pipe = (scratch / "pipe").string();
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  for (const std::string& endless : {pipe, std::string("/dev/zero")}) {
    INFO(endless);
    const auto refuses = [&](const std::vector<std::string>& arguments) {
      CHECK_THAT(refusal(arguments), Contains("'" + endless + "': it is a "));
    };
    refuses({"aloft", "run", endless});
    refuses({"aloft", "validate", endless});
    refuses({"aloft", "coordinator", endless, "--run", "x", "--out", (scratch / "out").string()});
    refuses({"aloft", "import-rdata", endless, "--out", (scratch / "grid.csv").string()});
    refuses({"aloft", "import-scatter", endless, "--sinr", "sinr", "--out", (scratch / "grid.csv").string()});
    refuses({"aloft", "import-map", endless, "--route", "0,0", "--out", (scratch / "grid.csv").string()});
    refuses({"aloft", "train", "pretrained", "--config", endless, "--out", (scratch / "model.pb").string()});
    CHECK_THAT(refusal_of(experiment_of(R"("kind": "measured", "file": ")" + endless + "\"", R"("min-height")")),
               Contains("world.file") && Contains(endless));
    CHECK_THAT(refusal_of(experiment_of("", R"({"type": "pretrained", "model": ")" + endless + "\"}")),
               Contains(endless));
    CHECK_THAT(
        refusal_of(experiment_of("", R"({"type": "pretrained", "model_sha256": "0", "model": ")" + endless + "\"}")),
        Contains(endless));
  }
  std::filesystem::create_directory(scratch / "results");
  REQUIRE(::mkfifo((scratch / "results" / "results.sqlite").c_str(), 0600) == 0);
  CHECK_THAT(refusal({"aloft", "digest", (scratch / "results").string()}), Contains("is no result folder"));
  std::filesystem::create_directory(scratch / "keys");
  REQUIRE(::mkfifo((scratch / "keys" / "ca.cert.pem").c_str(), 0600) == 0);
  CHECK_THAT(refusal({"aloft", "keys", "issue", (scratch / "keys").string(), "all"}), Contains("is a pipe"));
  CHECK_THAT(refusal({"aloft", "run", "data/experiments/quick.json", "--out", (scratch / "out").string(), "--secure",
                      (scratch / "keys").string()}),
             Contains(ALOFT_SECURED_RUNS == 1 ? "is a pipe" : "a run cannot be secured on Fast DDS"));
}

TEST_CASE("numbers out of range, and texts that are no number, are refused by name") {
  const std::string file = "data/experiments/quick.json";
  CHECK_THAT(refusal({"aloft", "run", file, "--seed", "18446744073709551616"}),
             Contains("--seed") && Contains("18446744073709551615"));
  CHECK(run_command({"aloft", "validate", file, "--seed", "18446744073709551615"}).exit_code == 0);
  CHECK_THAT(refusal({"aloft", "run", file, "--trials", "4294967297"}), Contains("--trials") && Contains("10000000"));
  CHECK_THAT(refusal_of(experiment_of("", R"("min-height")"), {"--set", "seed=1e300"}), Contains("seed"));
  CHECK_THAT(refusal({"aloft", "run", file, "--fail-fast", "-1"}), Contains("--fail-fast"));
  CHECK_THAT(refusal({"aloft", "inspect", "table", file, "--trial", "-1"}), Contains("--trial"));
  CHECK_THAT(refusal({"aloft", "inspect", "table", file, "--explain", "4,nan"}), Contains("--explain"));
  for (const char* endless : {"nan", "inf", "-nan", "1e999"}) {
    CHECK_THAT(refusal({"aloft", "worker", "--join", "x", "--wait", endless}), Contains("--wait"));
    CHECK_THAT(refusal({"aloft", "status", "--wait", endless}), Contains("--wait"));
    for (const char* flag : {"--give-up-after", "--heartbeat-timeout", "--claim-timeout"})
      CHECK_THAT(refusal({"aloft-coordinator", "--experiment", "x", "--results", "x", flag, endless}), Contains(flag));
    for (const char* flag : {"--height-min", "--height-step"})
      CHECK_THAT(refusal({"aloft", "import-rdata", "x", "--out", "/tmp/x.csv", flag, endless}), Contains(flag));
    for (const char* flag : {"--radius", "--hole-max", "--apart", "--bandwidth", "--height-max", "--serving-load"})
      CHECK_THAT(refusal({"aloft", "import-scatter", "x", "--sinr", "s", "--out", "/tmp/x.csv", flag, endless}),
                 Contains(flag));
    CHECK_THAT(refusal({"aloft", "import-map", "x", "--route", "0,0", "--out", "/tmp/x.csv", "--floor", endless}),
               Contains("--floor"));
  }
}

TEST_CASE("more workers than a domain has room for are refused with the number that fits") {
  const ScratchDir scratch;
  const std::string out = (scratch / "out").string();
  const std::string file = "data/experiments/quick.json";
  CHECK_THAT(refusal({"aloft", "run", file, "--out", out, "--workers", "25"}),
             Contains("--workers 25") && Contains("at most 24") && Contains("--in-process"));
  CHECK_FALSE(std::filesystem::exists(out));
  CHECK(run_command({"aloft", "run", file, "--out", out, "--trials", "1", "--agents", "min-height", "--in-process",
                     "--workers", "30"})
            .exit_code == 0);
}

TEST_CASE("names of runs and workers with other characters are refused, wherever they are given") {
  const ScratchDir scratch;
  for (const std::string& name :
       {std::string("../../x"), std::string(".."), std::string("a b"), std::string(), std::string(65, 'x')}) {
    INFO(name);
    const auto refuses = [](const std::vector<std::string>& arguments) {
      CHECK_THAT(refusal(arguments), Contains("1 to 64 letters, digits"));
    };
    refuses({"aloft", "worker", "--join", "x", "--name", name});
    refuses({"aloft", "worker", "--join", name});
    refuses({"aloft", "run", "data/experiments/quick.json", "--run", name});
    refuses({"aloft", "status", "--run", name});
    refuses({"aloft", "metrics", "--run", name, "--out", "x"});
    refuses({"aloft", "swap", "--run", name, "--worker", "w0", "--agent", "dqn"});
    refuses({"aloft", "swap", "--run", "x", "--worker", name, "--agent", "dqn"});
    refuses({"aloft", "keys", "issue", (scratch / "keys").string(), "all", "--name", name});
    refuses({"aloft-channel", "--run", "x", "--worker", name, "--log-dir", (scratch / "a" / "b").string()});
  }
  CHECK(std::filesystem::is_empty(scratch.path()));
  for (const char* agent : {"", "Dqn", "../x"}) {
    CHECK_THAT(refusal({"aloft", "swap", "--run", "x", "--worker", "w0", "--agent", agent}), Contains("--agent"));
    CHECK_THAT(refusal({"aloft", "worker", "--join", "x", "--agents", agent}), Contains("--agents"));
    CHECK_THAT(refusal({"aloft", "run", "data/experiments/quick.json", "--agents", agent}), Contains("--agents"));
  }
}

TEST_CASE("a message repeats no more of its input than a reader needs") {
  const std::string text = '"' + megabyte + '"';
  const std::string agent = R"("min-height")";
  CHECK_THAT(refusal_of(megabyte), Contains("experiment.json"));
  CHECK_THAT(refusal_of(text), Contains("is not an experiment") && Contains("(1048578 bytes)"));
  CHECK_THAT(refusal_of(experiment_of(R"("bs_density_per_km2": )" + text, agent)), Contains("use a number from"));
  CHECK_THAT(refusal_of(experiment_of(R"("bs_density_per_km2": [)" + text + "," + text + "]", agent)),
             Contains("stands twice"));
  CHECK_THAT(refusal_of(experiment_of(text + ": 3", agent)), Contains("unknown key") && Contains("los_ray"));
  CHECK_THAT(refusal_of(experiment_of(R"("kind": )" + text, agent)), Contains("\"measured\""));
  CHECK_THAT(refusal_of(experiment_of(R"("name": )" + text, agent)), Contains("1 to 200"));
  CHECK_THAT(refusal_of(experiment_of(R"("kind": "measured", "file": )" + text, agent)), Contains("cannot read"));
  CHECK_THAT(refusal_of(experiment_of("", text)), Contains("unknown agent") && Contains("min-height"));
  CHECK_THAT(refusal_of(experiment_of("", R"({"type": "constant", "name": "c", "height_m": )" + text + "}")),
             Contains("height_m"));
  CHECK_THAT(refusal_of(experiment_of("", R"({"type": "constant", "name": )" + text + "}")), Contains("1 to 64"));
  CHECK_THAT(refusal_of(experiment_of("", agent, text)), Contains("trials") && Contains("10000000"));
  CHECK_THAT(refusal_of("{" + text + ": 1}"), Contains("unknown key"));
  CHECK_THAT(refusal_of("{" + text + ": 1, " + text + ": 1}"), Contains("stands twice"));
  const std::string argument(100'000, 'x');
  CHECK_THAT(refusal_of(experiment_of("", agent), {"--set", "trials=" + argument}), Contains("trials"));
  CHECK_THAT(refusal_of(experiment_of("", agent), {"--set", argument + ".x=1"}), Contains("--set"));
  CHECK_THAT(refusal_of(experiment_of("", agent), {"--agents", argument}), Contains("--agents"));
  CHECK_THAT(refusal_of(experiment_of("", agent), {"--seed", argument}), Contains("18446744073709551615"));
  CHECK_THAT(refusal({"aloft", argument}), Contains("--help"));
  const ScratchDir scratch;
  const std::string csv = (scratch / "flight.csv").string();
  const std::string measured = experiment_of(R"("kind": "measured", "file": ")" + csv + "\"", agent);
  write_text(csv, "step,height_m," + megabyte + "\n");
  CHECK_THAT(refusal_of(measured), Contains("unknown column") && Contains("throughput_kbps"));
  write_text(csv, "step,height_m,throughput_kbps\n1,20," + megabyte + "\n");
  CHECK_THAT(refusal_of(measured), Contains("use a number from"));
}

TEST_CASE("a command whose standard output cannot be written fails") {
  const ScratchDir scratch;
  const std::string aloft = (aloft::test::bin_dir() / "aloft").string();
  const std::string out = (scratch / "out").string();
  const std::string run = "run data/experiments/quick.json --in-process --trials 1 --agents min-height --out " + out;
  for (const std::string& command :
       {run, "digest " + out, "export --flights " + out, "export --steps --format json " + out,
        "compare " + out + " " + out, std::string("agents"), std::string("validate data/experiments/quick.json"),
        std::string("inspect table data/experiments/quick.json --format csv"), std::string("--help"),
        std::string("run --help"), std::string("--version")}) {
    INFO(command);
    const Finished finished = run_command({"/bin/sh", "-c", aloft + " " + command + " > /dev/full"});
    CHECK(finished.exit_code == 1);
    CHECK_THAT(finished.err, Contains("cannot write"));
  }
  const Finished service =
      run_command({"/bin/sh", "-c", (aloft::test::bin_dir() / "aloft-channel").string() + " --help > /dev/full"});
  CHECK(service.exit_code == 1);
  CHECK_THAT(service.err, Contains("aloft-channel: cannot write"));
  CHECK(run_command({"aloft", "digest", out}).exit_code == 0);  // what was flown is stored
  const Finished watch =
      run_command({"/bin/sh", "-c", aloft + " status --watch --domain " + test_domain() + " > /dev/full"});
  CHECK(watch.exit_code == 1);  // it does not go on when no output can be written
  CHECK_THAT(watch.err, Contains("cannot write"));
}

TEST_CASE("folders that hold other things are left as they are") {
  const ScratchDir scratch;
  std::filesystem::create_directory(scratch / "thesis");
  write_text(scratch / "thesis" / "chapter.tex", "");
  CHECK_THAT(refusal({"aloft", "keys", "init", (scratch / "thesis").string()}),
             Contains("holds other things ('chapter.tex')") && Contains("new or empty"));
  CHECK(std::distance(std::filesystem::directory_iterator(scratch / "thesis"), {}) == 1);
  std::filesystem::create_directory(scratch / "empty");
  CHECK(run_command({"aloft", "keys", "init", (scratch / "empty").string()}).exit_code == 0);

  std::filesystem::create_directory(scratch / "out");
  write_text(scratch / "out" / "log", "");
  for (const char* how : {"--in-process", "--unpinned"})
    CHECK_THAT(refusal({"aloft", "run", "data/experiments/quick.json", how, "--out", (scratch / "out").string(),
                        "--domain", test_domain()}),
               Contains("out/log' is a file") && Contains("--out"));
  CHECK(std::distance(std::filesystem::directory_iterator(scratch / "out"), {}) == 1);
}

TEST_CASE("a program of the user's is refused in process before the first flight") {
  const std::string external = R"({"type": "external", "name": "mine"})";
  const auto refuses = [](const std::string& text) {
    CHECK_THAT(refusal_of(text, {"--in-process"}),
               Contains("agent 'mine' is a program of your own") && Contains("leave --in-process out"));
  };
  refuses(experiment_of("", R"("min-height", )" + external));
  refuses(experiment_of("", R"({"type": "relay", "name": "both", "crew": [{"agent": "min-height"},
                             {"agent": )" +
                                external + R"(, "from_step": 5, "shadow": false}]})"));
  const ScratchDir scratch;
  write_text(scratch / "experiment.json", experiment_of("", external));
  CHECK(run_command({"aloft", "validate", (scratch / "experiment.json").string()}).exit_code == 0);
}
