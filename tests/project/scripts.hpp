#pragma once

#include <string>

#include "tests/integration/command.hpp"

namespace aloft::test {

/// A checkout with the scripts only, on a machine that calls itself Debian 12. In it cmake, ctest, apt-get,
/// build/bin/aloft, tools/lint.sh, tools/on_debian.sh and tools/python_environment.sh print how they were called, ctest
/// counts one skipped test, no package is installed, and the build folders have everything. The call that contains
/// `failing` fails.
class Scripts {
 public:
  explicit Scripts(const std::string& failing = "no call");

  /// Runs a script of the checkout from the file system's root, as a CI could.
  [[nodiscard]] Finished run(const std::string& command) const;

  /// What /etc/os-release says.
  void call_machine(const std::string& os_release) const;
  /// The build folder of the release is as on a fresh machine: there is none.
  void forget_build() const;
  /// The checkout's own list of packages, of which none is installed, instead of an empty one.
  void use_packages() const;
  /// Copies a script of the repository, which takes the machine for what call_machine() says.
  void copy(const std::string& script) const;
  /// A program, by its path in the checkout, of shell code.
  void write_program(const std::string& program, const std::string& code) const;
  [[nodiscard]] std::filesystem::path root() const { return root_.path(); }

 private:
  ScratchDir root_;
};

/// The lines of the output that tell of calls of `programs`, or of all stand-ins.
[[nodiscard]] std::string calls_in(const Finished& finished,
                                   const std::vector<std::string>& programs = {"cmake", "ctest", "lint.sh", "apt-get",
                                                                               "aloft", "on_debian.sh"});

}  // namespace aloft::test
