#include "common/base/follow_parent.hpp"

#include <sys/prctl.h>
#include <unistd.h>

#include <csignal>

namespace aloft {

void follow_parent() {
  const pid_t parent = getppid();
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) std::raise(SIGTERM);  // the parent ended in between
}

}  // namespace aloft
