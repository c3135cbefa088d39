#include "tests/project/scripts.hpp"

#include <algorithm>
#include <sstream>

#include "tests/paths.hpp"

namespace fs = std::filesystem;

namespace aloft::test {

Scripts::Scripts(const std::string& failing) {
  for (const char* folder : {"tools", ".ci", "bin", "build/bin", "build-asan", "build-tsan"})
    fs::create_directories(root_ / folder);
  for (const char* script : {".ci/run", "tools/quickstart.sh", "tools/run_ctest.sh", "tools/setup.sh", "tools/test.sh"})
    copy(script);
  call_machine("ID=debian\nVERSION_ID=\"12\"\n");
  write_text(root_ / "tools/packages.txt", "# none\n");
  for (const char* folder : {"build", "build-asan", "build-tsan"}) {
    write_text(root_ / folder / "build.ninja", "");
    write_text(root_ / folder / "CMakeCache.txt",
               "ALOFT_REPORT_CHARTS:BOOL=ON\nALOFT_PYTHON:BOOL=ON\nALOFT_TESTS:BOOL=ON\nALOFT_BENCHMARKS:BOOL=ON\n");
  }
  fs::create_directories(root_ / "build/Testing/Temporary");
  write_text(root_ / "build/Testing/Temporary/LastTest.log", "a test\nSKIPPED: no such disk here\nanother test\n");
  for (const char* program : {"bin/cmake", "bin/ctest", "bin/apt-get", "tools/lint.sh", "tools/on_debian.sh",
                              "tools/python_environment.sh", "build/bin/aloft"}) {
    const std::string name = fs::path(program).filename().string();
    const std::string counts =
        name == "ctest" ? "echo '100% tests passed, 0 tests failed out of 1'\necho 'Total: 1 s'\n" : "";
    write_program(program, "call=\"" + name + " $*\"\necho \"$call\"\n" + counts + "case \"$call\" in *'" + failing +
                               "'*) exit 8 ;; esac\n");
  }
  write_program("bin/dpkg-query", "exit 1\n");
  write_program("bin/sudo", "exec \"$@\"\n");
}

void Scripts::copy(const std::string& script) const {
  std::string text = read_text(source_dir() / script);
  const std::string os_release = "/etc/os-release";
  for (std::size_t at = 0; (at = text.find(os_release, at)) != std::string::npos;)
    text.replace(at, os_release.size(), (root_ / "os-release").string());
  write_text(root_ / script, text);
  fs::permissions(root_ / script, fs::perms::owner_all);
}

void Scripts::write_program(const std::string& program, const std::string& code) const {
  write_text(root_ / program, "#!/bin/sh\n" + code);
  fs::permissions(root_ / program, fs::perms::owner_all);
}

Finished Scripts::run(const std::string& command) const {
  return run_command(
      {"/bin/bash", "-c", "cd / && PATH=" + (root_ / "bin").string() + ":$PATH " + (root_ / command).string()});
}

void Scripts::call_machine(const std::string& os_release) const {
  write_text(root_ / "os-release", os_release);
}

void Scripts::forget_build() const {
  fs::remove(root_ / "build/build.ninja");
  fs::remove(root_ / "build/CMakeCache.txt");
}

void Scripts::use_packages() const {
  fs::copy_file(source_dir() / "tools/packages.txt", root_ / "tools/packages.txt",
                fs::copy_options::overwrite_existing);
}

std::string calls_in(const Finished& finished, const std::vector<std::string>& programs) {
  std::string calls;
  std::istringstream lines(finished.out);
  for (std::string line; std::getline(lines, line);) {
    const std::string program = line.substr(0, line.find(' '));
    if (std::find(programs.begin(), programs.end(), program) != programs.end()) calls += line + "\n";
  }
  return calls;
}

}  // namespace aloft::test
