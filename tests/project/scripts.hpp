#pragma once

#include <string>

#include "tests/integration/command.hpp"

namespace aloft::test {

/// A checkout with the scripts only, on a machine that calls itself Debian 12. In it cmake, ctest, apt-get,
/// tools/lint.sh and build/bin/aloft print how they were called, ctest counts one skipped test, no package is
/// installed, and the build folders have everything. The call that contains `failing` fails.
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
  [[nodiscard]] std::filesystem::path root() const { return root_.path(); }

 private:
  void copy_scripts() const;
  void write_program(const std::string& program, const std::string& code) const;

  ScratchDir root_;
};

/// The lines of the output that tell of calls of `programs`, or of all stand-ins.
[[nodiscard]] std::string calls_in(const Finished& finished, const std::vector<std::string>& programs = {
                                                                 "cmake", "ctest", "lint.sh", "apt-get", "aloft"});

}  // namespace aloft::test
