#pragma once

#include <string>
#include <string_view>

#include "common/base/descriptor.hpp"

namespace aloft::runtime {

/// Lets one process of a machine at a time do a task for a run. Held as an abstract socket name, so it reaches as far
/// as the loopback interface does (a container with a network of its own is another machine), leaves no file, and ends
/// with the process, however that ends.
class RunClaim {
 public:
  /// `what`: the task, e.g. "coordinator".
  RunClaim(std::string_view run, int domain, std::string_view what);

  /// True if this process has the claim, now or since earlier; false if another process has it.
  bool take();

 private:
  std::string name_;
  Descriptor socket_;
};

}  // namespace aloft::runtime
